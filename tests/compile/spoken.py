"""Kernels that Python itself answers, at an address like compiled ones: what they are given can be looked at."""

from __future__ import annotations

import ctypes
from collections.abc import Callable, Iterator
from contextlib import contextmanager

import pytest

from clearance.compile import calls, library
from clearance.compile.decorators import Kernel

_ENTRY = ctypes.CFUNCTYPE(ctypes.c_int64, ctypes.c_void_p, ctypes.c_void_p)


@contextmanager
def answered(kernel: Callable, answer: Callable[[int, int], int]) -> Iterator[Kernel]:
    """A kernel declared as `kernel` is, which calls `answer(arguments, result)` with their addresses."""
    made, entry = Kernel(kernel), _ENTRY(answer)
    with pytest.MonkeyPatch.context() as patched:
        address = ctypes.cast(entry, ctypes.c_void_p).value
        patched.setattr(calls, "address_of", lambda asked: address)
        yield made


def take(size: int) -> int:
    """The address of memory that the library gives to a kernel."""
    return ctypes.CFUNCTYPE(ctypes.c_void_p, ctypes.c_int64)(_function("clearance_take"))(size)


def mark() -> int:
    """How far the memory of this thread is taken."""
    return ctypes.CFUNCTYPE(ctypes.c_void_p)(_function("clearance_mark_memory"))()


def release(marked: int) -> None:
    """Gives back what was taken since."""
    ctypes.CFUNCTYPE(None, ctypes.c_void_p)(_function("clearance_release_memory"))(marked)


def words_of_array(address: int, shape: tuple[int, ...], strides: tuple[int, ...]) -> list[int]:
    """An array of 8-byte numbers as a kernel writes it down."""
    n = 1
    for length in shape:
        n *= length
    return [0, 0, n, 8, address, *shape, *strides]


def write_words(place: int, words: list[int]) -> None:
    """Writes integers behind one another."""
    ctypes.memmove(place, (ctypes.c_int64 * len(words))(*words), 8 * len(words))


def _function(symbol: str) -> int:
    address = library.built_address(symbol)
    assert address is not None, symbol
    return address

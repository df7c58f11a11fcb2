"""The memory that the library of kernels takes in this thread, by its own functions."""

from __future__ import annotations

import ctypes

from clearance.compile import library


def take(size: int) -> int:
    """The address of memory that the library gives to a kernel."""
    return ctypes.CFUNCTYPE(ctypes.c_void_p, ctypes.c_int64)(_function("clearance_take"))(size)


def mark() -> int:
    """How far the memory of this thread is taken."""
    return ctypes.CFUNCTYPE(ctypes.c_void_p)(_function("clearance_mark_memory"))()


def release(marked: int) -> None:
    """Gives back what was taken since."""
    ctypes.CFUNCTYPE(None, ctypes.c_void_p)(_function("clearance_release_memory"))(marked)


def _function(symbol: str) -> int:
    address = library.built_address(symbol)
    assert address is not None, symbol
    return address

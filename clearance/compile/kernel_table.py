"""Large kernels that others reach by address: each is compiled once, and only when a run first needs it.

A kernel that is called in the usual way is compiled into each of its callers, again at every level of calls. One
that is `apart` is not: its callers find its address in a table that is handed to them. Where the table has no
address yet, the caller stops with `NotCompiled`; `call` then compiles what is missing and asks again.
So a scene in which nothing touches never compiles the predicates that decide contact.

What is large, some hundred numbers as the arrays of a `Surface` are, is best lent to such a kernel: written down
once by the caller (`lend`), and handed over as one address (`borrow`).

Beside each address stands a stamp of the types it was compiled for, so that no caller can use another's.
"""

from __future__ import annotations

import os
import subprocess
import threading
import zlib
from collections.abc import Callable, Sequence
from typing import TYPE_CHECKING

import numpy as np

from clearance.compile.jit import DISABLED, intrinsic, kernel
from clearance.compile.ready_kernel import ReadyKernel

if TYPE_CHECKING:
    from numba import types

    from clearance.compile.numba_private import Kernel

(
    REFINE,
    REFINE_EVERY,
    MEETING,
    COMMON_POINT,
    WINDING_NUMBER,
    SEARCH,
    POLYGONS,
    SEPARATING_PLANES,
    FEATURES,
    FANS,
) = range(10)
CERTIFY, OVERLAP, BUDGET_PAIR = 10, 11, 12
"""The places of the table."""

TOGETHER = (MEETING, COMMON_POINT, OVERLAP)
"""Who needs one of these mostly needs the others."""

_table = np.zeros((13, 2), dtype=np.int64)  # address, stamp
_apart: dict[int, tuple[Callable, Callable[[], tuple]]] = {}
_compiling = threading.Lock()
_listening = threading.Lock()
_elsewhere: list[tuple[subprocess.Popen, Sequence[int]]] = []


def table_like() -> np.ndarray:
    """A table, by its type."""
    return np.zeros_like(_table)


class NotCompiled(Exception):
    """A kernel has come to a call of one that is not compiled; the argument is its place in the table."""


class LentArgument:
    """Stands for the type of what `lend` gives, among arguments that show types."""

    def __init__(self, value: tuple) -> None:
        self.value = value


def apart(place: int, like: Callable[[], tuple]) -> Callable:
    """Decorates a kernel that is called by `at_address`, and that makes no arrays.

    Args:
        place: its own place in the table.
        like: gives arguments of the types that it is called with.
    """

    def register(function: Callable) -> Callable:
        compiled = kernel(function, reference_counts=False)
        _apart[place] = (compiled, like)
        return compiled

    return register


def call(function: Callable, *args: object) -> object:
    """`function(*args, table)`, a kernel that writes all its results anew however often it is called."""
    compiled = -1
    while True:
        try:
            return function(*args, _table)
        except NotCompiled as missing:
            (place,) = missing.args
            if place == compiled:
                raise TypeError(
                    f"{_apart[place][0]} is called with other types than `like` says"
                ) from None
            compiled = place
            compile_kernel(place)


def prepared(function: Callable, *args: object) -> Callable:
    """`function` for `call` with arguments of the types of these, which are told here and not at each call."""
    if isinstance(function, ReadyKernel):
        return function.for_types_of((*args, _table))
    return function


def is_kept(place: int) -> bool:
    """True if the kernel lies compiled in the cache, for this processor or others."""
    function, _ = _apart[place]
    return function.kept.holds_any()


def await_from(process: subprocess.Popen, places: Sequence[int]) -> None:
    """Lets kernels that are not kept come from another process.

    It compiles these one after the other and writes a line to its stdout, a pipe, after each.
    """
    _elsewhere[:] = [(process, places)]


def compile_kernel(place: int) -> None:
    """Makes the kernel of a place ready to be called.

    What another process is compiling is awaited, however long that takes, for it has begun earlier than this one
    could; meanwhile what goes together with it is compiled here.
    """
    while not is_kept(place) and _is_at_work_on(place):
        others = _what_goes_with(place)
        if others:
            _compile_here(others[-1])
        else:
            _await_news_of(place)
    _compile_here(place)


def _await_news_of(place: int) -> None:
    """Returns when the other process has compiled something, or has ended."""
    with _listening:  # another thread may have heard of it meanwhile
        if not is_kept(place) and _is_at_work_on(place) and not _elsewhere[0][0].stdout.readline():
            _elsewhere.clear()


def _forget_elsewhere() -> None:
    """In a process that was forked off: what the other process says is for the one that started it."""
    global _listening
    _listening = threading.Lock()
    _elsewhere.clear()


if hasattr(os, "register_at_fork"):
    os.register_at_fork(after_in_child=_forget_elsewhere)


def _what_goes_with(place: int) -> list[int]:
    """The kernels that are not kept of those `TOGETHER` with one."""
    if place not in TOGETHER:
        return []
    return [other for other in TOGETHER if other != place and not is_kept(other)]


def _is_at_work_on(place: int) -> bool:
    """True if there is another process, and a kernel is the first of those that it still has to compile."""
    return any(
        next((each for each in places if not is_kept(each)), None) == place
        for _, places in _elsewhere
    )


def _compile_here(place: int) -> None:
    """Compiles a kernel in this process, or takes it from the cache, and writes its address down."""
    function, like = _apart[place]
    with _compiling:
        ready = function.loaded(_APART) if isinstance(function, ReadyKernel) else None
        if ready is not None:
            _table[place] = ready.address, ready.stamp
            return
        compiled = function.compiled() if isinstance(function, ReadyKernel) else function
        _table[place] = _compile_apart(compiled, tuple(_type_of(value) for value in like()))


def _compile_apart(compiled: Kernel, argument_types: tuple[types.Type, ...]) -> tuple[int, int]:
    """The address and the stamp of a kernel, of which the machine code is kept for other processes."""
    from clearance.compile.numba_private import code_of, entry_address, entry_of

    compiled.compile(argument_types)
    address, result = entry_address(compiled, argument_types)
    stamp = _stamp(result, argument_types)
    if compiled.kept.entry(_APART) is None:
        made = compiled.overloads[argument_types]
        code = code_of(made)
        if code is not None:
            compiled.kept.keep_entry(_APART, entry_of(made, code, stamp))
    return address, stamp


_APART = "apart"
"""The one form of such a kernel, whose types its source says."""


def _type_of(value: object) -> types.Type:
    import numba
    from numba import types

    if isinstance(value, LentArgument):
        return types.CPointer(numba.typeof(value.value))
    if isinstance(value, tuple):  # numba.typeof knows nothing of what is lent within
        return types.BaseTuple.from_types(
            tuple(_type_of(item) for item in value),
            type(value) if hasattr(value, "_fields") else None,
        )
    return numba.typeof(value)


def _stamp(result: types.Type, arguments: tuple[types.Type, ...]) -> int:
    from clearance.compile.numba_types import plain

    return 1 + zlib.crc32(f"{plain(result)}{arguments}".encode())


@intrinsic(prefer_literal=True)
def _at_address(typing_context, table, place, result, args):
    from clearance.compile.numba_private import call_at, elements_at, stop_if
    from clearance.compile.numba_types import plain

    argument_types = tuple(plain(kind) for kind in args)
    result_type = plain(result)
    stamp = _stamp(result_type, argument_types)

    def emit(context, builder, signature, values):
        index = 2 * place.literal_value
        at, stamp_at = elements_at(
            context, builder, signature.args[0], values[0], (index, index + 1)
        )
        found = builder.load(stamp_at)
        is_other = builder.icmp_signed("!=", found, found.type(stamp))
        stop_if(context, builder, is_other, NotCompiled, place.literal_value)
        return call_at(context, builder, builder.load(at), result_type, argument_types, values[3])

    return result_type(table, place, result, args), emit


@intrinsic
def _lend(typing_context, value):
    from numba import types

    from clearance.compile.numba_private import lend_tuple
    from clearance.compile.numba_types import plain

    kind = types.CPointer(plain(value))

    def emit(context, builder, signature, values):
        return lend_tuple(context, builder, kind, values[0])

    return kind(value), emit


@intrinsic
def _borrow(typing_context, lent):
    from clearance.compile.numba_private import borrow_tuple

    def emit(context, builder, signature, values):
        return borrow_tuple(context, builder, lent.dtype, values[0])

    return lent.dtype(lent), emit


def _at_no_address(table, place, result, args):
    return _apart[place][0](*args)


at_address = _at_no_address if DISABLED else _at_address
"""`at_address(table, place, result, args)`: what the kernel at that place of the table gives for `args`, a tuple;
`result` is any value of the type of its result."""


def _as_it_is(value):
    return value


lend = _as_it_is if DISABLED else _lend
"""`lend(value)`: where a tuple lies while the caller runs; something else must hold its arrays for as long."""

borrow = _as_it_is if DISABLED else _borrow
"""`borrow(lent)`: the tuple."""

"""How kernels are compiled, with a cache that notices every change.

numba's own cache looks only at the file of the function itself and would silently return old code when a
callee in another kernel file has changed. Here the cache folder's name is a hash of the kernel's file and
of every kernel file it imports, and of this one, so that an edit recompiles what depends on it and nothing else
(`kernel_cache` says what is believed of what lies there).

A kernel that calls another one is optimised together with all that lies below it, level by level. Large ones
are therefore kept `apart` and called by address, compiled once for all their callers (`kernel_table`).
"""

from __future__ import annotations

import functools
import gc
import os
from collections.abc import Callable
from pathlib import Path

import numba
from numba.core import types
from numba.core.dispatcher import Dispatcher
from numba.core.targetconfig import ConfigStack
from numba.extending import register_jitable

from clearance.compile.kernel_cache import KernelCache
from clearance.import_closure import digest_of, import_closure

if "NUMBA_OPT" not in os.environ:
    # LLVM's level 1 takes 40 % off the first run and 10 to 18 % off every later one (sweep, four scenes, three
    # alternating runs against level 3); numba has no such setting for single functions.
    numba.config.OPT = type(numba.config.OPT)(1)


def kernel(function: Callable) -> Callable:
    """The compiled form of `function`: nopython, without the GIL, cached on disk, IEEE arithmetic.

    Division by zero yields inf or nan as in numpy instead of an exception. `NUMBA_DISABLE_JIT=1` leaves
    the Python function; `NUMBA_BOUNDSCHECK=1` checks every index. `NUMBA_CACHE_DIR` moves the cache.
    """
    return _cached(function, _nrt=True)  # also where one that borrows calls it


def borrowing(function: Callable) -> Callable:
    """Like `kernel`, for a function that makes no array and returns none: it counts no references.

    A function with several `return`s costs an atomic count up and down of each array it is given, even where
    it is merged into its caller: a scan of 28000 rows took 200 us, and 40 without (`polytope.patch`).
    Making an array is an error when it is compiled. `_nrt` is numba's own switch for this.
    """
    return _cached(function, _nrt=False)


def _cached(function: Callable, **options: bool) -> Callable:
    compiled = numba.njit(nogil=True, error_model="numpy", no_cfunc_wrapper=True, **options)(function)
    if not numba.config.DISABLE_JIT:
        assert function.__closure__ is None, "what a closure holds is not in the name that it is kept under"
        compiled._cache = KernelCache(function, _source_key(Path(function.__code__.co_filename)))
        compiled.compile = _uncollected(compiled.compile)
    return _watched(compiled)


def _uncollected(compile_for: Callable) -> Callable:
    """The same without collections of garbage, which walk all that the compiler holds: a tenth of its time."""

    @functools.wraps(compile_for)
    def compile_kernel(*args: object) -> object:
        collects = gc.isenabled()
        gc.disable()
        try:
            return compile_for(*args)
        finally:
            if collects:
                gc.enable()

    return compile_kernel


def _for_kernels(function: Callable, **options: object) -> Callable:
    """A function without a way in from Python, which would take a third of the time to compile it.

    A call from Python would go to no address; so it is refused.
    """
    if numba.config.DISABLE_JIT:
        return function
    compiled = numba.njit(
        nogil=True, error_model="numpy", no_cpython_wrapper=True, no_cfunc_wrapper=True, **options
    )(function)

    def refuse(*args: object, **named: object) -> None:
        raise TypeError(f"{function.__module__}.{function.__name__} can be called by kernels only")

    compiled._insert = lambda *entry: None  # nothing for Python to find
    compiled._compile_for_args = refuse
    return compiled if options.get("inline") == "always" else _watched(compiled)


def _watched(compiled: Dispatcher) -> Dispatcher:
    """The same, of one form for all values of its arguments, and refused to callers that would lose count.

    A caller that counts no references must not be handed arrays: one form of the function serves all callers, and
    with the counts of the one the other would free an array that is in use, or never.
    """
    if numba.config.DISABLE_JIT:
        return compiled
    typed = compiled.get_call_template

    def get_call_template(args: tuple, named: dict) -> tuple:
        found = typed(tuple(map(_whatever_its_value, args)), named)
        flags = ConfigStack().top_or_none()
        returned = [form.signature.return_type for form in compiled.overloads.values()]
        if flags is not None and not flags.nrt and any(map(_holds_arrays, returned)):
            raise TypeError(f"{compiled.py_func.__name__} returns an array to a kernel that is `borrowing`")
        return found

    compiled.get_call_template = get_call_template
    return compiled


def _whatever_its_value(kind: types.Type) -> types.Type:
    """The type of an argument without its value, which numba would compile a form of the function for."""
    kind = types.unliteral(kind)
    return types.int64 if kind == types.int32 else kind


def _holds_arrays(kind: types.Type) -> bool:
    if isinstance(kind, types.BaseTuple):
        return any(map(_holds_arrays, kind))
    return isinstance(kind, types.Array)


def inlined(function: Callable) -> Callable:
    """A small function compiled into each kernel that calls it; it has no cache entry of its own."""
    return _for_kernels(function)


def spliced(function: Callable) -> Callable:
    """A large function with one caller, which takes its place before anything is compiled.

    Each level of calls is optimised again with all that lies below it; this takes a level out.
    """
    return _for_kernels(function, inline="always")


def merged(function: Callable) -> Callable:
    """Like `inlined`, but always merged into its callers, at the price of code size and compile time.

    For what inner loops call: a call that is not merged passes every array of a `Surface` by value, some
    two hundred numbers, which costs more than most of these functions do. It counts no references, whoever
    calls it first (`borrowing`), so it makes no array.
    """
    return _for_kernels(function, forceinline=True, _nrt=False)


def shared(function: Callable) -> Callable:
    """A small function that kernels compile in, and that Python runs as it stands."""
    return register_jitable(error_model="numpy")(function)


@functools.cache
def _source_key(path: Path) -> str:
    """Names the sources of what is compiled from a file: its own, this room's and all that the file imports."""
    return digest_of(import_closure([path, Path(__file__)]))[:16]

"""The decorators of compiled functions: `kernel`, `inline`, `shared`, `intrinsic`, and `apart` in `kernel_table`.

`NOTES.md` has a table of which one a new function takes. A kernel that calls another one is optimised together
with all that lies below it, level by level; large ones are therefore kept `apart`.

numba's own cache looks only at the file of the function itself and would silently return old code when a
callee in another kernel file has changed. Here the cache folder's name is a hash of the kernel's file and
of every kernel file it imports, and of this one, so that an edit recompiles what depends on it and nothing else
(`kept_files` says what is believed of what lies there).
"""

from __future__ import annotations

import functools
from collections.abc import Callable, Sequence
from typing import Any

from clearance.compile.deferred import defer, do_when_begun, is_begun, watch
from clearance.compile.heap import HeapHandle
from clearance.compile.kernel_files import KernelFiles, files_of
from clearance.compile.ready_kernel import ReadyKernel


def _setting(name: str) -> bool:
    """A setting of numba's; where one is made the compiler is at work from the start."""
    if not is_begun():
        return False
    from numba import config

    return bool(getattr(config, name))


DISABLED = _setting("DISABLE_JIT")
"""True where the functions run in Python as they stand."""

CHECKS_BOUNDS = _setting("BOUNDSCHECK")
"""True where every index is checked."""


def kernel(function: Callable | None = None, *, reference_counts: bool = True) -> Callable:
    """The compiled form of `function`: nopython, without the GIL, cached on disk, IEEE arithmetic.

    Division by zero yields inf or nan as in numpy instead of an exception. `NUMBA_DISABLE_JIT=1` leaves
    the Python function; `NUMBA_BOUNDSCHECK=1` checks every index. `NUMBA_CACHE_DIR` moves the cache.

    Args:
        reference_counts: False for a function that makes no array and returns none. One with several `return`s
            costs an atomic count up and down of each array it is given, even where it is merged into its
            caller: a scan of 28000 rows took 200 us, and 40 without (`polytope.patch`). Making an array is then
            an error when the function is compiled.
    """
    if function is None:
        return functools.partial(kernel, reference_counts=reference_counts)
    if DISABLED:
        return function
    assert function.__closure__ is None, (
        "what a closure holds is not in the name that it is kept under"
    )
    files = functools.cache(functools.partial(files_of, function))
    make = functools.partial(_compiled, function, files, reference_counts)
    if is_begun():
        return make()
    watch(function.__globals__)
    return ReadyKernel(function, make, files)


def _compiled(function: Callable, files: Callable[[], KernelFiles], counts: bool) -> Callable:
    from clearance.compile.numba_private import KernelCache, kernel_of

    compiled = kernel_of(function, reference_counts=counts)
    compiled.kept = files()
    compiled._cache = KernelCache(compiled.kept)
    return compiled


def inline(
    function: Callable | None = None,
    *,
    force: bool = False,
    one_caller: bool = False,
    reference_counts: bool | None = None,
) -> Any:
    """A function compiled into each kernel that calls it; it has no cache entry and no way in from Python.

    Args:
        force: True for what inner loops call: merged into its callers whatever it costs in code size and compile
            time. A call that is not merged passes every array of a `Surface` by value, some two hundred numbers,
            which costs more than most of these functions do. It counts no references, whoever calls it first, so
            it makes no array.
        one_caller: True for a large function with one caller, which takes its place before anything is compiled.
            Each level of calls is optimised again with all that lies below it; this takes a level out.
        reference_counts: as with `kernel`; None: as its first caller does.
    """
    assert not (force and one_caller), "either of them merges"
    if function is None:
        return functools.partial(
            inline, force=force, one_caller=one_caller, reference_counts=reference_counts
        )
    if DISABLED:
        return function
    make = functools.partial(_merged, function, force, one_caller, reference_counts)
    return defer(function.__globals__, make)


def _merged(
    function: Callable, force: bool, one_caller: bool, reference_counts: bool | None
) -> Callable:
    from clearance.compile.numba_private import KernelForKernels, kernel_of

    options: dict[str, object] = {"inline": "always"} if one_caller else {}
    if force:
        options, reference_counts = {"forceinline": True}, False
    return kernel_of(function, KernelForKernels, reference_counts=reference_counts, **options)


def shared(function: Callable) -> Callable:
    """A small function that kernels compile in, and that Python runs as it stands."""

    def register() -> None:
        from numba.extending import register_jitable

        register_jitable(error_model="numpy")(function)

    do_when_begun(register)
    return function


def intrinsic(function: Callable | None = None, **options: object) -> Any:
    """A function that says itself what is compiled of a call: numba's `intrinsic`."""
    if function is None:
        return functools.partial(intrinsic, **options)

    def make() -> Any:
        from numba import extending

        as_asked = extending.intrinsic(**options) if options else extending.intrinsic
        return as_asked(function)

    return defer(function.__globals__, make)


def lie_on_heap(handle: type[HeapHandle], fields: Sequence[str]) -> None:
    """Makes `handle(*fields)` in a kernel a structure on the heap, of which Python has a `handle`."""

    def lay() -> None:
        from clearance.compile.numba_private import lay_on_heap

        lay_on_heap(handle, fields)

    do_when_begun(lay)

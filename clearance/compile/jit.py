"""The decorators of compiled functions: `kernel`, `inline`, `shared`, and `apart` in `kernel_table`.

`NOTES.md` has a table of which one a new function takes. A kernel that calls another one is optimised together
with all that lies below it, level by level; large ones are therefore kept `apart`.

numba's own cache looks only at the file of the function itself and would silently return old code when a
callee in another kernel file has changed. Here the cache folder's name is a hash of the kernel's file and
of every kernel file it imports, and of this one, so that an edit recompiles what depends on it and nothing else
(`kept_files` says what is believed of what lies there).
"""

from __future__ import annotations

import functools
from collections.abc import Callable
from pathlib import Path

from numba import config
from numba.extending import register_jitable

from clearance.compile.kernel_cache import KernelCache
from clearance.compile.numba_private import KernelForKernels, kernel_of
from clearance.import_closure import digest_of, import_closure


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
    if config.DISABLE_JIT:
        return function
    assert function.__closure__ is None, (
        "what a closure holds is not in the name that it is kept under"
    )
    compiled = kernel_of(function, reference_counts=reference_counts)
    compiled._cache = KernelCache(function, _source_key(Path(function.__code__.co_filename)))
    return compiled


def inline(
    function: Callable | None = None, *, force: bool = False, one_caller: bool = False
) -> Callable:
    """A function compiled into each kernel that calls it; it has no cache entry and no way in from Python.

    Args:
        force: True for what inner loops call: merged into its callers whatever it costs in code size and compile
            time. A call that is not merged passes every array of a `Surface` by value, some two hundred numbers,
            which costs more than most of these functions do. It counts no references, whoever calls it first, so
            it makes no array.
        one_caller: True for a large function with one caller, which takes its place before anything is compiled.
            Each level of calls is optimised again with all that lies below it; this takes a level out.
    """
    assert not (force and one_caller), "either of them merges"
    if function is None:
        return functools.partial(inline, force=force, one_caller=one_caller)
    if config.DISABLE_JIT:
        return function
    options: dict[str, object] = {"inline": "always"} if one_caller else {}
    if force:
        options = {"forceinline": True, "reference_counts": False}
    return kernel_of(function, KernelForKernels, **options)


def shared(function: Callable) -> Callable:
    """A small function that kernels compile in, and that Python runs as it stands."""
    return register_jitable(error_model="numpy")(function)


@functools.cache
def _source_key(path: Path) -> str:
    """Names the sources of what is compiled from a file: its own, this room's and all that the file imports."""
    return digest_of(import_closure([path, Path(__file__)]))[:16]

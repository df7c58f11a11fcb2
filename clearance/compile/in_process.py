"""Kernels that are compiled in this process: all with `CLEARANCE_KERNELS=jit`, else those the library has not.

They become the same objects as those of the library, linked by llvmlite, and take memory from the same stack.
Not for: how an object is made (`compiler`), and which kernels are compiled here (`library`).
"""

from __future__ import annotations

import ctypes
import functools
import os
import sys
import threading
from collections.abc import Callable, Mapping

from clearance.compile import registered
from clearance.compile.linking import linked
from clearance.compile.memory import OF_MEMORY
from clearance.compile.registered import Declaration

_lock = threading.RLock()
_addresses: dict[Declaration, int] = {}


def set_up_compiler() -> None:
    """Settings of numba, before it is imported: `objects` runs LLVM's passes for good.

    numba links each function with all that it calls, at every level of nesting. A few passes keep these modules
    small: `prove_pair` compiles in 22 s instead of 37 s. Vectorised loops are left to `objects`.
    """
    os.environ |= {
        "NUMBA_OPT": "1",
        "NUMBA_LOOP_VECTORIZE": "0",
        "NUMBA_SLP_VECTORIZE": "0",
        "NUMBA_CPU_NAME": "generic",
        "NUMBA_CPU_FEATURES": "",
    }
    sys.setrecursionlimit(max(10_000, sys.getrecursionlimit()))


def compiled_address(
    kernel: Declaration,
    level: str,
    address_of: Callable[[Declaration], int],
    address_of_memory: Callable[[str], int],
) -> int:
    """The address of a kernel that is compiled in this process, for this level of processor.

    Args:
        address_of, address_of_memory: of other kernels, and of what they call for memory.
    """
    with _lock:
        if kernel not in _addresses:
            _addresses[kernel] = _compiled(kernel, level, address_of, address_of_memory)
        return _addresses[kernel]


def _compiled(
    kernel: Declaration,
    level: str,
    address_of: Callable[[Declaration], int],
    address_of_memory: Callable[[str], int],
) -> int:
    before = sys.getrecursionlimit()
    set_up_compiler()
    from clearance.compile.compiler import objects_of

    try:
        (made,) = objects_of(kernel, [level])
    finally:
        sys.setrecursionlimit(before)
    imported = {symbol: address_of_memory(symbol) for symbol in OF_MEMORY}
    for symbol in made.called:
        called = next(each for each in reversed(registered.kernels) if each.symbol == symbol)
        imported[symbol] = address_of(called)
    return linked([made.content], [kernel.symbol], imported)[kernel.symbol]


@functools.cache
def memory(level: str) -> Mapping[str, int]:
    """What kernels call for memory, where there is no library that has it."""
    from clearance.compile.objects import memory_object

    found = linked([memory_object(level)], OF_MEMORY, {})
    ctypes.CFUNCTYPE(None)(found["clearance_open_memory"])()
    return found

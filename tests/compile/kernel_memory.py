"""The memory that the library of kernels takes in this thread, by its own function."""

from __future__ import annotations

import ctypes

from clearance.compile import library


def mark() -> int:
    """How far the memory of this thread is taken."""
    address = library.built_address("clearance_mark_memory")
    assert address is not None
    return ctypes.CFUNCTYPE(ctypes.c_void_p)(address)()

"""Many bodies in one kernel call, each by the addresses of its arrays.

A kernel's arguments are fixed in number; a call a body gives Python's lock away and takes it back each time,
and two threads that do so in turn wait for each other as long as they work. Named tuples cost 2 us each when
Python hands them over. A body is therefore a row of numbers: address and length of `numbers`, address and length
of `indices` (`polytope.body`), and, where bodies cut, the number of its first plane. Whoever makes the rows must
hold the arrays. Not for: what is made once a body.
"""

from __future__ import annotations

import ctypes

import numpy as np

from clearance.compile.jit import DISABLED, inline, intrinsic
from clearance.kernels.polytope.body import PackedBody

NUMBERS, INDICES, FIRST_PLANE = 0, 2, 4


@intrinsic
def _array_at(typing_context, rows, at, number):
    from numba import types

    from clearance.compile.numba_private import array_from, elements_at

    result = types.Array(number.dtype, 1, "C")

    def emit(context, builder, signature, values):
        here, after = values[1], builder.add(values[1], values[1].type(1))
        both = elements_at(context, builder, signature.args[0], values[0], (here, after))
        address, length = map(builder.load, both)
        return array_from(context, builder, result, address, length)

    return result(rows, types.intp, number), emit


def _array_from(rows, at, number):
    kind = ctypes.POINTER(np.ctypeslib.as_ctypes_type(number))
    address, length = (int(x) for x in rows.ravel()[at : at + 2])
    return np.ctypeslib.as_array(ctypes.cast(address, kind), (length,))


array_at = _array_from if DISABLED else _array_at
"""`array_at(rows, at, number)`: the array whose address and length stand from entry `at` of `rows` on, (m, 4) or
(m, 5) int64 row by row; `number` is the type of its numbers."""


@inline(one_caller=True)
def body_at(rows, i):
    """Body `i`."""
    first = i * rows.shape[1]
    numbers = array_at(rows, first + NUMBERS, np.float64)
    return PackedBody(numbers, array_at(rows, first + INDICES, np.int32))

"""Many bodies in one kernel call, each by the addresses of its arrays.

A kernel's arguments are fixed in number; a call a body gives Python's lock away and takes it back each time,
and two threads that do so in turn wait for each other as long as they work. A body is therefore a row of
numbers: address and length of `numbers`, address and length of `indices` (`polytope.body`). Whoever makes the
rows must hold the arrays. Not for: bodies of which there are one or two.
"""

from __future__ import annotations

import ctypes
from typing import NamedTuple

import numba
import numpy as np
from numba import types
from numba.extending import intrinsic

from clearance.compile.jit import inline
from clearance.compile.numba_private import array_from, elements_at
from clearance.kernels.polytope.body import PackedBody

NUMBERS, INDICES = 0, 2


@intrinsic
def _array_at(typing_context, rows, i, column, like):
    result = types.Array(like.dtype, 1, "C")

    def emit(context, builder, signature, values):
        at = builder.add(builder.mul(values[1], values[1].type(4)), values[2])
        both = elements_at(
            context, builder, signature.args[0], values[0], (at, builder.add(at, at.type(1)))
        )
        address, length = map(builder.load, both)
        return array_from(context, builder, result, address, length)

    return result(rows, types.intp, types.intp, like), emit


def _array_from(rows, i, column, like):
    kind = ctypes.POINTER(np.ctypeslib.as_ctypes_type(like.dtype))
    address, length = (int(x) for x in rows[i, column : column + 2])
    return np.ctypeslib.as_array(ctypes.cast(address, kind), (length,))


array_at = _array_from if numba.config.DISABLE_JIT else _array_at
"""`array_at(rows, i, column, like)`: the array of body i at `NUMBERS` or `INDICES`; `like` shows its type. rows:
(m, 4) int64."""


class Cutters(NamedTuple):
    """Bodies to cut by.

    Attributes:
        rows: (m, 4) int64, see above; bases: the number of each one's first plane.
        origin: (3,) what the places of the polytope that is cut are about.
        like: shows the types of a body's arrays.
    """

    rows: np.ndarray
    bases: np.ndarray
    origin: np.ndarray
    like: PackedBody


@inline(one_caller=True)
def body_at(cutters, i):
    """Body `i`."""
    numbers = array_at(cutters.rows, i, NUMBERS, cutters.like.numbers)
    return PackedBody(numbers, array_at(cutters.rows, i, INDICES, cutters.like.indices))

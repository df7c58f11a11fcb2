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

from clearance.compile.decorators import inline, when_compiling
from clearance.kernels.polytope.body import PackedBody

NUMBERS, INDICES, FIRST_PLANE = 0, 2, 4


def array_at(rows, at, number):
    """The array whose address and length stand from entry `at` of `rows` on, (m, 4) or (m, 5) int64 row by row.

    Args:
        number: the type of its numbers.
    """
    kind = ctypes.POINTER(np.ctypeslib.as_ctypes_type(number))
    address, length = (int(x) for x in rows.ravel()[at : at + 2])
    return np.ctypeslib.as_array(ctypes.cast(address, kind), (length,))


def _array_by_address():
    from numba import carray, types
    from numba.extending import intrinsic, overload

    from clearance.compile.intrinsics import elements_at

    @intrinsic
    def pointer_and_length(typing_context, rows, at):
        def emit(context, builder, signature, values):
            here, after = values[1], builder.add(values[1], values[1].type(1))
            both = elements_at(context, builder, signature.args[0], values[0], (here, after))
            address, length = map(builder.load, both)
            pointer = builder.inttoptr(address, context.get_value_type(types.voidptr))
            return context.make_tuple(builder, signature.return_type, [pointer, length])

        return types.Tuple((types.voidptr, types.int64))(rows, types.intp), emit

    @overload(array_at, jit_options={"forceinline": True}, strict=False)
    def call(rows, at, number):
        def implementation(rows, at, number):
            pointer, length = pointer_and_length(rows, at)
            return carray(pointer, (length,), number)

        return implementation


when_compiling.append(_array_by_address)


@inline
def body_at(rows, i):
    """Body `i`."""
    first = i * rows.shape[1]
    numbers = array_at(rows, first + NUMBERS, np.float64)
    return PackedBody(numbers, array_at(rows, first + INDICES, np.int32))

"""What the compiler makes of four numbers that are put into one register.

It is imported when something is compiled. Not for: what lies in one piece already (`lanes.lanes_at`).
"""

from llvmlite import ir
from numba import types
from numba.extending import intrinsic

from clearance.kernels.arithmetic.lanes_in_llvm import LanesType
from clearance.kernels.arithmetic.width import WIDTH


@intrinsic
def lanes_of(typing_context, a, b, c, d):
    def emit(context, builder, signature, values):
        vector = ir.Constant(ir.VectorType(ir.DoubleType(), WIDTH), ir.Undefined)
        for place, value in enumerate(values):
            vector = builder.insert_element(vector, value, ir.IntType(32)(place))
        return vector

    number = types.float64
    return LanesType()(number, number, number, number), emit

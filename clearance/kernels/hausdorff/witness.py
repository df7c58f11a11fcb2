"""The two points that a search ends with, and which system they solve. Not for: finding them."""

import numpy as np

from clearance.compile.declared import Floats
from clearance.compile.decorators import inline, kernel
from clearance.kernels.curve.bezier import hypotenuse, is_rough, jet
from clearance.kernels.curve.pair import CurveArrays, Curves
from clearance.kernels.hausdorff.state import (
    COMMON_NORMAL,
    END,
    SELF_BISECTOR,
    SearchStates,
)

AT_THE_END = 1e-12  # a local parameter this near to 0 or 1 is that end
SAME_POINT = 1e-14  # witnesses no farther apart, relative to their coordinates, have no direction
STEEP = (
    1e-6  # cosine between the tangent and the line of the witnesses from which on that is no normal
)


@inline
def _is_end(pieces, joints, i, local):
    if local <= AT_THE_END and is_rough(pieces, joints, i, 0):
        return True
    return local >= 1.0 - AT_THE_END and is_rough(pieces, joints, i, 1)


@inline
def write_witness(curves, joints_a, joints_b, state, out):
    """Fills `out` (5,) with the two points that `state` names and the kind of solution that they are.

    At a smooth point of A the distance is either stationary (common normal, or a corner or end of B) or it
    rises on one side and falls on the other: the self-bisector.
    """
    i, j = state.piece_a, state.piece_b
    a, b = jet(curves.a, i, state.at_a), jet(curves.b, j, state.at_b)
    out[0], out[1], out[2], out[3] = a.x, a.y, b.x, b.y
    ex, ey = a.x + curves.shift_x - b.x, a.y + curves.shift_y - b.y
    length = hypotenuse(ex, ey)
    are_distinct = length > SAME_POINT * (hypotenuse(a.x, a.y) + hypotenuse(b.x, b.y))
    is_steep = abs(ex * a.dx + ey * a.dy) > STEEP * length * hypotenuse(a.dx, a.dy)
    if _is_end(curves.a, joints_a, i, state.at_a):
        out[4] = END
    elif are_distinct and is_steep:
        out[4] = SELF_BISECTOR
    else:
        out[4] = END if _is_end(curves.b, joints_b, j, state.at_b) else COMMON_NORMAL


@kernel
def witness_of(
    one: CurveArrays, two: CurveArrays, shift_x: float, shift_y: float, states: SearchStates
) -> Floats:
    """The points (5,) that the first of `states` names, as `write_witness` gives them."""
    points = np.empty(5)
    curves = Curves(one.pieces, two.pieces, shift_x, shift_y)
    write_witness(curves, one.joints, two.joints, states[0], points)
    return points

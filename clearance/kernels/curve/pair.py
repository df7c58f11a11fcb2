"""Two curves as a search takes them: whose points are asked, to which curve, and the step between their frames.

Not for: what the search knows of them (`hausdorff.state`).
"""

from typing import Annotated, NamedTuple

from clearance.compile.declared import LentTo
from clearance.kernels.curve.arc_fit import Leaves
from clearance.kernels.curve.bezier import Joints, Pieces


class CurveArrays(NamedTuple):
    """One curve: its pieces, its arcs with their tree, and how the pieces follow one another."""

    pieces: Pieces
    leaves: Leaves
    joints: Joints


class Curves(NamedTuple):
    """The curve searched, the other one, and the step from the frame of the first into that of the other."""

    a: Annotated[Pieces, LentTo]
    b: Annotated[Pieces, LentTo]
    shift_x: float
    shift_y: float


class CurvePair(NamedTuple):
    """`Curves`, and the arcs of the other one: whole curves may be asked for their nearest point."""

    curves: Curves
    leaves: Leaves


class CurvePart(NamedTuple):
    """The part of one piece between two local parameters; run through backwards where `t0` > `t1`."""

    piece: int
    t0: float
    t1: float

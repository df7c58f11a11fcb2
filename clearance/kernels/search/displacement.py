"""How far two bodies may move about their poses in a search. The search knows nothing else about motion.

Three types describe it: `Still`, the `Twist` of an interval (`motion`), the `ErrorRows` of a machine (`budget`).
Each has a `slack` [m], the most that rounding can raise a bound, and its own version of the functions below. A
body is named by its side, 0 or 1. Boxes and points are in its frame; a box may stand for four in lanes.
"""

from typing import NamedTuple

from clearance.compile.decorators import by_type, inline
from clearance.kernels.arithmetic.lanes import marks_within
from clearance.kernels.mesh.normal_cones import marks_turned_away, while_moving


class Still(NamedTuple):
    """Neither body moves."""

    slack: float


@by_type
def movement_of_box(displacement, box, side):
    """[m] the greatest motion of any point of a box."""
    raise TypeError


@by_type
def movement_of_box_along(displacement, box, side, u):
    """[m] the greatest motion of any point of a box along the direction of the search, in either sense."""
    raise TypeError


@by_type
def still_turned_away(displacement, cones, d, marks, bounds):
    """Bits of the marked nodes of a group that hold no nearest points at any instant: see `normal_cones`.

    Args:
        cones, d: of the group and a node of the other body. bounds: [m] on their distances.
    """
    raise TypeError


@by_type
def prepare_along(displacement, direction):
    """Precomputes the displacement along a `SeparatingDirection`; the functions below use the last one."""
    raise TypeError


@by_type
def movement_of_point_along(displacement, x, side, u):
    """[m] the greatest motion of a point, or four in lanes, along the prepared direction, in either sense."""
    raise TypeError


@by_type
def errors_of_point_along(displacement, x, side, u):
    """[m] the same at one instant: by errors alone, without motion."""
    raise TypeError


@by_type
def movement_of_point(displacement, x, side):
    """[m] the greatest motion of a point."""
    raise TypeError


@by_type
def direction_of_search(displacement, direction):
    """The direction along which a search bounds boxes, made from the prepared one."""
    raise TypeError


@by_type
def movement_of_point_in_search(displacement, x, side, u):
    """[m] the greatest motion of four points in lanes along the direction of the search."""
    raise TypeError


@by_type
def is_nearly_still(displacement, motion, little):
    """True where the motion is so small that a shorter interval does not help.

    Args:
        motion: [m] of the nearest points, without errors. little: [m] the limit.
    """
    raise TypeError


@movement_of_box.register
def _(still: Still, box, side):
    return 0.0


@movement_of_box_along.register
def _(still: Still, box, side, u):
    return 0.0


@still_turned_away.register
def _(still: Still, cones, d, marks, bounds):
    separate = marks & ~marks_within(bounds, 0.0)
    return separate & marks_turned_away(cones, d) if separate else 0


MOST_TURNED = 0.25
"""[rad] Where a body turns farther, its normals say little: cones stay below a right angle."""


class Turn(NamedTuple):
    """[rad] the greatest turn of a normal of either body; [m] the most by which two points come nearer."""

    angle: float
    cosine: float
    sine: float
    movement: float


@inline(force=True)
def turned_away_while(turn, cones, d, marks):
    """The same for bodies that do not touch at first, or whose contact ends the search."""
    if marks == 0 or turn.angle >= MOST_TURNED:
        return 0
    return marks & marks_turned_away(while_moving(cones, turn.cosine, turn.sine, turn.movement), d)

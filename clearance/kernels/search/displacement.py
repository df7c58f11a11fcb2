"""How far two bodies may move about the poses in which a search sees them; a search knows nothing else of motion.

Three types say it: `Still`, the `Twist` of an interval (`motion`), the `ErrorRows` of a machine (`budget`). Each
has a `slack` [m], by which rounding can raise a bound, and its own version of the functions below. A body is named
by its side, 0 or 1. Boxes and points are in its frame; a box may stand for four in lanes.
"""

from typing import NamedTuple

from clearance.compile.decorators import by_type, inline
from clearance.kernels.arithmetic.lanes import marks_within
from clearance.kernels.mesh.normal_cones import marks_turned_away, while_moving


class Still(NamedTuple):
    """Both bodies stand."""

    slack: float


@by_type
def movement_of_box(displacement, box, side):
    """[m] how far any point of a box moves at most."""
    raise TypeError


@by_type
def movement_of_box_along(displacement, box, side, u):
    """[m] how far any point of a box moves along the direction of the search at most, either way."""
    raise TypeError


@by_type
def still_turned_away(displacement, cones, d, marks, bounds):
    """Bits of those marked nodes of a group that hold no nearest points at any instant: see `normal_cones`.

    Args:
        cones, d: of the group and a node of the other body. bounds: [m] on their distances.
    """
    raise TypeError


@by_type
def prepare_along(displacement, direction):
    """Works out what all points share along a `SeparatingDirection`; the functions below use the last one."""
    raise TypeError


@by_type
def movement_of_point_along(displacement, x, side, u):
    """[m] how far a point, or four in lanes, moves along the direction that was prepared at most, either way."""
    raise TypeError


@by_type
def errors_of_point_along(displacement, x, side, u):
    """[m] the same at one instant: what errors do without motion."""
    raise TypeError


@by_type
def movement_of_point(displacement, x, side):
    """[m] how far a point moves at most."""
    raise TypeError


@by_type
def direction_of_search(displacement, direction):
    """The direction along which a search bounds boxes, best where nearest points differ along the prepared one."""
    raise TypeError


@by_type
def movement_of_point_in_search(displacement, x, side, u):
    """[m] how far four points in lanes move along the direction of the search at most."""
    raise TypeError


@by_type
def is_nearly_still(displacement, motion, little):
    """True where motion moves so little [m] that a shorter interval is of no help.

    Args:
        motion: [m] what it moves the nearest points, beside errors. little: [m] the limit.
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
    apart = marks & ~marks_within(bounds, 0.0)
    return apart & marks_turned_away(cones, d) if apart else 0


MOST_TURNED = 0.25
"""[rad] Where a body turns farther, its normals say little: cones stay below a right angle."""


class Turn(NamedTuple):
    """[rad] by how much the normals of either body turn at most; [m] how far any two points come together."""

    angle: float
    cosine: float
    sine: float
    way: float


@inline(force=True)
def turned_away_while(turn, cones, d, marks):
    """The same of bodies that do not touch at first, or where nothing is asked after they have."""
    if marks == 0 or turn.angle >= MOST_TURNED:
        return 0
    return marks & marks_turned_away(while_moving(cones, turn.cosine, turn.sine, turn.way), d)

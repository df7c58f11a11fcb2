"""The errors of a machine as a displacement of both bodies of a pair, with the motion of an interval.

Along the direction of a search boxes are bounded by a tilted direction, and by the rows that the tilt does not
cover, the separate rows (`along_rows`). Not for: the rows (`rows`), and choosing pairs and moments (`sweep`).
"""

import math
from typing import NamedTuple

from clearance.compile.decorators import inline
from clearance.kernels.budget.along_rows import (
    AlongRows,
    moved_of_point,
    project_errors,
    separate_of_box,
    separate_of_point,
    tilted,
)
from clearance.kernels.budget.errors import REACH, RESIDUAL, TURNED, BodyRows
from clearance.kernels.budget.reach import (
    BodyReach,
    along_at_rest,
    reach_of_body,
    reach_of_box,
    reach_of_point,
)
from clearance.kernels.features.bounds import rounding_slack
from clearance.kernels.mesh.surface import Box, box_of
from clearance.kernels.search.displacement import (
    Turn,
    direction_of_search,
    errors_of_point_along,
    is_nearly_still,
    movement_of_box,
    movement_of_box_along,
    movement_of_point,
    movement_of_point_along,
    movement_of_point_in_search,
    prepare_along,
    still_turned_away,
    turned_away_while,
)
from clearance.kernels.search.proof import CHAIN_SLACK


class SeenErrors(NamedTuple):
    """The rows of all bodies, and those of two bodies along a direction.

    Attributes:
        found: of all bodies. separate: rows that the tilted direction of the search does not cover.
        own: all rows, along the prepared direction.
    """

    found: BodyRows
    separate: AlongRows
    own: AlongRows


class ErrorRows(NamedTuple):
    """The errors of both bodies of a pair.

    Attributes:
        slack: [m] the most that rounding can raise a bound. seen: `SeenErrors`, lent.
        body_a, body_b: numbers of the bodies. box_a, box_b: of the whole bodies.
        moves: True where joints move: then the reach is computed for each box.
        reach_a, reach_b: of both. whole_a, whole_b: [m] the greatest motion of any point of either.
        turn: of both together.
    """

    slack: float
    seen: SeenErrors
    body_a: int
    body_b: int
    box_a: Box
    box_b: Box
    moves: bool
    reach_a: BodyReach
    reach_b: BodyReach
    whole_a: float
    whole_b: float
    turn: Turn


@movement_of_box.register
def _(rows: ErrorRows, box, side):
    if not rows.moves:
        return 0.0 * box.half.x + (rows.whole_b if side == 1 else rows.whole_a)
    return reach_of_box(box, rows.reach_b if side == 1 else rows.reach_a)


@movement_of_box_along.register
def _(rows: ErrorRows, box, side, u):
    return separate_of_box(box, side, rows.seen.separate)


@still_turned_away.register
def _(rows: ErrorRows, cones, d, marks, bounds):
    return turned_away_while(rows.turn, cones, d, marks)


@prepare_along.register
def _(rows: ErrorRows, direction):
    seen = rows.seen
    project_errors(seen.found, rows.body_a, 0, direction.u, seen.own)
    project_errors(seen.found, rows.body_b, 1, direction.v, seen.own)


@movement_of_point_along.register
def _(rows: ErrorRows, x, side, u):
    return moved_of_point(x, side, u, rows.seen.own)


@movement_of_point_in_search.register
def _(rows: ErrorRows, x, side, u):
    return separate_of_point(x, side, rows.seen.separate)


@errors_of_point_along.register
def _(rows: ErrorRows, x, side, u):
    return along_at_rest(rows.seen.found, rows.body_b if side == 1 else rows.body_a, u, x)


@movement_of_point.register
def _(rows: ErrorRows, x, side):
    return reach_of_point(rows.seen.found, rows.body_b if side == 1 else rows.body_a, x)


@direction_of_search.register
def _(rows: ErrorRows, direction):
    seen = rows.seen
    return tilted(direction, rows.box_a, rows.box_b, seen.own, seen.separate)


@is_nearly_still.register
def _(rows: ErrorRows, motion, little):
    return motion < little


@inline
def error_rows_of(seen, roots, body_a, body_b):
    """The `ErrorRows` of a pair whose rows are filled.

    Args:
        seen: `SeenErrors`, lent. roots: of the bodies' trees. body_a, body_b: their numbers in `seen`.
    """
    a, b, found = roots.surface_a, roots.surface_b, seen.found
    slack = CHAIN_SLACK * rounding_slack(a, roots.a, b, roots.b, roots.frames)
    one, other = found.sums[body_a], found.sums[body_b]
    angle = max(one[TURNED], other[TURNED])
    turn = Turn(angle, math.cos(angle), math.sin(angle), one[REACH] + other[REACH])
    return ErrorRows(
        slack, seen, body_a, body_b, box_of(a, roots.a), box_of(b, roots.b),
        one[RESIDUAL] >= 0.0 or other[RESIDUAL] >= 0.0,
        reach_of_body(found, body_a), reach_of_body(found, body_b), one[REACH], other[REACH], turn,
    )  # fmt: skip

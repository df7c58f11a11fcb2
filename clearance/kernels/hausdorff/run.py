"""Upper bounds of the distance of a straight part of A to a connected run of B.

A connected run covers, seen square to the line of A's part, all between the feet of the part's two ends. So
every point between has a point of the run square above it, no farther than the run's farthest control point is
from the line (convexity); the two ends are as far as their feet are. Not for: finding the run.
"""

from typing import NamedTuple

import numpy as np

from clearance.compile.decorators import by_type, inline
from clearance.kernels.curve.arc import EPS, RADIUS, X0, X1, Y0, Y1, arc_middle
from clearance.kernels.curve.arc_fit import Leaves
from clearance.kernels.curve.bezier import hypotenuse
from clearance.kernels.hausdorff.segments import Segments

LONGEST_RUN = 2000


class NearestRun(NamedTuple):
    """The arcs or segments of B between those nearest to a part's ends, and how far these feet are."""

    first: int
    last: int
    off_first: float
    off_last: float


class StraightPart(NamedTuple):
    """A straight part of A: where it starts, where it leads, and the step into B's frame."""

    x: float
    y: float
    dx: float
    dy: float
    shift_x: float
    shift_y: float


@by_type
def _follows(others, k):
    """Whether arc or segment `k` of B starts where the one before ends."""
    raise TypeError


@by_type
def _reach(others, k, part):
    """How far B at arc or segment `k` may be from the line of a part, its direction a unit vector."""
    raise TypeError


@inline
def _off_line(part, x, y):
    """The distance of a point of B from the line of a part."""
    x, y = x - part.x - part.shift_x, y - part.y - part.shift_y
    return abs(part.dx * y - part.dy * x)


@_follows.register
def _(others: Leaves, k):
    row, before = others.arcs[k], others.arcs[k - 1]
    return row[X0] == before[X1] and row[Y0] == before[Y1]


@_reach.register
def _(others: Leaves, k, part):
    row = others.arcs[k]
    off = max(_off_line(part, row[X0], row[Y0]), _off_line(part, row[X1], row[Y1]))
    if row[RADIUS] != 0.0:
        x, y = arc_middle(row)
        off = max(off, _off_line(part, x, y))
    return off + row[EPS]


@_follows.register
def _(others: Segments, k):
    control, r = others.pieces.control, 2 * k
    return control[r, 0] == control[r - 1, 0] and control[r, 1] == control[r - 1, 1]


@_reach.register
def _(others: Segments, k, part):
    control, r = others.pieces.control, 2 * k
    off = _off_line(part, control[r, 0], control[r, 1])
    return max(off, _off_line(part, control[r + 1, 0], control[r + 1, 1]))


@inline
def run_bound(part, others, run, enough):
    """The bound of a part by a run of B's arcs (`Leaves`) or `Segments`; inf where it is above `enough`."""
    length, most = hypotenuse(part.dx, part.dy), max(run.off_first, run.off_last)
    if length == 0.0 or most > enough or abs(run.first - run.last) > LONGEST_RUN:
        return np.inf
    dx, dy = part.dx / length, part.dy / length
    line = StraightPart(part.x, part.y, dx, dy, part.shift_x, part.shift_y)
    low, high = min(run.first, run.last), max(run.first, run.last)
    for k in range(low, high + 1):
        if k > low and not _follows(others, k):
            return np.inf
        most = max(most, _reach(others, k, line))
        if most > enough:
            return np.inf
    return most

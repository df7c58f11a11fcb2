"""Upper bounds of the distance of a straight part of A to a connected run of B.

A connected run covers, seen square to the line of A's part, all between the feet of the part's two ends. So
every point between has a point of the run square above it, no farther than the run's farthest control point is
from the line (convexity); the two ends are as far as their feet are. Not for: finding the run.
"""

from typing import NamedTuple

import numpy as np

from clearance.compile.decorators import inline
from clearance.kernels.curve.arc import EPS, RADIUS, X0, X1, Y0, Y1, arc_middle
from clearance.kernels.curve.bezier import hypotenuse, jet

LONGEST_RUN = 2000


class NearestRun(NamedTuple):
    """The arcs or segments of B between those nearest to a part's ends, and how far these feet are."""

    first: int
    last: int
    off_first: float
    off_last: float


@inline
def _direction(dx, dy, run, enough):
    """The unit vector along (dx, dy) and whether a bound of `run` can be below `enough` at all."""
    length = hypotenuse(dx, dy)
    if length == 0.0 or max(run.off_first, run.off_last) > enough:
        return 0.0, 0.0, False
    return dx / length, dy / length, abs(run.first - run.last) <= LONGEST_RUN


@inline
def arc_run_bound(curves, part, arcs, run, enough):
    """The bound for a run of B's arcs; inf or a number beyond `enough` where the run bounds nothing."""
    here, there = jet(curves.a, part.piece, part.t0), jet(curves.a, part.piece, part.t1)
    dx, dy, serves = _direction(there.x - here.x, there.y - here.y, run, enough)
    if not serves:
        return np.inf
    shift_x, shift_y, most = curves.shift_x, curves.shift_y, max(run.off_first, run.off_last)
    low, high = min(run.first, run.last), max(run.first, run.last)
    for k in range(low, high + 1):
        row = arcs[k]
        if k > low and (row[X0] != arcs[k - 1, X1] or row[Y0] != arcs[k - 1, Y1]):
            return np.inf
        x, y = row[X1] - here.x - shift_x, row[Y1] - here.y - shift_y
        off = abs(dx * y - dy * x)
        if k == low:
            x, y = row[X0] - here.x - shift_x, row[Y0] - here.y - shift_y
            off = max(off, abs(dx * y - dy * x))
        if row[RADIUS] != 0.0:
            mx, my = arc_middle(row)
            x, y = mx - here.x - shift_x, my - here.y - shift_y
            off = max(off, abs(dx * y - dy * x))
        most = max(most, off + row[EPS])
        if most > enough:
            break
    return most


@inline
def segment_run_bound(chord, shift_x, shift_y, control, run, enough):
    """The bound of a segment of A, given by its ends, for a run of B's segments; inf beyond `enough`."""
    dx, dy, serves = _direction(chord.x1 - chord.x0, chord.y1 - chord.y0, run, enough)
    if not serves:
        return np.inf
    x0, y0 = chord.x0 + shift_x, chord.y0 + shift_y
    most = max(run.off_first, run.off_last)
    low, high = 2 * min(run.first, run.last), 2 * max(run.first, run.last) + 1
    for r in range(low, high + 1):
        starts = r > low and r % 2 == 0
        if starts and (control[r, 0] != control[r - 1, 0] or control[r, 1] != control[r - 1, 1]):
            return np.inf
        most = max(most, abs(dx * (control[r, 1] - y0) - dy * (control[r, 0] - x0)))
        if most > enough:
            return np.inf
    return most

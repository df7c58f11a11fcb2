"""Compiled Hausdorff distance of polylines: no biarcs and no map, segments straight from the control points.

The distance to one segment is convex, so that a part of A is no farther from B than the farther of its two
ends is from any one segment of B. Runs of A that one segment covers within the lower bound are passed over;
any other part is cut where the segments nearest to its two ends are equally far, until that bound, or that
of the connected run between them, is the distance itself. Not for: anything curved (`hausdorff`).
Source: Taha, Hanbury (2015) for the early break; Alt, Behrends, Blömer (1995) for the bisectors of segments.
"""

from typing import NamedTuple

import numpy as np

from clearance.compile.declared import Floats
from clearance.compile.decorators import inline, kernel
from clearance.kernels.curve.pair import Curves
from clearance.kernels.hausdorff.bounds import keep_best
from clearance.kernels.hausdorff.bracket import Bracket, root_in, value_at
from clearance.kernels.hausdorff.run import NearestRun, StraightPart, run_bound
from clearance.kernels.hausdorff.segments import (
    BUCKET,
    STACK,
    Segments,
    covering_segment,
    distance_to,
    foot_on,
    is_box_covered,
    nearest_segment,
    point_at,
)
from clearance.kernels.hausdorff.state import SearchGoal, SearchStates
from clearance.kernels.hausdorff.witness import write_witness

SEEDS = 512  # midpoints of A that give a good lower bound first
MOST_OPEN = 256  # parts of a segment that may be open at once


class Polylines(NamedTuple):
    """The control points of the polyline searched, the other one, and the step into the other's frame."""

    control: np.ndarray
    other: Segments
    shift_x: float
    shift_y: float


class Span(NamedTuple):
    """A part of a segment of A: parameter, nearest segment of B and distance at its start and at its end."""

    t0: float
    near0: int
    d0: float
    t1: float
    near1: int
    d1: float


class SegmentScratch(NamedTuple):
    """Open spans as rows (MOST_OPEN, 6), and the stack of `nearest_segment`."""

    spans: np.ndarray
    stack: np.ndarray


@inline
def _span_at(spans, k):
    row = spans[k]
    return Span(row[0], int(row[1]), row[2], row[3], int(row[4]), row[5])


@inline
def _put_span(spans, k, span):
    row = spans[k]
    row[0], row[1], row[2] = span.t0, span.near0, span.d0
    row[3], row[4], row[5] = span.t1, span.near1, span.d1


@inline
def _point(lines, i, t):
    """The point of segment `i` of A at `t`, in B's frame."""
    x, y = point_at(lines.control, i, t)
    return x + lines.shift_x, y + lines.shift_y


@inline
def _offer(lines, i, t, hint, stack, state):
    """Raises the lower bound by the true distance of one point of A; returns that and the nearest segment."""
    x, y = _point(lines, i, t)
    distance, k = nearest_segment(lines.other, x, y, hint, stack)
    if distance > state.lower or state.piece_a < 0:
        s = foot_on(lines.other.pieces.control, k, x, y)[1]
        keep_best(state, distance, distance, i, t, k, s)
    return distance, k


class _TwoSegments(NamedTuple):
    """How much farther a point of A's segment `i` is from one of B's than from another; the greater of both."""

    i: int
    one: int
    two: int
    most: float


@value_at.register
def _(function: _TwoSegments, lines, t):
    (i, one, two, _), control = function, lines.other.pieces.control
    x, y = _point(lines, i, t)
    d, e = distance_to(control, one, x, y), distance_to(control, two, x, y)
    most = max(d, e)
    return _TwoSegments(i, one, two, most), d - e, 1e-15 * most


@inline
def _crossing(lines, i, span):
    """Where a span is equally far from the segments nearest to its ends: system (13), regula falsi.

    Returns the parameter and the greater of both distances there.
    """
    both = _TwoSegments(i, span.near0, span.near1, np.inf)
    _, f_low, _ = value_at(both, lines, span.t0)
    _, f_high, _ = value_at(both, lines, span.t1)
    t, both = root_in(Bracket(span.t0, span.t1, f_low, f_high, 0), both, lines)
    return t, both.most


@inline
def _bound_of(lines, i, span, enough):
    """An upper bound of the distance of a span by segments of B, by a run of them where it is above `enough`."""
    control = lines.other.pieces.control
    x, y = _point(lines, i, span.t1)
    bound = max(span.d0, distance_to(control, span.near0, x, y))
    x, y = _point(lines, i, span.t0)
    bound = min(bound, max(span.d1, distance_to(control, span.near1, x, y)))
    if bound > enough:
        x0, y0 = point_at(lines.control, i, span.t0)
        x1, y1 = point_at(lines.control, i, span.t1)
        run = NearestRun(span.near0, span.near1, span.d0, span.d1)
        x, y = x0 + lines.shift_x, y0 + lines.shift_y
        part = StraightPart(x, y, x1 - x0, y1 - y0, 0.0, 0.0)
        bound = min(bound, run_bound(part, lines.other, run, enough))
    return bound


@inline
def _first_span(lines, i, hint, state, stack):
    d0, near0 = _offer(lines, i, 0.0, hint, stack, state)
    d1, near1 = _offer(lines, i, 1.0, near0, stack, state)
    state.n_ends += 2
    return Span(0.0, near0, d0, 1.0, near1, d1)


@inline
def _solve_segment(lines, i, hint, aim, state, work):
    """Raises the lower bound to the greatest distance of segment `i` of A to B, proven; returns a hint."""
    spans, first = work.spans, _first_span(lines, i, hint, state, work.stack)
    _put_span(spans, 0, first)
    top = 1
    while top > 0 and state.lower <= aim.limit:
        top -= 1
        span = _span_at(spans, top)
        enough = max(state.lower + aim.gap, aim.enough)
        state.n_cuts += 1
        if span.near0 == span.near1:  # the distance is convex between two points already offered
            continue
        bound, t = _bound_of(lines, i, span, enough), 0.5 * (span.t0 + span.t1)
        if bound > enough:
            t, most = _crossing(lines, i, span)
            state.n_bisectors += 1
            bound = min(bound, max(most, max(span.d0, span.d1)))
        if bound <= enough:
            state.upper = max(state.upper, bound)
            continue
        if not span.t0 < t < span.t1:
            t = 0.5 * (span.t0 + span.t1)
        d, near = _offer(lines, i, t, span.near0, work.stack, state)
        done = bound <= max(state.lower + aim.gap, aim.enough)
        is_full = top + 2 > MOST_OPEN or not span.t0 < t < span.t1
        if done or state.n_cuts > aim.budget or is_full:
            state.n_given_up += not done
            state.upper = max(state.upper, bound)
            continue
        _put_span(spans, top, Span(t, near, d, span.t1, span.near1, span.d1))
        _put_span(spans, top + 1, Span(span.t0, span.near0, span.d0, t, near, d))
        top += 2
    return first.near1


@inline
def _search_bucket(lines, first, last, hint, aim, state, work):
    """Solves those of A's segments from `first` to before `last` that no segment of B covers; returns a hint."""
    control, shift_x, shift_y = lines.other.pieces.control, lines.shift_x, lines.shift_y
    for k in range(first, last):
        reach_sq = max(state.lower + aim.gap, aim.enough) ** 2
        covering = covering_segment(lines.control, k, control, hint, shift_x, shift_y, reach_sq)
        if covering >= 0:
            hint = covering
        elif state.lower <= aim.limit:
            state.n_kept += 1
            hint = _solve_segment(lines, k, hint, aim, state, work)
    return hint


@kernel
def directed_polyline(
    one: Segments,
    two: Segments,
    shift_x: float,
    shift_y: float,
    aim: SearchGoal,
    states: SearchStates,
    witness: Floats,
):
    """Fills the first of `states` with the directed distance from A to B; stops once it passes `aim.limit`.

    Args:
        one, two: A and B; shift: from A's frame into B's; states: SEARCH_STATE, zeros; witness: (5,) as of
            `write_witness`.
    """
    pa, pb, state = one.pieces, two.pieces, states[0]
    lines = Polylines(pa.control, two, shift_x, shift_y)
    n, size = pa.control.shape[0] // 2, one.boxes.shape[0] // 2
    state.piece_a, state.n_arcs = -1, n
    work = SegmentScratch(np.empty((MOST_OPEN, 6)), np.empty((STACK, 2)))
    todo, hint = np.empty(STACK, np.int64), pb.control.shape[0] // 4
    for k in range(0, n, max(1, n // SEEDS)):
        _, hint = _offer(lines, k, 0.5, hint, work.stack, state)
    todo[0], top = 1, 1
    while top > 0:
        top -= 1
        node = todo[top]
        if one.boxes[node, 0] > one.boxes[node, 2]:
            continue
        covered_sq = max(state.lower, aim.enough) ** 2
        if is_box_covered(one.boxes, node, pb.control, hint, shift_x, shift_y, covered_sq):
            continue
        if node < size:
            todo[top], todo[top + 1] = 2 * node + 1, 2 * node
            top += 2
            continue
        first = (node - size) * BUCKET
        hint = _search_bucket(lines, first, min(n, first + BUCKET), hint, aim, state, work)
    state.upper = max(state.upper, max(state.lower + aim.gap, aim.enough))
    write_witness(Curves(pa, pb, shift_x, shift_y), one.joints, two.joints, state, witness)

"""Compiled search of a directed Hausdorff distance: the interval of the greatest bound first.

An interval T of curve A is settled when a bound of its distance to B does not pass the best value known by
more than the gap, or not the distance that is enough. Otherwise it is cut (`hausdorff.cutting`). What the
budget leaves open is never above the greatest bound in the queue, which the answer's error then shows.
"""

import math
from typing import NamedTuple

from clearance.compile.decorators import inline
from clearance.kernels.arithmetic.rows import with_capacity
from clearance.kernels.curve.bezier import hypotenuse, jet
from clearance.kernels.curve.follow import (
    SHARES,
    MapFeet,
    drift,
    follow_bound,
    least_order,
    order_for,
)
from clearance.kernels.curve.pair import CurvePart
from clearance.kernels.curve.scratch import FEET
from clearance.kernels.hausdorff.bounds import chord_bound, consider, upper_bound
from clearance.kernels.hausdorff.cutting import CAPACITY, BoundPlace, cut_interval
from clearance.kernels.hausdorff.queue import BOUND, interval_at, pop
from clearance.kernels.hausdorff.roots import common_normal, slide_from
from clearance.kernels.hausdorff.run import NearestRun, StraightPart, run_bound

MANY = 512  # arcs from which on whole runs of them are tried first
WORTH = 0.25  # the drift's share of what a bound is too large, from which on a map of higher order is tried
SMALLEST = 4e-16  # an interval that floats cannot cut


class Feet(NamedTuple):
    """The feet of an interval's start, middle and end on one piece of B, and how far they are."""

    piece: int
    start: float
    middle: float
    end: float
    distance: float
    farther_end: float


class Bound(NamedTuple):
    """An upper bound, where in the interval it is largest (a share), and the digits that it may have lost."""

    value: float
    share: float
    lost: float


@inline
def gap_of(aim, state):
    """How near the upper bound has to come: wider once the search has lasted."""
    return aim.gap if state.n_cuts <= aim.sharp else aim.wide


@inline
def settled_below(aim, state):
    """The bound up to which an interval is settled."""
    return max(state.distance + gap_of(aim, state), aim.enough)


@inline
def is_settled(bound, aim, state):
    """Whether a bound settles an interval; what is enough is held to all digits that it may have lost."""
    below = bound.value <= state.distance + gap_of(aim, state)
    return below or bound.value + bound.lost <= aim.enough


@inline
def _feet_of(curves, interval, foot):
    s0, d0 = slide_from(curves, interval.piece, interval.t0, foot.piece, foot.local)
    s1, d1 = slide_from(curves, interval.piece, interval.t1, foot.piece, foot.local)
    return Feet(foot.piece, s0, foot.local, s1, foot.distance, max(d0, d1))


@inline
def _follow(curves, interval, feet, bound, order, enough, work):
    """The given bound, or `follow_bound` where less: through more feet on the same piece of B."""
    if order < 2:
        return Bound(bound.value, bound.share, 0.0)
    t0, t1, s0, s1 = interval.t0, interval.t1, feet.start, feet.end
    more = work.planes[FEET, :, 0]
    more[0], more[order] = s0, s1
    for r in range(1, order):
        place = SHARES[order, r]
        near = 2.0 * place
        s = (
            s0 + near * (feet.middle - s0)
            if place <= 0.5
            else s1 + (2.0 - near) * (feet.middle - s1)
        )
        more[r], _ = slide_from(curves, interval.piece, t0 + place * (t1 - t0), feet.piece, s)
    part, through = CurvePart(interval.piece, t0, t1), MapFeet(feet.piece, order, more)
    closer, where, rounding = follow_bound(curves, part, through, enough, work)
    if closer < bound.value:
        return Bound(closer, where, rounding)
    return Bound(bound.value, bound.share, 0.0)


@inline
def _run_bound(pair, interval, leaf, aim, state, planes):
    """The bound by the run of arcs between those nearest to both ends, whose distances are considered."""
    one = consider(pair, interval.piece, interval.t0, leaf, state, planes)
    two = consider(pair, interval.piece, interval.t1, one.leaf, state, planes)
    run = NearestRun(one.leaf, two.leaf, one.distance, two.distance)
    curves = pair.curves
    here = jet(curves.a, interval.piece, interval.t0)
    there = jet(curves.a, interval.piece, interval.t1)
    dx, dy = there.x - here.x, there.y - here.y
    part = StraightPart(here.x, here.y, dx, dy, curves.shift_x, curves.shift_y)
    return run_bound(part, pair.leaves, run, settled_below(aim, state))


@inline
def _highest_order(curves, i, j):
    n = curves.a.first[i + 1] - curves.a.first[i] - 1
    return order_for(n, curves.b.first[j + 1] - curves.b.first[j] - 1)


@inline
def _followed_where_worth(curves, interval, feet, bound, aim, enough, work):
    """The bound by a map of higher order where the drift of the affine one spoils it; and whether it was tried."""
    there = jet(curves.b, feet.piece, feet.middle)
    speed = hypotenuse(there.dx, there.dy)
    off = abs(feet.middle - 0.5 * (feet.start + feet.end)) * speed
    if not drift(off, feet.distance) > WORTH * (bound.value - enough):
        return bound, False
    length = abs(feet.end - feet.start) * speed
    fine = aim.gap + math.sqrt(2.0 * aim.gap * feet.distance)
    order = _highest_order(curves, interval.piece, feet.piece)
    if length > 0.0:
        order = least_order(off / length, length, fine, order)
    return _follow(curves, interval, feet, bound, order, enough, work), True


@inline
def _bounded(pair, interval, feet, leaf, straight, aim, state, work):
    """An upper bound of the interval's distance, and whether a map of higher order was tried for it."""
    curves = pair.curves
    part = CurvePart(interval.piece, interval.t0, interval.t1)
    other = CurvePart(feet.piece, feet.start, feet.end)
    value, share = upper_bound(curves, part, other, work.planes)
    if straight and pair.leaves.arcs.shape[0] >= MANY and value > 1.5 * state.distance:
        run = _run_bound(pair, interval, leaf, aim, state, work.planes)
        value = min(value, max(run, feet.distance))
    bound, followed, enough = Bound(value, share, 0.0), False, settled_below(aim, state)
    if value > enough and feet.farther_end <= enough:
        bound, followed = _followed_where_worth(curves, interval, feet, bound, aim, enough, work)
    if bound.value > enough:
        chord = max(chord_bound(curves, part, other, work.planes), feet.distance)
        if chord < bound.value:
            bound = Bound(chord, bound.share, 0.0)
    return bound, followed


@inline
def _place_of_bound(curves, interval, feet, share, state):
    """Where to cut: the end at which the bound is largest, or the common normal near the place where it is."""
    t0, t1 = interval.t0, interval.t1
    if share == 1.0:
        state.n_ends += 1
        return t1, feet.end
    if share > 0.0:
        state.n_normals += 1
        t, s = t0 + share * (t1 - t0), feet.start + share * (feet.end - feet.start)
        return common_normal(curves, CurvePart(interval.piece, t0, t1), t, feet.piece, s)
    state.n_ends += 1
    return t0, feet.start


@inline
def examine(pair, aim, interval, state, work, heap, n_open):
    """Settles an interval of A or puts its parts into the queue.

    Raises the lower bound in `state` on the way. Returns a leaf of B nearby and the number of open intervals.
    """
    curves, i = pair.curves, interval.piece
    straight = curves.a.first[i + 1] - curves.a.first[i] == 2 and not curves.a.rational[i]
    state.n_cuts += 1
    middle = 0.5 * (interval.t0 + interval.t1)
    foot = consider(pair, i, middle, interval.hint, state, work.planes)
    if state.lower > aim.limit:
        return foot.leaf, n_open
    feet = _feet_of(curves, interval, foot)
    bound, followed = _bounded(pair, interval, feet, foot.leaf, straight, aim, state, work)
    if is_settled(bound, aim, state):
        state.upper = max(state.upper, bound.value + bound.lost)
        return foot.leaf, n_open
    t, s = _place_of_bound(curves, interval, feet, bound.share, state)
    may_follow = not followed and feet.farther_end <= settled_below(aim, state)
    seen = consider(pair, i, t, foot.leaf, state, work.planes)
    is_open = not is_settled(bound, aim, state)
    if is_open and may_follow and seen.piece == foot.piece:
        # near an inflection of the feet's map the middle does not show how far the two drift apart
        order, enough = _highest_order(curves, i, feet.piece), settled_below(aim, state)
        bound = _follow(curves, interval, feet, bound, order, enough, work)
        is_open = not is_settled(bound, aim, state)
    if not is_open or interval.t1 - interval.t0 < SMALLEST:
        state.n_given_up += is_open
        state.upper = max(state.upper, bound.value + bound.lost)
        return foot.leaf, n_open
    place = BoundPlace(t, s, bound.share, seen, bound.value + bound.lost)
    n_open = cut_interval(pair, interval, foot, place, state, work.planes, heap, n_open)
    return foot.leaf, n_open


@inline
def close(pair, aim, state, work, heap, n_open):
    """Works the queue off, the greatest bound first, until nothing open matters; returns the heap.

    What the budget leaves is bounded by the first entry left.
    """
    while n_open > 0 and state.lower <= aim.limit:
        first = heap[0, BOUND]
        done = first <= settled_below(aim, state)
        if done or state.n_cuts > aim.budget:
            state.upper = max(state.upper, first)
            state.n_given_up += 0 if done else n_open
            break
        n_open = pop(heap, n_open)
        interval = interval_at(heap, n_open)
        heap = with_capacity(heap, n_open, CAPACITY)
        _, n_open = examine(pair, aim, interval, state, work, heap, n_open)
    return heap

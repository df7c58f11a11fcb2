"""Where an open interval of A is cut: at roots of the systems, where they say that the distance turns.

At an end (11), at a common normal found by Newton's method (12), where the curve meets B's self-bisector (13),
or beside a joint of B that it passes closely. To cut at a root makes the distance monotone on both sides, so
that the next bound is exact: the certificate. Not for: the bounds (`hausdorff.interval_search`).
"""

import math
from typing import NamedTuple

from clearance.compile.decorators import inline
from clearance.kernels.curve.bezier import hypotenuse, jet
from clearance.kernels.curve.nearest import Foot, slide_to_foot
from clearance.kernels.hausdorff.bounds import consider
from clearance.kernels.hausdorff.queue import OpenInterval, push
from clearance.kernels.hausdorff.roots import self_bisector, slide_from

MARGIN = 1e-9  # share of an interval next to its ends where no cut beside a joint is made
CLOSELY = 0.01  # how near a joint must be, as a share of the part of A that it cuts off
MOST_PARTS = 32  # that an interval is cut into at once
CAPACITY = MOST_PARTS + 2  # free rows that the queue needs


class BoundPlace(NamedTuple):
    """The place on A where an interval's bound is largest.

    Attributes:
        t: its local parameter. share: the same as a share of the interval.
        s: that of its foot on the piece of B nearest to the interval's middle.
        seen: its foot on the whole of B. bound: how large the bound is there.
    """

    t: float
    s: float
    share: float
    seen: Foot
    bound: float


@inline
def _cut_beside_joints(pair, interval, foot, place, heap, n_open):
    """Cuts an interval next to B's joints between the piece nearest to its middle and that nearest to `place`.

    Only where A passes them closely: elsewhere the branches cross at another place. Returns the number of open
    intervals, the same where no cut was made.
    """
    i, t0, t1, t, bound = interval.piece, interval.t0, interval.t1, place.t, place.bound
    j, other = foot.piece, place.seen.piece
    curves, middle = pair.curves, 0.5 * (t0 + t1)
    forward, count = t > middle, abs(other - j)
    stride = (count + MOST_PARTS - 1) // MOST_PARTS
    near, before = MARGIN * (t1 - t0), n_open
    last = t0 if forward else t1
    for step in range(stride // 2, count, stride):
        piece = j + step if other > j else j - step
        joint = jet(curves.b, piece, 1.0 if other > j else 0.0)
        x, y = joint.x - curves.shift_x, joint.y - curves.shift_y
        guess = middle + (t - middle) * (step + 0.5) / count
        cut_at = slide_to_foot(curves.a, i, x, y, guess, t0, t1)
        here = jet(curves.a, i, cut_at)
        off = hypotenuse(here.x - x, here.y - y) * count
        low, high = (last, t1) if forward else (t0, last)
        if not low + near < cut_at < high - near:
            continue
        if off < CLOSELY * hypotenuse(here.dx, here.dy) * (t1 - t0):
            start, end = (last, cut_at) if forward else (cut_at, last)
            n_open = push(heap, n_open, bound, OpenInterval(i, start, end, foot.leaf, 0.0))
            last = cut_at
    if n_open > before:
        low, high = (last, t1) if forward else (t0, last)
        n_open = push(heap, n_open, bound, OpenInterval(i, low, high, foot.leaf, 0.0))
    return n_open


@inline
def _root_to_cut_at(pair, interval, foot, place, state, work):
    """The root between the interval's middle and the place of its bound: a bisector, a normal, or nan."""
    curves, i, seen = pair.curves, interval.piece, place.seen
    _, reached = slide_from(curves, i, place.t, foot.piece, place.s)
    if not seen.distance < reached * (1.0 - 1e-12):
        return place.t if 0.0 < place.share < 1.0 else math.nan
    middle = 0.5 * (interval.t0 + interval.t1)
    crossing = self_bisector(
        curves, i, middle, place.t, foot.piece, foot.local, seen.piece, seen.local
    )
    state.n_bisectors += 1
    if not math.isnan(crossing):
        consider(pair, i, crossing, foot.leaf, state, work)
    return crossing


@inline
def cut_interval(pair, interval, foot, place, state, work, heap, n_open):
    """Puts the parts of an interval into the queue; returns the number of open intervals.

    `foot` is that of the interval's middle, `place` where its bound is largest.
    """
    seen, bound = place.seen, place.bound
    if seen.piece != foot.piece:
        before = n_open
        n_open = _cut_beside_joints(pair, interval, foot, place, heap, n_open)
        if n_open > before:
            return n_open
    i, t0, t1, chosen = interval.piece, interval.t0, interval.t1, math.nan
    # next to each other the two branches cross where B's pieces meet: there, or halving creeps up on it
    are_neighbours = abs(seen.leaf - foot.leaf) <= 1
    if interval.was_cut == 0.0 and (are_neighbours or bound < 2.0 * state.distance):
        chosen = _root_to_cut_at(pair, interval, foot, place, state, work)
    is_root = 1.0
    if not t0 < chosen < t1:
        chosen, is_root = 0.5 * (t0 + t1), 0.0
    n_open = push(heap, n_open, bound, OpenInterval(i, t0, chosen, foot.leaf, is_root))
    return push(heap, n_open, bound, OpenInterval(i, chosen, t1, foot.leaf, is_root))

"""Compiled search of a directed Hausdorff distance: the interval of the greatest bound first.

An interval T of curve A is settled when a bound of its distance to B does not pass the best value known by
more than the gap, or not the distance that is enough. Otherwise it is cut where the systems say: at an end
(11), at a common normal found by Newton's method (12), where the curve meets B's self-bisector (13), or
beside a joint of B that it passes closely. To cut at a root makes the distance monotone on both sides, so
that the next bound is exact: the certificate. What the budget leaves open is never above the greatest bound
in the queue, which the answer's error then shows.
"""

import math
from typing import NamedTuple

import numpy as np

from clearance.compile.jit import inline, kernel
from clearance.kernels.curve.arc_fit import Leaves
from clearance.kernels.curve.bezier import Pieces, hypotenuse, jet
from clearance.kernels.curve.follow import SHARES, drift, follow_bound, least_order, order_for
from clearance.kernels.curve.nearest import slide_to_foot
from clearance.kernels.hausdorff.exact import (
    chain_bound,
    chord_bound,
    common_normal,
    consider,
    line_covered,
    self_bisector,
    slide_from,
    upper_bound,
)
from clearance.kernels.hausdorff.state import (
    BISECTORS,
    CUTS,
    DISTANCE,
    ENDS,
    GIVEN_UP,
    LOWER,
    NORMALS,
    UPPER,
)

MANY = 512  # arcs of B from which on a straight part of A is first held against runs of them
WORTH = 0.25  # the drift's share of what a bound is too large, from which on a map of higher order is tried
SMALLEST = 4e-16  # an interval that floats cannot cut
BESIDE = 1e-9  # share of an interval next to its ends where no cut beside a joint is made
CLOSELY = 0.01  # how near a joint must be, as a share of the part of A that it cuts off
MOST_PARTS = 32  # that an interval is cut into at once
ROOM = MOST_PARTS + 2  # what the queue must have left
BOUND, T0, T1, HINT, WAS_CUT, PIECE = 0, 1, 2, 3, 4, 5


class Pair(NamedTuple):
    """The curve searched, the other one with its arcs, and the step into the other's frame."""

    a: Pieces
    b: Pieces
    leaves: Leaves
    shift_x: float
    shift_y: float


@inline
def settled_below(aim, state):
    """The bound up to which an interval is settled."""
    gap = aim.gap if state[CUTS] <= aim.sharp else aim.wide
    return max(state[DISTANCE] + gap, aim.enough)


@inline
def is_settled(bound, lost, aim, state):
    """Whether a bound that may have `lost` digits settles an interval; what is enough is held to all of them."""
    gap = aim.gap if state[CUTS] <= aim.sharp else aim.wide
    return bound <= state[DISTANCE] + gap or bound + lost <= aim.enough


@inline
def _before(heap, i, j):
    """Whether entry `i` comes before `j`: the greater bound, of equals the earlier part of the curve."""
    if heap[i, BOUND] != heap[j, BOUND]:
        return heap[i, BOUND] > heap[j, BOUND]
    if heap[i, PIECE] != heap[j, PIECE]:
        return heap[i, PIECE] < heap[j, PIECE]
    return heap[i, T0] < heap[j, T0]


@inline
def _swap(heap, i, j):
    for c in range(heap.shape[1]):
        heap[i, c], heap[j, c] = heap[j, c], heap[i, c]


@inline
def _push(heap, n, bound, t0, t1, hint, was_cut, piece):
    """Puts an interval into the queue (a binary heap of `n` entries); returns the new number."""
    row = heap[n]
    row[BOUND], row[T0], row[T1], row[HINT] = bound, t0, t1, hint
    row[WAS_CUT], row[PIECE] = was_cut, piece
    k = n
    while k > 0 and _before(heap, k, (k - 1) // 2):
        _swap(heap, k, (k - 1) // 2)
        k = (k - 1) // 2
    return n + 1


@inline
def _pop(heap, n):
    """Moves the first entry behind the others; returns the new number."""
    n -= 1
    _swap(heap, 0, n)
    k = 0
    while True:
        first = k
        for child in (2 * k + 1, 2 * k + 2):
            if child < n and _before(heap, child, first):
                first = child
        if first == k:
            return n
        _swap(heap, k, first)
        k = first


@inline
def grown(heap):
    wider = np.empty((2 * heap.shape[0], heap.shape[1]))
    wider[: heap.shape[0]] = heap
    return wider


@inline
def _follow(pair, i, t0, t1, j, s0, s_middle, s1, bound, share, order, enough, work, composed):
    """A known bound, or `follow_bound` where less: through the feet of a part of A on piece `j` of B.

    The feet of its ends and middle are given.
    """
    if order < 2:
        return bound, share, 0.0
    feet = work[10, :, 0]
    feet[0], feet[order] = s0, s1
    for r in range(1, order):
        place = SHARES[order, r]
        near = 2.0 * place
        s = s0 + near * (s_middle - s0) if place <= 0.5 else s1 + (2.0 - near) * (s_middle - s1)
        t = t0 + place * (t1 - t0)
        feet[r], _ = slide_from(pair.a, pair.b, i, t, j, s, pair.shift_x, pair.shift_y)
    closer, where, rounding = follow_bound(
        pair.a,
        pair.b,
        i,
        t0,
        t1,
        j,
        feet,
        order,
        pair.shift_x,
        pair.shift_y,
        enough,
        work,
        composed,
    )
    if closer < bound:
        return closer, where, rounding
    return bound, share, 0.0


@inline
def _cut_beside_joints(pair, heap, n_open, bound, i, t0, t1, t, j, other, hint):
    """Cuts an interval next to B's joints between piece `j`, nearest to its middle, and `other`, nearest to `t`.

    Only where A passes them closely: elsewhere the branches cross at another place. Returns the number of open
    intervals, the same where no cut was made.
    """
    forward, count = t > 0.5 * (t0 + t1), abs(other - j)
    stride = (count + MOST_PARTS - 1) // MOST_PARTS
    near, before = BESIDE * (t1 - t0), n_open
    last = t0 if forward else t1
    for step in range(stride // 2, count, stride):
        piece = j + step if other > j else j - step
        joint = jet(pair.b, piece, 1.0 if other > j else 0.0)
        x, y = joint.x - pair.shift_x, joint.y - pair.shift_y
        guess = 0.5 * (t0 + t1) + (t - 0.5 * (t0 + t1)) * (step + 0.5) / count
        cut_at = slide_to_foot(pair.a, i, x, y, guess, t0, t1)
        here = jet(pair.a, i, cut_at)
        apart = hypotenuse(here.x - x, here.y - y) * count
        low, high = (last, t1) if forward else (t0, last)
        if not low + near < cut_at < high - near:
            continue
        if apart < CLOSELY * hypotenuse(here.dx, here.dy) * (t1 - t0):
            if forward:
                n_open = _push(heap, n_open, bound, last, cut_at, hint, 0.0, i)
            else:
                n_open = _push(heap, n_open, bound, cut_at, last, hint, 0.0, i)
            last = cut_at
    if n_open > before:
        low, high = (last, t1) if forward else (t0, last)
        n_open = _push(heap, n_open, bound, low, high, hint, 0.0, i)
    return n_open


@kernel
def examine(pair, aim, i, t0, t1, hint, was_cut, state, work, composed, heap, n_open):
    """Settles an interval of piece `i` of A or puts its two parts into the queue.

    Raises the lower bound in `state` on the way. Returns a leaf of B nearby and the number of open intervals.
    """
    pa, pb, lb, shift_x, shift_y = pair.a, pair.b, pair.leaves, pair.shift_x, pair.shift_y
    straight = pa.first[i + 1] - pa.first[i] == 2 and not pa.rational[i]
    middle = 0.5 * (t0 + t1)
    state[CUTS] += 1.0
    known = max(state[LOWER], aim.enough)
    if straight and line_covered(pa, i, t0, t1, lb, hint, shift_x, shift_y, known):
        state[UPPER] = max(state[UPPER], known)
        return hint, n_open
    foot = consider(pa, pb, lb, i, middle, shift_x, shift_y, hint, state, work)
    if state[LOWER] > aim.limit:
        return foot.leaf, n_open
    j = foot.piece
    s0, d0 = slide_from(pa, pb, i, t0, j, foot.local, shift_x, shift_y)
    s1, d1 = slide_from(pa, pb, i, t1, j, foot.local, shift_x, shift_y)
    bound, share = upper_bound(pa, pb, i, t0, t1, j, s0, s1, shift_x, shift_y, work)
    if straight and lb.arcs.shape[0] >= MANY and bound > 1.5 * state[DISTANCE]:
        one = consider(pa, pb, lb, i, t0, shift_x, shift_y, foot.leaf, state, work)
        two = consider(pa, pb, lb, i, t1, shift_x, shift_y, one.leaf, state, work)
        run = chain_bound(
            pa, i, t0, t1, lb, one.leaf, two.leaf, one.distance, two.distance, shift_x, shift_y,
            settled_below(aim, state),
        )  # fmt: skip
        bound = min(bound, max(run, foot.distance))
    enough, lost, followed = settled_below(aim, state), 0.0, False
    highest = order_for(pa.first[i + 1] - pa.first[i] - 1, pb.first[j + 1] - pb.first[j] - 1)
    if bound > enough and max(d0, d1) <= enough:
        there = jet(pb, j, foot.local)
        off = abs(foot.local - 0.5 * (s0 + s1)) * hypotenuse(there.dx, there.dy)
        if drift(off, foot.distance) > WORTH * (bound - enough):
            followed = True
            length = abs(s1 - s0) * hypotenuse(there.dx, there.dy)
            fine = aim.gap + math.sqrt(2.0 * aim.gap * foot.distance)
            order = least_order(off / length, length, fine, highest) if length > 0.0 else highest
            bound, share, lost = _follow(
                pair, i, t0, t1, j, s0, foot.local, s1, bound, share, order, enough, work, composed
            )
    if bound > enough:
        other = chord_bound(pa, pb, i, t0, t1, j, s0, s1, shift_x, shift_y, work)
        other = max(other, foot.distance)
        if other < bound:
            bound, lost = other, 0.0
    if is_settled(bound, lost, aim, state):
        state[UPPER] = max(state[UPPER], bound + lost)
        return foot.leaf, n_open
    t, s = t0, s0
    if share == 1.0:
        t, s = t1, s1
        state[ENDS] += 1.0
    elif share > 0.0:
        t, s = t0 + share * (t1 - t0), s0 + share * (s1 - s0)
        t, s = common_normal(pa, pb, i, t, t0, t1, j, s, shift_x, shift_y)
        state[NORMALS] += 1.0
    else:
        state[ENDS] += 1.0
    seen = consider(pa, pb, lb, i, t, shift_x, shift_y, foot.leaf, state, work)
    open_still = not is_settled(bound, lost, aim, state)
    if open_still and not followed and seen.piece == j and max(d0, d1) <= enough:
        # near an inflection of the feet's map the middle does not tell how far the two drift apart
        bound, share, lost = _follow(
            pair, i, t0, t1, j, s0, foot.local, s1, bound, share, highest, settled_below(aim, state),
            work, composed,
        )  # fmt: skip
        open_still = not is_settled(bound, lost, aim, state)
    if not open_still or t1 - t0 < SMALLEST:
        state[GIVEN_UP] += open_still
        state[UPPER] = max(state[UPPER], bound + lost)
        return foot.leaf, n_open
    bound += lost
    if seen.piece != j:
        before = n_open
        n_open = _cut_beside_joints(
            pair, heap, n_open, bound, i, t0, t1, t, j, seen.piece, foot.leaf
        )
        if n_open > before:
            return foot.leaf, n_open
    chosen = math.nan
    # next to each other the two branches cross where B's pieces meet: there, or halving creeps up on it
    beside = abs(seen.leaf - foot.leaf) <= 1
    if was_cut == 0.0 and (beside or bound < 2.0 * state[DISTANCE]):
        s, reached = slide_from(pa, pb, i, t, j, s, shift_x, shift_y)
        if seen.distance < reached * (1.0 - 1e-12):
            crossing = self_bisector(
                pa, pb, i, middle, t, j, foot.local, seen.piece, seen.local, shift_x, shift_y
            )
            state[BISECTORS] += 1.0
            if not math.isnan(crossing):
                chosen = crossing
                consider(pa, pb, lb, i, crossing, shift_x, shift_y, foot.leaf, state, work)
        elif 0.0 < share < 1.0:
            chosen = t
    special = 1.0
    if not t0 < chosen < t1:
        chosen, special = middle, 0.0
    n_open = _push(heap, n_open, bound, t0, chosen, foot.leaf, special, i)
    n_open = _push(heap, n_open, bound, chosen, t1, foot.leaf, special, i)
    return foot.leaf, n_open


@kernel
def close(pair, aim, state, work, composed, heap, n_open):
    """Works the queue off, the greatest bound first, until nothing open matters; returns the heap.

    What the budget leaves is bounded by the first entry left.
    """
    while n_open > 0 and state[LOWER] <= aim.limit:
        first = heap[0, BOUND]
        done = first <= settled_below(aim, state)
        if done or state[CUTS] > aim.budget:
            state[UPPER] = max(state[UPPER], first)
            state[GIVEN_UP] += 0 if done else n_open
            break
        n_open = _pop(heap, n_open)
        row = heap[n_open]
        t0, t1, hint, was_cut, i = row[T0], row[T1], int(row[HINT]), row[WAS_CUT], int(row[PIECE])
        if n_open + ROOM > heap.shape[0]:
            heap = grown(heap)
        _, n_open = examine(
            pair, aim, i, t0, t1, hint, was_cut, state, work, composed, heap, n_open
        )
    return heap

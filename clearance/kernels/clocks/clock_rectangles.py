"""Rectangles of two clocks' times, the queue of those to visit, and the band of times that can occur together.

A rectangle is a span of one clock's time by one of the other's, each a node of a `ClockTree` or a part of an
interval. Times t_a and t_b occur together where |t_a - t_b| is at most the slack of the clocks.
Not for: the visit of a rectangle (`unsynchronised`, `unsynchronised_steps`).
"""

from typing import NamedTuple

import numpy as np

from clearance.compile.decorators import inline
from clearance.kernels.clocks.clock_tree import is_leaf_of_clock

DEPTH = 256
"""Most waiting rectangles, one a halving: two clocks of 2^50 leaves, each interval halved 52 times."""


class Band(NamedTuple):
    """Which times occur together.

    Attributes:
        slack: [s] the greatest difference of two clocks; infinite where nothing ties them.
        rounding: [s] of computed times, with a margin.
    """

    slack: float
    rounding: float


class Rectangle(NamedTuple):
    """A span of each clock's time: a node, or for a leaf the part from `low` to `high`, 0 to 1."""

    node_a: int
    node_b: int
    low_a: float
    high_a: float
    low_b: float
    high_b: float


ALL_TIMES = Rectangle(0, 0, 0.0, 1.0, 0.0, 1.0)
"""All of both clocks' times."""


class RectangleStack(NamedTuple):
    """Rectangles that wait, each with its pairs to visit.

    Attributes:
        nodes: (DEPTH, 2). shares: (DEPTH, 4) low and high of both. counts: (DEPTH,) pairs. pairs: (DEPTH, p).
        listed: (p,) the pairs of the current rectangle.
    """

    nodes: np.ndarray
    shares: np.ndarray
    counts: np.ndarray
    pairs: np.ndarray
    listed: np.ndarray


@inline
def new_rectangle_stack(n_pairs):
    """An empty queue of rectangles."""
    return RectangleStack(
        np.empty((DEPTH, 2), dtype=np.int64), np.empty((DEPTH, 4)), np.empty(DEPTH, dtype=np.int64),
        np.empty((DEPTH, n_pairs), dtype=np.int64), np.arange(n_pairs),
    )  # fmt: skip


@inline
def put_rectangle(rectangle, count, waiting, place):
    """Queues a rectangle at a place, with the first `count` of the listed pairs."""
    r = rectangle
    waiting.nodes[place, 0], waiting.nodes[place, 1] = r.node_a, r.node_b
    shares = waiting.shares[place]
    shares[0], shares[1], shares[2], shares[3] = r.low_a, r.high_a, r.low_b, r.high_b
    waiting.counts[place] = count
    for k in range(count):
        waiting.pairs[place, k] = waiting.listed[k]


@inline
def read_rectangle(waiting, place):
    """The rectangle that waits at a place, and its number of pairs; lists the pairs."""
    count = waiting.counts[place]
    for k in range(count):
        waiting.listed[k] = waiting.pairs[place, k]
    nodes, s = waiting.nodes[place], waiting.shares[place]
    return Rectangle(nodes[0], nodes[1], s[0], s[1], s[2], s[3]), count


class OpenRectangle(NamedTuple):
    """A rectangle to be halved.

    Attributes:
        in_a: True for halves in the time of clock a. count: number of listed pairs to ask there.
        seen: [s] by the clock to be halved; the half nearer to this time is visited first.
    """

    rectangle: Rectangle
    in_a: bool
    count: int
    seen: float


@inline
def put_open(tree_a, tree_b, part, waiting, place):
    """Queues both halves of an `OpenRectangle` at a place and the next."""
    earlier, later = halves_of(tree_a, tree_b, part.rectangle, part.in_a)
    if part.seen > middle_of_side(tree_a, tree_b, part.rectangle, part.in_a):
        earlier, later = later, earlier
    put_rectangle(later, part.count, waiting, place)
    put_rectangle(earlier, part.count, waiting, place + 1)


@inline(force=True)
def is_whole(low, high):
    """True for all of a node."""
    return low == 0.0 and high == 1.0


@inline(force=True)
def _time(tree, node, share):
    """[s] at a share of a node."""
    low, high = tree.low[node], tree.high[node]
    return high if share == 1.0 else low + share * (high - low)


@inline(force=True)
def _middle(tree, node, low, high):
    """[s] the time of the pose that represents a node or its part."""
    if is_whole(low, high):
        return tree.middle[node]
    return _time(tree, node, 0.5 * (low + high))


@inline
def meets_band(tree_a, tree_b, rectangle, band):
    """False if no two times of the rectangle occur together."""
    r, reach = rectangle, band.slack + 2.0 * band.rounding
    return (
        _time(tree_a, r.node_a, r.low_a) - _time(tree_b, r.node_b, r.high_b) <= reach
        and _time(tree_b, r.node_b, r.low_b) - _time(tree_a, r.node_a, r.high_a) <= reach
    )


@inline
def middle_occurs(tree_a, tree_b, rectangle, band):
    """True if the two times that represent a rectangle occur together."""
    r = rectangle
    t_a = _middle(tree_a, r.node_a, r.low_a, r.high_a)
    t_b = _middle(tree_b, r.node_b, r.low_b, r.high_b)
    return abs(t_a - t_b) <= band.slack + 2.0 * band.rounding


@inline(force=True)
def _share(tree, node, time):
    low, high = tree.low[node], tree.high[node]
    return (time - low) / (high - low)


@inline
def clipped(tree_a, tree_b, rectangle, band):
    """The least rectangle about the part within the band of a rectangle of two intervals' parts.

    Its middle lies in the band. Let a0, a1 be the ends of the one part and b0, b1 those of the other. Each end
    occurs together with some time of the other part, so a1 <= b1 + slack and a0 <= b0 + slack. Half their sum is
    the same for the middles, and so with a and b exchanged.
    """
    r, reach = rectangle, band.slack + band.rounding
    a0, a1 = _time(tree_a, r.node_a, r.low_a), _time(tree_a, r.node_a, r.high_a)
    b0, b1 = _time(tree_b, r.node_b, r.low_b), _time(tree_b, r.node_b, r.high_b)
    low_a, high_a, low_b, high_b = r.low_a, r.high_a, r.low_b, r.high_b
    if b0 - reach > a0:
        low_a = min(high_a, max(low_a, _share(tree_a, r.node_a, b0 - reach)))
    if b1 + reach < a1:
        high_a = max(low_a, min(high_a, _share(tree_a, r.node_a, b1 + reach)))
    if a0 - reach > b0:
        low_b = min(high_b, max(low_b, _share(tree_b, r.node_b, a0 - reach)))
    if a1 + reach < b1:
        high_b = max(low_b, min(high_b, _share(tree_b, r.node_b, a1 + reach)))
    return Rectangle(r.node_a, r.node_b, low_a, high_a, low_b, high_b)


@inline
def _halves_in_a(tree, r):
    if is_leaf_of_clock(tree, r.node_a):
        at = 0.5 * (r.low_a + r.high_a)
        return (
            Rectangle(r.node_a, r.node_b, r.low_a, at, r.low_b, r.high_b),
            Rectangle(r.node_a, r.node_b, at, r.high_a, r.low_b, r.high_b),
        )
    earlier = tree.earlier[r.node_a]
    return (
        Rectangle(earlier, r.node_b, 0.0, 1.0, r.low_b, r.high_b),
        Rectangle(earlier + 1, r.node_b, 0.0, 1.0, r.low_b, r.high_b),
    )


@inline
def _halves_in_b(tree, r):
    if is_leaf_of_clock(tree, r.node_b):
        at = 0.5 * (r.low_b + r.high_b)
        return (
            Rectangle(r.node_a, r.node_b, r.low_a, r.high_a, r.low_b, at),
            Rectangle(r.node_a, r.node_b, r.low_a, r.high_a, at, r.high_b),
        )
    earlier = tree.earlier[r.node_b]
    return (
        Rectangle(r.node_a, earlier, r.low_a, r.high_a, 0.0, 1.0),
        Rectangle(r.node_a, earlier + 1, r.low_a, r.high_a, 0.0, 1.0),
    )


@inline
def halves_of(tree_a, tree_b, rectangle, in_a):
    """The earlier and the later half of a rectangle, halved in a's time or in b's."""
    if in_a:
        return _halves_in_a(tree_a, rectangle)
    return _halves_in_b(tree_b, rectangle)


@inline
def middle_of_side(tree_a, tree_b, rectangle, of_a):
    """[s] the middle of a rectangle in the time of one clock."""
    r = rectangle
    if of_a:
        return 0.5 * (_time(tree_a, r.node_a, r.low_a) + _time(tree_a, r.node_a, r.high_a))
    return 0.5 * (_time(tree_b, r.node_b, r.low_b) + _time(tree_b, r.node_b, r.high_b))

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


class Span(NamedTuple):
    """A span of one clock's time: a node, or for a leaf the part from `low` to `high`, 0 to 1."""

    node: int
    low: float
    high: float


class Rectangle(NamedTuple):
    """A span of each clock's time."""

    a: Span
    b: Span


ALL_TIMES = Rectangle(Span(0, 0.0, 1.0), Span(0, 0.0, 1.0))
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
    a, b = rectangle.a, rectangle.b
    waiting.nodes[place, 0], waiting.nodes[place, 1] = a.node, b.node
    shares = waiting.shares[place]
    shares[0], shares[1], shares[2], shares[3] = a.low, a.high, b.low, b.high
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
    return Rectangle(Span(nodes[0], s[0], s[1]), Span(nodes[1], s[2], s[3])), count


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
    a, b = part.rectangle
    tree, span = (tree_a, a) if part.in_a else (tree_b, b)
    first, last = _halves(tree, span)
    if not part.seen > 0.5 * (begin_of(tree, span) + end_of(tree, span)):
        first, last = last, first
    for half in (first, last):
        put_rectangle(
            Rectangle(half, b) if part.in_a else Rectangle(a, half), part.count, waiting, place
        )
        place += 1


@inline
def _halves(tree, span):
    """The earlier and the later half of a span."""
    if is_leaf_of_clock(tree, span.node):
        at = 0.5 * (span.low + span.high)
        return Span(span.node, span.low, at), Span(span.node, at, span.high)
    earlier = tree.earlier[span.node]
    return Span(earlier, 0.0, 1.0), Span(earlier + 1, 0.0, 1.0)


@inline(force=True)
def is_whole(span):
    """True for all of a node."""
    return span.low == 0.0 and span.high == 1.0


@inline(force=True)
def _time(tree, node, share):
    """[s] at a share of a node."""
    low, high = tree.low[node], tree.high[node]
    return high if share == 1.0 else low + share * (high - low)


@inline(force=True)
def begin_of(tree, span):
    """[s] the first time of a span."""
    return _time(tree, span.node, span.low)


@inline(force=True)
def end_of(tree, span):
    """[s] the last time of a span."""
    return _time(tree, span.node, span.high)


@inline(force=True)
def _middle(tree, span):
    """[s] the time of the pose that represents a span."""
    if is_whole(span):
        return tree.middle[span.node]
    return _time(tree, span.node, 0.5 * (span.low + span.high))


@inline
def meets_band(tree_a, tree_b, rectangle, band):
    """False if no two times of the rectangle occur together."""
    a, b, reach = rectangle.a, rectangle.b, band.slack + 2.0 * band.rounding
    return (
        begin_of(tree_a, a) - end_of(tree_b, b) <= reach
        and begin_of(tree_b, b) - end_of(tree_a, a) <= reach
    )


@inline
def middle_occurs(tree_a, tree_b, rectangle, band):
    """True if the two times that represent a rectangle occur together."""
    between = abs(_middle(tree_a, rectangle.a) - _middle(tree_b, rectangle.b))
    return between <= band.slack + 2.0 * band.rounding


@inline(force=True)
def _within(tree, span, begin, end):
    """The part of a span that is not before `begin` [s] nor after `end`; never less than a time."""
    low, high, first, last = span.low, span.high, tree.low[span.node], tree.high[span.node]
    if begin > begin_of(tree, span):
        low = min(high, max(low, (begin - first) / (last - first)))
    if end < end_of(tree, span):
        high = max(low, min(high, (end - first) / (last - first)))
    return Span(span.node, low, high)


@inline
def clipped(tree_a, tree_b, rectangle, band):
    """The least rectangle about the part within the band of a rectangle of two intervals' parts.

    Its middle lies in the band. Let a0, a1 be the ends of the one part and b0, b1 those of the other. Each end
    occurs together with some time of the other part, so a1 <= b1 + slack and a0 <= b0 + slack. Half their sum is
    the same for the middles, and so with a and b exchanged.
    """
    a, b, reach = rectangle.a, rectangle.b, band.slack + band.rounding
    return Rectangle(
        _within(tree_a, a, begin_of(tree_b, b) - reach, end_of(tree_b, b) + reach),
        _within(tree_b, b, begin_of(tree_a, a) - reach, end_of(tree_a, a) + reach),
    )

"""The pairs of each body in the order of their bounds, so that most are skipped without a visit.

If only the first body of a pair moves, its motion lowers the bounds of all its pairs alike. Their order lasts
until one of them is measured, and the first bound beyond the best ends the visit of the list. Pairs of two moving
bodies (`world`) come last in the list of the first body, in no order: each is visited.
"""

from typing import NamedTuple

import numpy as np

from clearance.compile.declared import Integers
from clearance.compile.decorators import inline


class PairOrder(NamedTuple):
    """The pairs of body k are `pairs[starts[k]:starts[k + 1]]`; in order are those before `ends[k]`.

    Attributes:
        starts: (bodies + 2,). After the lists of all bodies comes a list of one: the pair to ask first.
        ends: (bodies + 1,).
        pairs: (p + 1,).
    """

    starts: Integers
    ends: Integers
    pairs: Integers


@inline
def new_pair_order(n_bodies, n_pairs):
    """No pair is in a list yet."""
    return PairOrder(
        np.zeros(n_bodies + 2, dtype=np.int64), np.zeros(n_bodies + 1, dtype=np.int64),
        np.empty(n_pairs + 1, dtype=np.int64),
    )  # fmt: skip


@inline
def fill_order(body_pairs, frames, order):
    """Fills the lists from (p, 2) bodies and the links that carry them, each in the order of the pairs."""
    starts, ends = order.starts, order.ends
    for pair in range(len(body_pairs)):
        starts[body_pairs[pair, 0]] += 1
    end = 0
    for body in range(len(starts) - 1):
        end += starts[body]
        starts[body] = end
    starts[len(starts) - 1] = end + 1
    for turn in range(2):  # backwards: first the pairs of two moving bodies
        for pair in range(len(body_pairs) - 1, -1, -1):
            body = body_pairs[pair, 0]
            if (frames[body_pairs[pair, 1]] >= 0) == (turn == 0):
                starts[body] -= 1
                order.pairs[starts[body]] = pair
        if turn == 0:
            for body in range(len(ends)):
                ends[body] = starts[body]
    ends[len(ends) - 1] = end + 1


@inline
def sort_all(bounds, order):
    """Puts each list in the order of the pairs' bounds (p,): Shell 1959."""
    pairs = order.pairs
    for body in range(len(order.starts) - 2):
        start, end = order.starts[body], order.ends[body]
        step = (end - start) // 2
        while step > 0:
            for place in range(start + step, end):
                pair = pairs[place]
                k = place
                while k >= start + step and bounds[pairs[k - step]] > bounds[pair]:
                    pairs[k] = pairs[k - step]
                    k -= step
                pairs[k] = pair
            step //= 2


@inline(force=True)
def _move_on(bounds, pairs, place, end):
    """Moves a pair from its place to its place in order before `end`; those after it are in order."""
    pair = pairs[place]
    while place + 1 < end and bounds[pairs[place + 1]] < bounds[pair]:
        pairs[place] = pairs[place + 1]
        place += 1
    pairs[place] = pair


@inline(force=True)
def sort_first(bounds, order, body, stop):
    """The same for a body where only the bounds of pairs before the place `stop` have changed."""
    for place in range(stop - 1, order.starts[body] - 1, -1):
        _move_on(bounds, order.pairs, place, order.ends[body])


@inline(force=True)
def sort_one(bounds, order, body, pair):
    """The same where only the bound of one pair has changed."""
    pairs = order.pairs
    place = order.starts[body]
    while place < order.ends[body] and pairs[place] != pair:
        place += 1
    if place == order.ends[body]:  # a pair of two moving bodies
        return
    while place > order.starts[body] and bounds[pairs[place - 1]] > bounds[pair]:
        pairs[place] = pairs[place - 1]
        place -= 1
    pairs[place] = pair
    _move_on(bounds, pairs, place, order.ends[body])

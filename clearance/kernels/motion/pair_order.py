"""The pairs of each body, that with the least bound first, so that most need no look to be passed over.

Only one body of a pair moves (`sweep.World`), so what it moves takes the same from the bounds of all its pairs:
their order lasts until one of them is measured. The first whose bound is beyond the best ends the look at a body.
"""

from typing import NamedTuple

import numpy as np

from clearance.compile.jit import inline, shared


class PairOrder(NamedTuple):
    """The pairs of body k are `pairs[starts[k]:starts[k + 1]]`.

    Attributes:
        starts: (bodies + 2,). After all bodies' there is a list of one: the pair that is asked first.
        pairs: (p + 1,).
    """

    starts: np.ndarray
    pairs: np.ndarray


@shared
def new_pair_order(n_bodies, n_pairs):
    """No pair is in a list yet."""
    return PairOrder(np.zeros(n_bodies + 2, dtype=np.int64), np.empty(n_pairs + 1, dtype=np.int64))


@inline
def fill_order(body_pairs, order):
    """Fills the lists from (p, 2) bodies, the first of which moves; each in the order of the pairs."""
    starts = order.starts
    for pair in range(len(body_pairs)):
        starts[body_pairs[pair, 0]] += 1
    end = 0
    for body in range(len(starts) - 1):
        end += starts[body]
        starts[body] = end
    starts[len(starts) - 1] = end + 1
    for pair in range(len(body_pairs) - 1, -1, -1):
        body = body_pairs[pair, 0]
        starts[body] -= 1
        order.pairs[starts[body]] = pair


@inline
def sort_all(bounds, order):
    """Puts each list in the order of the pairs' bounds (p,): Shell 1959."""
    pairs = order.pairs
    for body in range(len(order.starts) - 2):
        start, end = order.starts[body], order.starts[body + 1]
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
    """Moves a pair on from its place to where it belongs before `end`, if those after it are in order."""
    pair = pairs[place]
    while place + 1 < end and bounds[pairs[place + 1]] < bounds[pair]:
        pairs[place] = pairs[place + 1]
        place += 1
    pairs[place] = pair


@inline(force=True)
def sort_first(bounds, order, body, stop):
    """The same for a body where only the bounds of pairs before the place `stop` have changed."""
    for place in range(stop - 1, order.starts[body] - 1, -1):
        _move_on(bounds, order.pairs, place, order.starts[body + 1])


@inline(force=True)
def sort_one(bounds, order, body, pair):
    """The same where only the bound of one pair has changed."""
    pairs = order.pairs
    place = order.starts[body]
    while pairs[place] != pair:
        place += 1
    while place > order.starts[body] and bounds[pairs[place - 1]] > bounds[pair]:
        pairs[place] = pairs[place - 1]
        place -= 1
    pairs[place] = pair
    _move_on(bounds, pairs, place, order.starts[body + 1])

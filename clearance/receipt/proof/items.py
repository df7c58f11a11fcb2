"""What is still to be proven: a part of each of two bodies over a part of a stretch; items that are cut in two.

All begins with whole bodies over the whole stretch, and what an item is cut into covers it, so that nothing can be
left out. Not for: proving (`proof`).
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from typing import NamedTuple

import numpy as np

from clearance.receipt.proof.motion_data import Stretch

BALLS, BYTE_DIRECTION, SHORT_DIRECTION, LONG_DIRECTION, CUT_TIME, CUT_A, CUT_B = range(7)
"""What is done with an item: proven as balls or along a direction of 1, 2 or 4 bytes a coordinate; or cut."""

DEEPEST = 36
"""Halvings of an interval at most: pieces begin and end at floats, and their numbers are 64 bits long."""

EIGHTHS = 3
"""Cuts below a node that its bound looks at (`halving.over_corners`)."""

MOST_CUTS = 40
"""Of a body; more than any has that fits in memory."""


class Items(NamedTuple):
    """Items, (k,) each.

    Attributes:
        pair: of the stretch. node_a, node_b: the parts of its bodies.
        start, span: the intervals of the stretch; where `depth` is above 0, there is one, and the item is part
            number `part` of 2^depth equal parts of it.
    """

    pair: np.ndarray
    node_a: np.ndarray
    node_b: np.ndarray
    start: np.ndarray
    span: np.ndarray
    part: np.ndarray
    depth: np.ndarray

    def of(self, rows: np.ndarray | slice) -> Items:
        """Some of the items."""
        return Items(*(column[rows] for column in self))

    def rows(self) -> tuple[np.ndarray, np.ndarray]:
        """(r,) each: the item and the interval of each row that is to be proven."""
        item = np.repeat(np.arange(len(self.span)), self.span)
        ends = np.cumsum(self.span)
        return item, np.arange(len(item)) - (ends - self.span)[item] + self.start[item]


def first_items(n_pairs: int, n_intervals: int) -> Items:
    """Whole bodies over the whole stretch."""
    zero = np.zeros(n_pairs, dtype=np.int64)
    return Items(np.arange(n_pairs), zero, zero, zero, np.full(n_pairs, n_intervals), zero, zero)


def cut(items: Items, deeds: np.ndarray) -> Items:
    """What is left to prove of items, those that are not cut being proven; two in place of each other one."""
    rows = np.flatnonzero(deeds >= CUT_TIME)
    deed = np.repeat(deeds[rows], 2)
    found = Items(*(np.repeat(column[rows], 2) for column in items))
    second = np.arange(len(deed)) % 2
    in_a, in_b, in_time = (deed == which for which in (CUT_A, CUT_B, CUT_TIME))
    many = in_time & (found.span > 1)
    inside = in_time & (found.span == 1)
    half = found.span // 2
    return Items(
        found.pair,
        np.where(in_a, 2 * found.node_a + 1 + second, found.node_a),
        np.where(in_b, 2 * found.node_b + 1 + second, found.node_b),
        np.where(many & (second == 1), found.start + half, found.start),
        np.where(many, np.where(second == 1, found.span - half, half), found.span),
        np.where(inside, 2 * found.part + second, found.part),
        np.where(inside, found.depth + 1, found.depth),
    )


def depths_reached(
    stretches: Sequence[Stretch], n_bodies: int, deeds: Callable[[int], np.ndarray]
) -> np.ndarray:
    """(bodies,) how often the finest node of each that is spoken of, or looked at for it, is cut out of the body.

    Args:
        deeds: what is done with the next so many items.
    """
    found = np.zeros(n_bodies, dtype=np.int64)
    for stretch in stretches:
        items = first_items(len(stretch.pairs), stretch.n_intervals)
        while len(items.pair) and found.max() < MOST_CUTS:
            done = deeds(len(items.pair))
            for k, nodes, deed in ((0, items.node_a, CUT_A), (1, items.node_b, CUT_B)):
                rows = np.flatnonzero(done == deed)
                depth = np.frexp(nodes[rows] + 1.0)[1]  # of the halves
                np.maximum.at(found, stretch.pairs[items.pair[rows], k], depth)
            items = cut(items, done)
    return found + EIGHTHS

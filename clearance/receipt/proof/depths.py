"""How finely evidence cuts each body, so that no body is cut finer than it has to be. Not for: proving."""

from __future__ import annotations

from collections.abc import Callable, Sequence

import numpy as np

from clearance.receipt.proof.items import CUT_A, CUT_B, cut, first_items
from clearance.receipt.proof.motion_data import Stretch

EIGHTHS = 3
"""Cuts below a node that its bound looks at (`halving.over_corners`)."""

MOST_CUTS = 40
"""Of a body; more than any has that fits in memory."""


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

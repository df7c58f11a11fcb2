"""Events of contact: unbroken stretches in which a pair overlaps, and the step of each that is worked out.

What is rated is cheap: how far 26 directions and the normals of one body would have to part the hulls, or how much
two solids share. Not for: how deep a pair is (`contacts`).
"""

from __future__ import annotations

from collections.abc import Callable, Iterator
from typing import NamedTuple

import numpy as np

from clearance.geometry.envelope import TWENTY_SIX

MOST_RATED = 32
"""Steps of an event that are rated, evenly spread; as many again on both sides of the best."""

MOST_DEEPER = 32
"""Steps of an event that are worked out at most, its best rated one first, as long as the next may be deeper."""

MOST_NORMALS = 32
"""Normals of a body along which hulls are rated."""

MOST_NUMBERS = 2_000_000
"""Numbers in a table of poses, directions and corners: 16 MB."""


class ContactEvent(NamedTuple):
    """One pair in contact, without a break; `rows` (k,) are those of `ContactRows`, steps in order."""

    i_pair: int
    rows: np.ndarray


def events_of(steps: np.ndarray, pairs: np.ndarray) -> Iterator[ContactEvent]:
    """The events of all pairs, pair by pair.

    Args:
        steps, pairs: (n,) of each row, steps first.
    """
    order = np.lexsort((steps, pairs))
    begins = (np.diff(pairs[order]) != 0) | (np.diff(steps[order]) != 1)
    for rows in np.split(order, np.flatnonzero(begins) + 1):
        if len(rows):
            yield ContactEvent(int(pairs[rows[0]]), rows)


def rated_places(
    n_steps: int, rated: Callable[[np.ndarray], np.ndarray], most: int = MOST_RATED
) -> tuple[np.ndarray, np.ndarray]:
    """At most `most` of `n_steps` places and as many about the best of them, with their ratings, greatest first.

    Args:
        rated: the ratings of some places.
    """
    places = np.unique(np.linspace(0, n_steps - 1, min(n_steps, most)).round().astype(np.int64))
    ratings = rated(places)
    if len(places) < n_steps:
        best = int(np.argmax(ratings))
        low, high = places[max(0, best - 1)], places[min(len(places) - 1, best + 1)]
        near = np.linspace(low, high, min(high - low + 1, most)).round().astype(np.int64)
        near = np.setdiff1d(near, places)
        places, ratings = np.append(places, near), np.append(ratings, rated(near))
    order = np.lexsort((places, -ratings))
    return places[order], ratings[order]


def hull_depths(
    corners_a: np.ndarray, corners_b: np.ndarray, normals_b: np.ndarray, b_from_a: np.ndarray
) -> np.ndarray:
    """(k,) [m] no less than the depth of the hull of a in that of b, by 26 directions and some normals of b.

    Args:
        corners_a, corners_b: (n, 3), (m, 3) [m]. b_from_a: (k, 4, 4).
    """
    every = max(1, -(-len(normals_b) // MOST_NORMALS))
    directions = np.concatenate([TWENTY_SIX, normals_b[::every]])
    highest = (directions @ corners_b.T).max(axis=1)
    at_once = max(1, MOST_NUMBERS // (len(directions) * len(corners_a)))
    found = []
    for i in range(0, len(b_from_a), at_once):
        turns, shifts = b_from_a[i : i + at_once, :3, :3], b_from_a[i : i + at_once, :3, 3]
        lowest = (directions @ turns @ corners_a.T).min(axis=2) + shifts @ directions.T
        found.append((highest - lowest).min(axis=1))
    return np.concatenate([np.empty(0), *found])  # no step may be near the best

"""The way out of a concave body: short translations that part two bodies, found on their convex parts.

Bodies made of parts overlap while the translation lies in one of the Minkowski differences of their parts. On
a ray each of these is a stretch; the first gap between the stretches is a way out. Rays go along the normals
of the parts; the best ones are shortened by asking the bodies themselves. What comes out is an upper bound of
the depth. Not for: two convex bodies (`penetration`).
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from typing import NamedTuple

import numpy as np

from clearance.query.penetration import TWENTY_SIX, Corners

MOST_DIRECTIONS = 192
RAYS_ASKED = 6
"""Rays on which the bodies themselves are asked, the shortest first."""

HALVINGS = 10
"""A ray's length is right to this many halvings of what it could be shortened by."""

APART = np.cos(np.radians(5.0))
"""Rays closer to each other than 5 degrees count as one."""


class Ray(NamedTuple):
    """A translation [m] along a unit direction."""

    length: float
    direction: np.ndarray


def ways_out(
    a: Sequence[Corners], b: Sequence[Corners], within: float, extra: np.ndarray
) -> list[Ray]:
    """Translations of the parts `a` that part all of them from all of `b`, shortest first.

    Args:
        within: [m] none longer is sought. extra: (k, 3) unit directions to try as well.

    Exactness: each part pair's Minkowski difference is held by its support planes along all directions tried,
        so a way out of these is a way out of the parts.
    """
    directions = _directions(a, b, extra)
    heights_a = np.array([(-directions @ part.vertices.T).max(axis=1) for part in a])
    heights_b = np.array([(directions @ part.vertices.T).max(axis=1) for part in b])
    offsets = (heights_a[:, None] + heights_b[None]).reshape(-1, len(directions))
    offsets = offsets[(-offsets).max(axis=1) < within]
    lengths = np.array([_first_gap(offsets, directions @ way) for way in directions])
    order = np.argsort(lengths, kind="stable")
    return [Ray(float(lengths[i]), directions[i]) for i in order if lengths[i] <= within]


def _first_gap(offsets: np.ndarray, slopes: np.ndarray) -> float:
    """[m] where a ray first leaves all sets {t: directions t <= offsets row} that follow each other on it."""
    up, down = slopes > 1e-9, slopes < -1e-9
    ends = (offsets[:, up] / slopes[up]).min(axis=1, initial=np.inf)
    begins = (offsets[:, down] / slopes[down]).max(axis=1, initial=-np.inf)
    met = (begins < ends) & (offsets[:, ~(up | down)] > 0.0).all(axis=1)
    begins, ends = begins[met], ends[met]
    at = 0.0
    while True:
        here = (begins <= at) & (ends > at)
        if not here.any():
            return at
        at = float(ends[here].max())


def _directions(a: Sequence[Corners], b: Sequence[Corners], extra: np.ndarray) -> np.ndarray:
    """(k, 3) unit, no two alike to a tenth: what is asked for, the 26, and the parts' normals in turn."""
    normals = np.concatenate([*(part.normals for part in b), *(-part.normals for part in a)])
    every = max(1, len(normals) // (4 * MOST_DIRECTIONS))
    rows = np.concatenate([extra, TWENTY_SIX, normals[::every]])
    _, first = np.unique(np.round(rows, 1), axis=0, return_index=True)
    kept = np.sort(first)
    fixed = kept[kept < len(extra) + 26]
    rest = kept[len(fixed) :]
    return rows[np.concatenate([fixed, rest[:: max(1, -(-len(rest) // MOST_DIRECTIONS))]])]


def shortened(rays: Sequence[Ray], is_clear: Callable[[np.ndarray], bool]) -> Ray | None:
    """The shortest translation along one of the rays that the bodies themselves confirm; None if none is.

    Args:
        is_clear: True if the bodies are apart after a translation (3,) [m].
    """
    best: Ray | None = None
    for ray in _different(rays):
        asked = ray.length if best is None else min(ray.length, 0.99 * best.length)
        if is_clear(asked * ray.direction):
            best = Ray(_halved(asked, ray.direction, is_clear), ray.direction)
    return best


def _different(rays: Sequence[Ray]) -> list[Ray]:
    chosen: list[Ray] = []
    for ray in rays:
        if all(ray.direction @ other.direction < APART for other in chosen):
            chosen.append(ray)
        if len(chosen) == RAYS_ASKED:
            break
    return chosen


def _halved(clear: float, direction: np.ndarray, is_clear: Callable[[np.ndarray], bool]) -> float:
    """A length below `clear` that is clear too; clear lengths need not be all above one another."""
    blocked = 0.0
    for _ in range(HALVINGS):
        middle = 0.5 * (blocked + clear)
        if is_clear(middle * direction):
            clear = middle
        else:
            blocked = middle
    return clear

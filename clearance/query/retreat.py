"""The separation vector of concave bodies: short translations that separate them, found on their convex parts.

Bodies made of parts overlap while the translation lies in one of the Minkowski differences of their parts. On
a ray each of these is a stretch; the first gap between the stretches is a separation. Rays go along the normals
of the parts; the best ones are shortened by the bodies' own distance. The result is an upper bound of
the depth. Not for: two convex bodies (`penetration`).
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from typing import NamedTuple

import numpy as np

from clearance.geometry.envelope import TWENTY_SIX
from clearance.query.penetration import ConvexCorners

MOST_DIRECTIONS = 192
MOST_NUMBERS = 2_000_000
"""Numbers in a table of rays, sets and planes: 16 MB."""

RAYS_ASKED = 6
"""Rays on which the bodies themselves are measured, the shortest first."""

HALVINGS = 10
"""A ray's length is right to this many halvings of what it could be shortened by."""

GOES_ON = 5
"""How often a ray is made longer until the bodies are separate."""

ALIKE = np.cos(np.radians(5.0))
"""Rays closer to each other than 5 degrees count as one."""


class Ray(NamedTuple):
    """A translation [m] along a unit direction."""

    length: float
    direction: np.ndarray


def separations(
    a: Sequence[ConvexCorners], b: Sequence[ConvexCorners], within: float, extra: np.ndarray
) -> list[Ray]:
    """Translations of the parts `a` that part all of them from all of `b`, shortest first.

    Args:
        within: [m] none longer is sought. extra: (k, 3) unit directions to try as well.

    Exactness: each part pair's Minkowski difference lies within its support planes along all directions tried,
        so a separation of these is a separation of the parts.
    """
    directions = _directions(a, b, extra)
    heights_a = np.array([(-directions @ part.vertices.T).max(axis=1) for part in a])
    heights_b = np.array([(directions @ part.vertices.T).max(axis=1) for part in b])
    offsets = (heights_a[:, None] + heights_b[None]).reshape(-1, len(directions))
    offsets = offsets[(-offsets).max(axis=1) < within]
    at_once = max(1, MOST_NUMBERS // max(1, offsets.size))
    lengths = np.concatenate([
        _first_gaps(offsets, directions[i : i + at_once] @ directions.T)
        for i in range(0, len(directions), at_once)
    ])  # fmt: skip
    order = np.argsort(lengths, kind="stable")
    return [Ray(float(lengths[i]), directions[i]) for i in order if lengths[i] <= within]


def _first_gaps(offsets: np.ndarray, slopes: np.ndarray) -> np.ndarray:
    """(r,) [m] where each ray first leaves all sets {t: directions t <= offsets row} that follow each other on it.

    Args:
        offsets: (p, k) [m] of the sets. slopes: (r, k) of the rays.
    """
    up, down = slopes > 1e-9, slopes < -1e-9
    at = offsets[None] / np.where(up | down, slopes, 1.0)[:, None]
    ends = np.where(up[:, None], at, np.inf).min(axis=2)
    begins = np.where(down[:, None], at, -np.inf).max(axis=2)
    blocked = (up | down)[:, None] | (offsets[None] > 0.0)
    met = (begins < ends) & blocked.all(axis=2)
    return np.array([_gap(begins[i, m], ends[i, m]) for i, m in enumerate(met)])


def _gap(begins: np.ndarray, ends: np.ndarray) -> float:
    """The first gap after stretches that begin at 0 or before, and those that follow on them."""
    at = 0.0
    while True:
        here = (begins <= at) & (ends > at)
        if not here.any():
            return at
        at = float(ends[here].max())


def _directions(
    a: Sequence[ConvexCorners], b: Sequence[ConvexCorners], extra: np.ndarray
) -> np.ndarray:
    """(k, 3) unit, no two alike to a tenth: the wanted ones, the 26, and the parts' normals in turn."""
    normals = np.concatenate([*(part.normals for part in b), *(-part.normals for part in a)])
    every = max(1, len(normals) // (4 * MOST_DIRECTIONS))
    rows = np.concatenate([extra, TWENTY_SIX, normals[::every]])
    _, first = np.unique(np.round(rows, 1), axis=0, return_index=True)
    chosen = np.sort(first)
    fixed = chosen[chosen < len(extra) + 26]
    rest = chosen[len(fixed) :]
    return rows[np.concatenate([fixed, rest[:: max(1, -(-len(rest) // MOST_DIRECTIONS))]])]


def shortened(rays: Sequence[Ray], is_clear: Callable[[np.ndarray], bool]) -> Ray | None:
    """The shortest translation along one of the rays that the bodies themselves confirm; None if none is.

    Args:
        is_clear: True if the bodies are separate after a translation (3,) [m].
    """
    best: Ray | None = None
    for ray in _different(rays):
        length = ray.length if best is None else min(ray.length, 0.99 * best.length)
        if is_clear(length * ray.direction):
            best = Ray(_halved(length, ray.direction, is_clear), ray.direction)
    return best


def shortened_through(
    rays: Sequence[Ray],
    within: float,
    is_clear: Callable[[np.ndarray], bool],
    still_shared: Callable[[np.ndarray, np.ndarray], float],
) -> Ray | None:
    """As `shortened` for rays that need not be long enough: each goes on by as much as the bodies still share.

    Args:
        within: [m] none as long is sought.
        still_shared: [m] how thick what the bodies share is along a unit direction, after a translation (3,).
    """
    best: Ray | None = None
    for ray in _different(rays):
        length, most = ray.length, within if best is None else 0.99 * best.length
        for _ in range(GOES_ON):
            if length >= most:
                break
            if is_clear(length * ray.direction):
                best = Ray(_halved(length, ray.direction, is_clear), ray.direction)
                break
            more = still_shared(length * ray.direction, ray.direction)
            length += max(more, 0.01 * length) * (1.0 + 1e-9)
    return best


def _different(rays: Sequence[Ray]) -> list[Ray]:
    chosen: list[Ray] = []
    for ray in rays:
        if all(ray.direction @ other.direction < ALIKE for other in chosen):
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

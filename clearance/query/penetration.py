"""How deep one convex body is in another: the shortest translation that parts them, exactly.

The bodies overlap while the origin is inside the Minkowski difference b - a; the depth is the origin's
distance from its surface. A polytope inside it is grown by support points until the nearest facet cannot
be pushed out any farther. Not for: concave bodies (`retreat`).
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import NamedTuple

import numpy as np

from clearance.errors import BadShape
from clearance.geometry.envelope import TWENTY_SIX
from clearance.geometry.polytope import Polytope

ROUNDING = 32 * 2.0**-53
"""[-] What upper and lower bound may differ by, relative to the bodies' size: a few roundings of a plane."""

MAX_ROUNDS = 64
BATCH = 48
"""Facets pushed out in one round, the nearest first."""

SEEDS = 96
"""Faces of each body whose normals begin the search."""


class ConvexCorners(NamedTuple):
    """A convex body for the search: vertices (n, 3) [m], outward normals (f, 3) of some faces."""

    vertices: np.ndarray
    normals: np.ndarray

    @classmethod
    def placed(cls, part: Polytope, pose: np.ndarray) -> ConvexCorners:
        """Those of a part after a rigid motion (4, 4) [m]."""
        turn = pose[:3, :3].T
        return cls(part.vertices @ turn + pose[:3, 3], part.normals @ turn)


@dataclass(frozen=True, eq=False)
class Penetration:
    """How far `a` must go to leave `b`.

    Attributes:
        depth: [m] length of the shortest translation found; 0 when they touch or are separate.
        at_least: [m] no shorter translation parts them; equals `depth` to rounding.
        direction: (3,) unit: `a` moved by `depth * direction` is separate from `b`.
        rounds: hulls built.
    """

    depth: float
    at_least: float
    direction: np.ndarray
    rounds: int


def penetration(a: Polytope | ConvexCorners, b: Polytope | ConvexCorners) -> Penetration:
    """The shortest translation of `a` that parts it from `b`.

    Raises:
        BadShape: not two polytopes.

    Exactness: `depth` is the support of b - a along `direction`, an upper bound; `at_least` is the least facet
        distance of a polytope inside b - a, a lower bound. They meet to a few roundings of the bodies' size,
        because a face of the difference is reached after finitely many support points.
    Ties: the first found; equal input gives equal output.
    Source: van den Bergen (2001), "Proximity queries and penetration depth computation on 3D game objects"
        (expanding polytope), here with many facets a round and the hulls by Qhull.
    """
    for given, where in ((a, "a"), (b, "b")):
        if not isinstance(given, Polytope | ConvexCorners):
            remedy = "a Polytope; cl.contact takes polyhedra"
            raise BadShape(f"a {type(given).__name__} is given", where=where, valid=remedy)
    return _Search(a, b).run()


def depths_at_most(a: Sequence[ConvexCorners], b: Sequence[ConvexCorners]) -> np.ndarray:
    """(len(a), len(b)) [m] no less than the depth of each of `a` in each of `b`, by 26 directions, or 0."""
    if not a or not b:
        return np.zeros((len(a), len(b)))
    lowest = np.array([(TWENTY_SIX @ body.vertices.T).min(axis=1) for body in a])
    highest = np.array([(TWENTY_SIX @ body.vertices.T).max(axis=1) for body in b])
    return np.maximum(0.0, (highest[None] - lowest[:, None]).min(axis=2))


class _Search:
    """The polytope that grows inside the Minkowski difference, and the best plane over it."""

    def __init__(self, a: Polytope | ConvexCorners, b: Polytope | ConvexCorners) -> None:
        origin = b.vertices.mean(axis=0)
        self.a, self.b = a.vertices - origin, b.vertices - origin
        self.slack = ROUNDING * 2.0 * float(np.abs(self.a).max() + np.abs(self.b).max())
        self.upper, self.direction = np.inf, np.array([0.0, 0.0, 1.0])
        self.points = np.zeros((0, 3))
        seeds = [_every(b.normals, SEEDS), -_every(a.normals, SEEDS), TWENTY_SIX]
        self._ask(np.concatenate(seeds))

    def run(self) -> Penetration:
        lower, rounds = 0.0, 0
        while self.upper > 0.0 and rounds < MAX_ROUNDS:
            planes = _facets(self.points)
            rounds += 1
            if planes is None:  # thinner than rounding: nothing is proven from below
                break
            distance = -planes[:, 3]
            lower = max(lower, float(distance.min()))
            nearest = np.argsort(distance, kind="stable")[:BATCH]
            near = nearest[distance[nearest] < self.upper - self.slack]
            if not len(near) or not self._ask(planes[near, :3]):
                break
        depth = max(0.0, self.upper)
        return Penetration(depth, min(max(0.0, lower), depth), self.direction, rounds)

    def _ask(self, normals: np.ndarray) -> bool:
        """Adds the support points along `normals`; True if one of them is new."""
        heights_a, heights_b = normals @ self.a.T, normals @ self.b.T
        i_a, i_b = heights_a.argmin(axis=1), heights_b.argmax(axis=1)
        rows = np.arange(len(normals))
        supports = heights_b[rows, i_b] - heights_a[rows, i_a]
        least = int(supports.argmin())
        if supports[least] < self.upper:
            self.upper, self.direction = float(supports[least]), normals[least].copy()
        before = len(self.points)
        self.points = np.unique(np.concatenate([self.points, self.b[i_b] - self.a[i_a]]), axis=0)
        return len(self.points) > before


def _every(rows: np.ndarray, most: int) -> np.ndarray:
    """At most `most` of the rows, evenly chosen."""
    return rows[:: max(1, -(-len(rows) // most))]


def _facets(points: np.ndarray) -> np.ndarray | None:
    """(f, 4) unit normals and offsets of the hull; None where it is flat to rounding."""
    from scipy.spatial import ConvexHull, QhullError

    try:
        return ConvexHull(points).equations
    except QhullError:
        return None

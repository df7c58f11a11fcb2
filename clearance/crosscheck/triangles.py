"""The triangles of a body as the peer gets them, and what follows from them alone: closedness, parts, insides.

FCL measures surfaces only; a winding number says what lies inside one. Two surfaces that do not touch either stand
apart or a part of one lies wholly inside the other, so one vertex of each connected part decides. Not for: the
faces that we measure; those stay polygons (`geometry.polyhedron`).
"""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property

import numpy as np

from clearance.geometry.closing import closing_of
from clearance.geometry.point_cloud import PointCloud
from clearance.geometry.polyhedron import Polyhedron


@dataclass(frozen=True, eq=False)
class TriangleSoup:
    """A body as triangles.

    Attributes:
        vertices: (n, 3) [m] in the body frame, no two equal.
        triangles: (m, 3) indices, counter-clockwise as in the faces they come from.
        turns: (m,) how often each counts in a winding number where the surface has a rim: those of closed
            components once, of components that are closed but for a few faults as `geometry.closing` says.
        radius: [m] of the balls about the points of a cloud, each of which is a triangle of one corner; else 0.
    """

    vertices: np.ndarray
    triangles: np.ndarray
    turns: np.ndarray
    radius: float = 0.0

    @property
    def corners(self) -> np.ndarray:
        """(m, 3, 3) [m] the corners of every triangle."""
        return self.vertices[self.triangles]

    @cached_property
    def bounds(self) -> np.ndarray:
        """(2, 3) [m] least and greatest coordinates, of balls those of the balls."""
        low, high = self.vertices.min(axis=0), self.vertices.max(axis=0)
        return np.array([low - self.radius, high + self.radius])

    @cached_property
    def encloses(self) -> bool:
        """True if every edge is walked as often one way as the other: the surface has no rim.

        Just then the winding number of every point off the surface is an integer. Points hold nothing.
        """
        if self.radius > 0.0:
            return False
        tails, heads = self.triangles.ravel(), np.roll(self.triangles, -1, axis=1).ravel()
        there = np.sort(tails * len(self.vertices) + heads)
        back = np.sort(heads * len(self.vertices) + tails)
        return bool(np.array_equal(there, back))

    @property
    def holds(self) -> bool:
        """True if something can be inside."""
        return self.encloses or bool(self.turns.any())

    @cached_property
    def part_points(self) -> np.ndarray:
        """(k, 3) [m] one vertex of each connected part of the surface."""
        from scipy.sparse import coo_array
        from scipy.sparse.csgraph import connected_components

        tails, heads = self.triangles.ravel(), np.roll(self.triangles, -1, axis=1).ravel()
        n = len(self.vertices)
        graph = coo_array((np.ones(len(tails), dtype=np.int8), (tails, heads)), shape=(n, n))
        _, labels = connected_components(graph, directed=False)
        used = np.unique(self.triangles)
        _, first = np.unique(labels[used], return_index=True)
        return self.vertices[used[first]]


def triangle_soup(shape: Polyhedron) -> TriangleSoup:
    """The faces cut into fans, equal vertices made one; the points of a cloud."""
    if isinstance(shape, PointCloud):
        each = np.repeat(np.arange(shape.n_points)[:, None], 3, axis=1)
        turns = np.zeros(shape.n_points, dtype=np.int64)
        return TriangleSoup(shape.vertices, each, turns, shape.ball_radius)
    vertices, index = np.unique(shape.vertices + 0.0, axis=0, return_inverse=True)
    triangles = index.ravel()[shape.triangles()]
    return TriangleSoup(vertices, triangles, _turns(shape)[shape.triangle_faces])


def _turns(shape: Polyhedron) -> np.ndarray:
    """(f,) how often each face counts."""
    turns = shape.component_closed[shape.face_component].astype(np.int64)
    closing = closing_of(shape)
    return turns if closing is None else turns + closing.turns


MARGIN = 0.25
"""[turns] A point is inside where its winding number is no farther from a whole one, and that is not 0."""

_MOST_ANGLES = 2_000_000  # solid angles held at once: about 150 MB of temporaries


def is_inside(soup: TriangleSoup, points: np.ndarray) -> np.ndarray:
    """(n,) True where a point (n, 3) [m] in the body frame is inside the closed surface.

    Exactness: the winding number of a closed surface is an integer; float64 rounding is far below
    the margin for points that are not on the surface. Where the surface is closed but for a few faults,
    points from which more than a quarter of all directions is open are not said to be inside.
    """
    inside = np.zeros(len(points), dtype=bool)
    if not soup.holds:
        return inside
    low, high = soup.bounds
    candidates = np.flatnonzero(((points > low) & (points < high)).all(axis=1))
    corners, turns = soup.corners, None if soup.encloses else soup.turns
    chunk = max(1, _MOST_ANGLES // len(corners))
    for start in range(0, len(candidates), chunk):
        chosen = candidates[start : start + chunk]
        number = np.abs(winding_number(corners, points[chosen], turns))
        inside[chosen] = number >= 1.0 - MARGIN
    return inside


def winding_number(
    corners: np.ndarray, points: np.ndarray, turns: np.ndarray | None = None
) -> np.ndarray:
    """(n,) how often the triangles (m, 3, 3), each counted `turns` (m,) times, go round each point (n, 3).

    Source: van Oosterom & Strackee 1983, equation 8 (solid angle of a triangle).
    """
    a, b, c = (corners[None, :, k] - points[:, None] for k in range(3))
    la, lb, lc = (np.sqrt(np.einsum("nmk,nmk->nm", v, v)) for v in (a, b, c))
    volume = np.einsum("nmk,nmk->nm", a, np.cross(b, c))
    ab, bc, ca = (np.einsum("nmk,nmk->nm", u, v) for u, v in ((a, b), (b, c), (c, a)))
    spread = la * lb * lc + ab * lc + bc * la + ca * lb
    parts = np.arctan2(volume, spread) / (2.0 * np.pi)
    return parts.sum(axis=1) if turns is None else (parts * turns).sum(axis=1)

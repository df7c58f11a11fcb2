"""How far a witness point is from the body it should lie on, by numpy over all triangles.

FCL takes no part: it measures a point only as a small sphere, by an iteration with errors of 2e-6 m.
"""

from __future__ import annotations

import numpy as np

from clearance.crosscheck.triangles import TriangleSoup


class PointLocator:
    """Distances of points from one body's surface; the spheres round its triangles are made
    once.
    """

    def __init__(self, soup: TriangleSoup) -> None:
        self._corners = soup.corners
        self._centres = self._corners.mean(axis=1)
        self._radii = np.linalg.norm(self._corners - self._centres[:, None], axis=2).max(axis=1)

    def distances(self, point: np.ndarray) -> np.ndarray:
        """(n,) [m] the distances of a point (3,) in the body frame from every triangle."""
        return point_triangle_distances(point, self._corners)

    def distance(self, point: np.ndarray) -> float:
        """The distance [m] of a point (3,) in the body frame from the surface."""
        return float(point_triangle_distances(point, self.near(point)).min())

    def near(self, point: np.ndarray) -> np.ndarray:
        """(k, 3, 3) the triangles of which one is nearest, by the spheres round them."""
        to_centres = np.linalg.norm(self._centres - point, axis=1)
        near = to_centres - self._radii <= (to_centres + self._radii).min() * (1 + 1e-12)
        return self._corners[near]


def point_triangle_distances(point: np.ndarray, corners: np.ndarray) -> np.ndarray:
    """(n,) [m] the distances of one point (3,) from triangles (n, 3, 3), also those without area.

    The nearest point of a triangle is in its plane's interior or on one of its sides; both are
    measured and the lesser counts.
    """
    sides = ((corners[:, k], corners[:, (k + 1) % 3]) for k in range(3))
    on_sides = np.min([_segment_distances(point, *side) for side in sides], axis=0)
    a, ab, ac = corners[:, 0], corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0]
    normals = np.cross(ab, ac)
    area_sq = (normals * normals).sum(axis=1)
    flat = area_sq == 0.0
    area_sq = np.where(flat, 1.0, area_sq)
    offset = point - a
    v = (np.cross(offset, ac) * normals).sum(axis=1) / area_sq
    w = (np.cross(ab, offset) * normals).sum(axis=1) / area_sq
    over = ~flat & (v >= 0) & (w >= 0) & (v + w <= 1)
    height = np.abs((offset * normals).sum(axis=1)) / np.sqrt(area_sq)
    return np.where(over, height, on_sides)


def _segment_distances(point: np.ndarray, starts: np.ndarray, ends: np.ndarray) -> np.ndarray:
    along = ends - starts
    length_sq = (along * along).sum(axis=1)
    t = ((point - starts) * along).sum(axis=1) / np.where(length_sq == 0.0, 1.0, length_sq)
    return np.linalg.norm(starts + t.clip(0.0, 1.0)[:, None] * along - point, axis=1)

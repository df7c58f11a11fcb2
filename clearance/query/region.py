"""The region that convex bodies share: one hull over the duals of all their planes about a common inner point.

Coordinates are taken about that point before anything is computed, so that thin regions have their digits.
Not for: deciding whether there is a region (`common_point`).
Source: Tereshchenko (2013), section 2.3.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from clearance.geometry.edges import rings_of
from clearance.geometry.polytope import Polytope, ring_moments

ON_PLANE = 8 * 2.0**-53
"""[-] How far from a plane counts as on it, relative to the greatest coordinate about the inner point."""


@dataclass(frozen=True)
class SharedPlanes:
    """Bodies about a common inner point: the first plane number of each, and what counts as on a plane [m]."""

    bodies: list[Polytope]
    origin: np.ndarray
    bases: np.ndarray
    tolerance: float

    @classmethod
    def about(cls, bodies: list[Polytope], origin: np.ndarray) -> SharedPlanes:
        """The planes; the smallest body bounds all coordinates that remain."""
        bases = np.concatenate([[0], np.cumsum([body.n_faces for body in bodies])])
        least = min(bodies, key=lambda body: body.size)
        reach = float(np.abs(least.box - origin).max())
        return cls(bodies, origin, bases, ON_PLANE * reach)

    def owners(self, planes: np.ndarray) -> np.ndarray:
        """The body of each plane, by its number."""
        return np.searchsorted(self.bases, planes, side="right") - 1


@dataclass(frozen=True, eq=False)
class Region:
    """Faces about the inner point: places (c, 3), the plane of each face, face starts, corners as places."""

    shared: SharedPlanes
    places: np.ndarray
    planes: np.ndarray
    starts: np.ndarray
    corners: np.ndarray

    @classmethod
    def of(cls, shared: SharedPlanes) -> Region | None:
        """The region of bodies, None where rounding leaves nothing; corners of a body are the given numbers."""
        normals = np.concatenate([body.normals for body in shared.bodies])
        offsets = np.concatenate([body.offsets_about(shared.origin) for body in shared.bodies])
        found = dual_rings(normals, offsets)
        if found is None:
            return None
        places, rings, meeting = found
        _put_own_corners(shared, places, shared.owners(meeting))
        return cls(shared, places, *rings)

    def moments(self) -> np.ndarray:
        """(volume [m^3], volume times centroid [m^4]) about the origin."""
        return ring_moments(self.places, self.starts, self.corners, np.zeros(3))

    def surface(self) -> tuple[np.ndarray, list[np.ndarray], np.ndarray]:
        """(corners (n, 3) [m], corners of each face, (f, 2) body and face each comes from).

        Edges no longer than rounding become a corner; faces with fewer than three remaining corners go.
        """
        rows, index = np.unique(self.corners, return_inverse=True)
        places = self.places[rows]
        ends = np.column_stack([index, index[rings_of(self.starts).ahead]])
        lengths = np.linalg.norm(places[ends[:, 0]] - places[ends[:, 1]], axis=1)
        merged = _least_of_each_cluster(len(rows), ends[lengths <= 8.0 * self.shared.tolerance])
        corners, number = np.unique(merged, return_inverse=True)
        rings, planes = [], []
        for name, ring in zip(self.planes, np.split(number[index], self.starts[1:-1]), strict=True):
            ring = ring[ring != np.roll(ring, 1)]
            if len(np.unique(ring)) > 2:
                rings.append(ring)
                planes.append(name)
        names = np.array(planes, dtype=np.int64)
        owners = self.shared.owners(names)
        provenance = np.column_stack([owners, names - self.shared.bases[owners]])
        return places[corners] + self.shared.origin, rings, provenance


Rings = tuple[np.ndarray, np.ndarray, np.ndarray]
"""The plane of each face, face starts, and corners as places, counter-clockwise from outside."""


def dual_rings(
    normals: np.ndarray, offsets: np.ndarray
) -> tuple[np.ndarray, Rings, np.ndarray] | None:
    """(places (c, 3), rings, (c, 3) the planes that meet there) of {x: normals x <= offsets} about a point inside.

    The hull of the planes' duals n / d is the region's dual: a facet there is a corner here. By Qhull; None where
    rounding leaves nothing.
    """
    from scipy.spatial import ConvexHull, QhullError

    if not (offsets > 0.0).all():
        return None
    try:
        hull = ConvexHull(normals / offsets[:, None])
    except QhullError:
        return None
    places = hull.equations[:, :3] / -hull.equations[:, 3:]
    planes, starts, corners = _rings_around(hull.simplices.tolist(), hull.neighbors.tolist())
    outward = _outward(places, normals, planes, starts, corners)
    return places, (planes, starts, outward), hull.simplices


def _rings_around(facets: list[list[int]], beyond: list[list[int]]) -> Rings:
    """The facets around each dual point, one way or the other; `beyond`: the facet beyond each corner's edge."""
    first: dict[int, int] = {}
    for i, facet in enumerate(facets):
        for plane in facet:
            first.setdefault(plane, i)
    planes, starts, corners = sorted(first), [0], list[int]()
    for plane in planes:
        i = first[plane]
        left = next(other for other in facets[i] if other != plane)
        while len(corners) == starts[-1] or i != first[plane]:
            corners.append(i)
            ahead = next(other for other in facets[i] if other not in (plane, left))
            i, left = beyond[i][facets[i].index(left)], ahead
        starts.append(len(corners))
    return np.array(planes), np.array(starts), np.array(corners)


def _outward(
    places: np.ndarray,
    normals: np.ndarray,
    planes: np.ndarray,
    starts: np.ndarray,
    corners: np.ndarray,
) -> np.ndarray:
    """The corners with each ring counter-clockwise from outside."""
    entries = np.arange(len(corners))
    first, count = starts[:-1], np.diff(starts)
    off = places[corners] - np.repeat(places[corners[first]], count, axis=0)
    areas = np.add.reduceat(np.cross(off, off[rings_of(starts).ahead]), first, axis=0)
    turned = np.repeat(np.einsum("ij,ij->i", areas, normals[planes]) < 0.0, count)
    back = np.repeat(first + starts[1:] - 1, count) - entries
    return corners[np.where(turned, back, entries)]


def _put_own_corners(shared: SharedPlanes, places: np.ndarray, owners: np.ndarray) -> None:
    """Puts places whose three planes are of one body, `owners` (c, 3), where its corner is given."""
    from scipy.spatial import cKDTree

    own = np.where((owners == owners[:, :1]).all(axis=1), owners[:, 0], -1)
    for i in np.unique(own[own >= 0]).tolist():
        given = shared.bodies[i].vertices - shared.origin
        places[own == i] = given[cKDTree(given).query(places[own == i])[1]]


def _least_of_each_cluster(n: int, pairs: np.ndarray) -> np.ndarray:
    from scipy.sparse import coo_array
    from scipy.sparse.csgraph import connected_components

    graph = coo_array((np.ones(len(pairs)), (pairs[:, 0], pairs[:, 1])), shape=(n, n))
    labels = connected_components(graph, directed=False)[1]
    least = np.full(n, n)
    np.minimum.at(least, labels, np.arange(n))
    return least[labels]

"""A cheap convex body around a body: its support planes along 26 directions; and a test whether it is concave."""

from __future__ import annotations

import itertools

import numpy as np

from clearance.geometry.polyhedron import Polyhedron
from clearance.geometry.polytope import Polytope

TWENTY_SIX = np.array([d for d in itertools.product((-1.0, 0.0, 1.0), repeat=3) if any(d)])
TWENTY_SIX /= np.linalg.norm(TWENTY_SIX, axis=1)[:, None]

SAMPLED = 64
"""Faces that are tested."""

MOST_POINTS = 4000
"""Corners that are compared with them."""

CLEARLY = 1e-3
"""[-] Of the size: a corner so far above a face says that a body is no convex one with small dents."""


def envelope(points: np.ndarray) -> Polytope:
    """The convex body within the support planes of points (n, 3) [m] along 26 directions: it contains them.

    Raises:
        NotSolid: the points are flat along one of the directions.
    """
    low, high = points.min(axis=0), points.max(axis=0)
    middle, slack = 0.5 * (low + high), 1e-12 * float((high - low).max())
    heights = ((points - middle) @ TWENTY_SIX.T).max(axis=0) + slack
    return Polytope.from_half_spaces(np.column_stack([TWENTY_SIX, -heights - TWENTY_SIX @ middle]))


def is_clearly_concave(body: Polyhedron, points: np.ndarray) -> bool:
    """True if one of the body's corners `points` (n, 3) [m] stands far above one of a few faces."""
    few = slice(None, None, max(1, body.n_faces // SAMPLED))
    points = points[:: max(1, len(points) // MOST_POINTS)]
    starts = body.face_starts[:-1][few]
    first, second, third = (body.vertices[body.face_vertices[starts + k]] for k in range(3))
    normals = np.cross(second - first, third - first)
    lengths = np.linalg.norm(normals, axis=1)
    above = (points @ normals.T).max(axis=0) - np.einsum("ij,ij->i", normals, first)
    return bool((above > CLEARLY * np.ptp(points, axis=0).max() * lengths).any())

"""The triangles of a body as the peer gets them, and what follows from them alone: closedness,
parts.

Not for: the faces that we measure; those stay polygons (`geometry.polyhedron`).
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
    sizes = np.diff(shape.face_starts)
    firsts = np.repeat(shape.face_starts[:-1], sizes - 2)
    fan_starts = np.cumsum(sizes - 2) - (sizes - 2)
    nth = np.arange(len(firsts)) - np.repeat(fan_starts, sizes - 2)
    corners = np.stack([firsts, firsts + nth + 1, firsts + nth + 2], axis=1)
    faces = np.repeat(np.arange(shape.n_faces), sizes - 2)
    triangles = index.ravel()[shape.face_vertices[corners]]
    return TriangleSoup(vertices, triangles, _turns(shape)[faces])


def _turns(shape: Polyhedron) -> np.ndarray:
    """(f,) how often each face counts."""
    turns = shape.component_closed[shape.face_component].astype(np.int64)
    closing = closing_of(shape)
    return turns if closing is None else turns + closing.turns

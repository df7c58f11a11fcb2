"""The sweep of a body's projection: its covered pixels, and the polygons that matter beyond them.

A face counts 1 where it is seen from the front, -1 from behind; an edge whose faces cancel bounds nothing.
The rest are loops whose winding number is the number of layers over a point, for any soup of faces,
closed or not. A moving region sweeps where it is at first and what its boundary sweeps, so that beyond the
faces at the first instant only edges that may bound something count. Not for: sections.
"""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass
from functools import cached_property

import numpy as np

from clearance.geometry.edges import distinct_vertices, edge_use, rings_of
from clearance.geometry.polyhedron import Polyhedron
from clearance.kernels.profile.swept_cover import Raster, SweptEdges, add_cover
from clearance.kernels.profile.swept_hulls import (
    CORNERS,
    COUNT,
    INTERVAL,
    edge_hulls,
    triangle_hulls,
)
from clearance.profiles.chords import BodyKnots
from clearance.profiles.plane import Plane

CHUNK = 64
"""Instants that are worked on at once: memory does not grow with their number."""

DOUBT = 1e-5
"""[-] Cosine to the direction of view below which a face's side is undecided: slivers' normals are right to
2^-18."""


@dataclass(frozen=True)
class Hulls:
    """Convex polygons in the plane that together with the covered pixels make up what is swept.

    Attributes:
        corners: (m, k, 2) [m], counter-clockwise; only the first `n_corners` of each count.
        n_corners: (m,).
        instant: (m,) in steps: where each begins.
    """

    corners: np.ndarray
    n_corners: np.ndarray
    instant: np.ndarray

    @classmethod
    def of(cls, rows: np.ndarray, instants: np.ndarray) -> Hulls:
        """The polygons that kernels write as rows; an interval counts in `instants`."""
        corners = rows[:, CORNERS:].reshape(len(rows), rows.shape[1] // 2 - 1, 2)
        interval = rows[:, INTERVAL].astype(np.int64)
        return cls(corners, rows[:, COUNT].astype(np.int64), instants[interval])


class PlaneView:
    """One body at its knots, in coordinates along `axes`: the plane's two, and heights if they matter."""

    notes: tuple[str, ...] = ()

    def __init__(
        self, shape: Polyhedron, knots: BodyKnots, origin: np.ndarray, axes: np.ndarray
    ) -> None:
        self.shape, self.knots, self._origin, self._axes = shape, knots, origin, axes

    def box(self) -> np.ndarray:
        """(2, 2) [m] a box in the plane that contains the body at all knots."""
        corners = self.shape.box_corners
        seen = self.placed(self.knots.poses, corners)[:, :, :2].reshape(-1, 2)
        return np.stack([seen.min(axis=0), seen.max(axis=0)])

    def placed(self, poses: np.ndarray, points: np.ndarray) -> np.ndarray:
        """(k, v, axes) [m] the coordinates of points of the body."""
        turn = self._axes @ poses[:, :3, :3]
        shift = (poses[:, :3, 3] - self._origin) @ self._axes.T
        return np.ascontiguousarray(points @ turn.transpose(0, 2, 1) + shift[:, None])

    @property
    def short(self) -> float:
        """[m] how far any point swept in the plane may be from the polygons and the covered pixels."""
        return float(self.knots.chord.max(initial=0.0))

    @property
    def excess(self) -> float:
        """[m] how far any point of them may be from a swept point, besides `slack`."""
        return self.short


class Silhouette(PlaneView):
    """One body seen along a plane's normal, at its knots."""

    def __init__(self, shape: Polyhedron, knots: BodyKnots, plane: Plane) -> None:
        super().__init__(shape, knots, plane.origin, plane.axes)
        self._toward = np.cross(*plane.axes)

    @cached_property
    def _edges(self) -> SweptEdges:
        """Vertices of each edge, and the faces along it."""
        shape = self.shape
        _, kinds = distinct_vertices(shape.vertices)
        ring = rings_of(shape.face_starts)
        corners = kinds[shape.face_vertices]
        use = edge_use(corners, corners[ring.ahead])
        firsts = use.order[use.starts[:-1]]
        ends = np.stack(
            [shape.face_vertices[firsts], shape.face_vertices[ring.ahead[firsts]]], axis=1
        )
        ends = np.where(use.forward[use.starts[:-1], None], ends, ends[:, ::-1])
        ways = np.where(use.forward, 1, -1).astype(np.int64)
        return SweptEdges(np.ascontiguousarray(ends), use.starts, ring.face[use.order], ways)

    def cover(self, raster: Raster) -> None:
        """Marks the pixels that are covered at any knot."""
        for start in range(0, len(self.knots.instant), CHUNK):
            poses = self.knots.poses[start : start + CHUNK]
            signs = np.sign(self._facing(poses)).astype(np.int8)
            add_cover(raster, self.placed(poses, self.shape.vertices), self._edges, signs)

    def hulls(
        self, raster: Raster, sums: np.ndarray, width: float, slack: float
    ) -> Iterator[Hulls]:
        """The polygons that are not covered, a few instants at a time."""
        knots = self.knots
        first = self.placed(knots.poses[:1], self.shape.vertices)[0]
        rows = triangle_hulls(raster, sums, first, self.shape.triangles(), width)
        yield Hulls.of(rows, knots.instant)
        moving = np.flatnonzero(knots.moves)
        for run in np.split(moving, np.flatnonzero(np.diff(moving) != 1) + 1):
            for start in range(0, len(run), CHUNK):
                part = run[start : start + CHUNK]
                yield self._chunk(raster, sums, width, slack, part)

    def _chunk(
        self, raster: Raster, sums: np.ndarray, width: float, slack: float, run: np.ndarray
    ) -> Hulls:
        knots = self.knots
        facing = self._facing(knots.middle[run])
        open_side = np.abs(facing) <= knots.turn[run, None] + DOUBT
        states = np.where(open_side, 0, np.sign(facing)).astype(np.int8)
        points = self.placed(knots.poses[run[0] : run[-1] + 2], self.shape.vertices)
        rows = edge_hulls(raster, sums, points, self._edges, states, width, slack)
        return Hulls.of(rows, knots.instant[run])

    def _facing(self, poses: np.ndarray) -> np.ndarray:
        """(k, f) cosine of each face's normal to the plane's."""
        return (poses[:, :3, :3].transpose(0, 2, 1) @ self._toward) @ self.shape.normals.T

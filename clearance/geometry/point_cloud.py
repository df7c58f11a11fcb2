"""Points of a scan as a body: each stands for a ball of one radius, and nothing is between them.

The search is for the points, and the answer less the radius, so that no ball is faceted
(`kernels.search.balls`). A cloud has no faces and no inside; a solid that has one of its points inside is in
contact. Not for: surfaces made from points, which would have to be guessed.
"""

from __future__ import annotations

from collections.abc import Sequence
from functools import cached_property
from typing import NoReturn

import numpy as np

from clearance.errors import BadDimension, BadShape, EmptyMesh
from clearance.geometry.faces import checked_vertices
from clearance.geometry.planes import Planes
from clearance.geometry.polyhedron import Polyhedron, require_polyhedron
from clearance.geometry.shapes.box import box
from clearance.geometry.topology import Topology
from clearance.kernels.arithmetic.union_find import joined_labels
from clearance.tolerance import LARGEST

MOST_POINTS = 20_000_000
"""Some 500 bytes each while they are measured: 10 GB."""

_CELL = 2.0 / np.sqrt(6.0) * (1.0 - 1e-8)
"""[-] Of the radius: edge of a cell, less what rounding can move a point from one to the next."""

_BITS = 17
_MOST_CELLS = 2.0**_BITS - 2.0
"""Cells along an axis, so that doubles number all of them; where there are more, each point is a group."""

_STEPS = (1 << 2 * _BITS, 1 << _BITS, 1)


_SURFACE = "a body with a surface is needed here"


class PointCloud(Polyhedron):
    """Balls of one radius about points in its own body frame.

    Points that are there several times are there once; they are ordered by their coordinates.

    Args:
        points: (n, 3) [m].
        radius: [m] of the ball about each, above 0.

    Raises:
        EmptyMesh: no points. NotFinite: NaN or infinity. BadShape: not (n, 3), or too many. BadDimension: a radius
            that is not above 0.
    """

    _ball_radius: float

    def __init__(self, points: np.ndarray, radius: float) -> None:
        given = checked_vertices(points)
        if not len(given):
            raise EmptyMesh("the cloud has no points", valid="at least one is needed")
        if len(given) > MOST_POINTS:
            raise BadShape(f"the cloud has {len(given):,} points", valid=f"{MOST_POINTS:,} at most")
        self._fill_points(_distinct(given), radius)

    def _fill_points(self, points: np.ndarray, radius: float) -> None:
        if not (isinstance(radius, int | float) and 0.0 < radius <= LARGEST):
            raise BadDimension(f"radius is {radius!r:.60}", valid="above 0 m")
        self._fill(points, np.arange(len(points) + 1), np.arange(len(points)), 0.0, 0.0)
        object.__setattr__(self, "_ball_radius", float(radius))

    @property
    def ball_radius(self) -> float:
        """[m] of the ball about each point."""
        return self._ball_radius

    @property
    def n_points(self) -> int:
        """Number of different points."""
        return len(self.vertices)

    @cached_property
    def bounds(self) -> np.ndarray:
        """(2, 3) [m] the least and greatest coordinates of the balls in the body frame."""
        low, high = self.vertices.min(axis=0), self.vertices.max(axis=0)
        return np.array([low - self.ball_radius, high + self.ball_radius])

    def box_about(self) -> Polyhedron:
        """A box along the axes of the body frame that contains all balls."""
        middle = np.eye(4)
        middle[:3, 3] = self.bounds.mean(axis=0)
        size = np.ptp(self.bounds, axis=0) + 8.0 * np.spacing(np.abs(self.bounds).max())
        return box(size.tolist()).transformed(middle)

    @property
    def n_triangles(self) -> int:
        """0: nothing is between points."""
        return 0

    def triangles(self) -> NoReturn:
        """None.

        Raises:
            BadShape: always, so that no code mistakes a cloud for a body without a surface.
        """
        raise BadShape("a cloud of points has no faces", valid=_SURFACE)

    @property
    def triangle_faces(self) -> NoReturn:
        """None: as `triangles`."""
        self.triangles()

    @cached_property
    def _planes(self) -> Planes:
        n = self.n_points
        return Planes(np.zeros((n, 3)), self.vertices, np.zeros(n))

    @cached_property
    def _topology(self) -> Topology:
        """Points hang together where their balls surely do; none has an inside."""
        component = components_of(self.vertices, self.ball_radius)
        none = np.zeros(int(component.max()) + 1, dtype=bool)
        return Topology(component, none, none, closed=False, oriented=False, manifold=False)

    @property
    def volume(self) -> None:
        """None: the balls may overlap."""
        return

    @cached_property
    def component_inside_out(self) -> np.ndarray:
        """(k,) False: there is no inside."""
        return np.zeros(len(self.component_closed), dtype=bool)

    def flipped(self) -> Polyhedron:
        """The same: a point has no sides."""
        return self

    def transformed(self, pose: np.ndarray) -> PointCloud:
        """The cloud moved by a (4, 4) rigid motion [m], each coordinate to a few roundings.

        Raises:
            BadPose: not a rigid motion.
        """
        return PointCloud(super().transformed(pose).vertices, self.ball_radius)

    def scaled(self, factor: float | Sequence[float]) -> PointCloud:
        """The cloud with its points' coordinates times one factor, or times three; balls keep their radius.

        Raises:
            BadDimension: as of a surface. NotFinite: a factor that is too large.
        """
        return PointCloud(super().scaled(factor).vertices, self.ball_radius)


def require_surface(given: object, where: str) -> Polyhedron:
    """The argument, if it is a `Polyhedron` with faces.

    Raises:
        BadShape: it is a cloud of points, or no `Polyhedron`.
    """
    solid = require_polyhedron(given, where)
    if isinstance(solid, PointCloud):
        raise BadShape("a cloud of points has no faces", where=where, valid=_SURFACE)
    return solid


def components_of(points: np.ndarray, radius: float) -> np.ndarray:
    """(n,) numbers of groups of points (n, 3) [m] whose balls surely hang together.

    A cell of edge 2 r / sqrt(6) and its neighbour contain no two points more than 2 r apart. What no ball
    touches has the points of a group all inside or all outside.
    """
    span = points - points.min(axis=0)
    cells = np.floor(span / (_CELL * radius))
    if not cells.max() < _MOST_CELLS:
        return np.arange(len(points))
    keys = (cells @ np.array(_STEPS, dtype=np.float64)).astype(np.int64)
    occupied, cell_of_point = np.unique(keys, return_inverse=True)
    pairs = [_neighbouring(occupied, step) for step in _STEPS]
    first, second = (np.concatenate(side) for side in zip(*pairs, strict=True))
    return joined_labels(len(occupied), first, second)[cell_of_point.reshape(-1)]


def _neighbouring(occupied: np.ndarray, step: int) -> tuple[np.ndarray, np.ndarray]:
    """Places, among the ordered keys, of the cells with a neighbour a step on, and of that neighbour."""
    place = np.minimum(np.searchsorted(occupied, occupied + step), len(occupied) - 1)
    has = np.flatnonzero(occupied[place] == occupied + step)
    return has, place[has]


def _distinct(points: np.ndarray) -> np.ndarray:
    """(k, 3) the different points, ordered by their coordinates; -0.0 is 0.0."""
    ordered = points[np.lexsort(points.T[::-1])] + 0.0
    is_new = np.concatenate([[True], (ordered[1:] != ordered[:-1]).any(axis=1)])
    return ordered[is_new]

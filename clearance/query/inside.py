"""Whether one solid may be inside another whose surface is too open to tell: where clearance 0 is not known.

The search takes a body for inside where a winding number proves it (`search.containment`). What it leaves open is
asked here by the same number: is a part known to be outside? The rule depends on how much of a component is open:
`FAULTY`, `OPEN`, or loose faces. Not for: the distance, which none of this changes.
"""

from __future__ import annotations

import itertools
import weakref
from collections.abc import Callable, Iterator
from typing import NamedTuple

import numpy as np

from clearance.geometry.closing import FEW, SOME, closing_of, loose_triangles
from clearance.geometry.point_cloud import PointCloud
from clearance.geometry.polyhedron import Polyhedron
from clearance.geometry.tree import surface_of
from clearance.kernels.mesh.surface import Surface
from clearance.kernels.search.containment import MARGIN
from clearance.kernels.search.doubt import OutsideRule, in_doubt

WOUND = 0.98
"""[turns] Loose faces that go round a point by more may be a solid with cracks, seen under 2 % at most."""

PIECES = 16
"""Components of a body that loose faces may go round one by one; of more, only the body as a whole."""

STRIDE = 1.0 / 16.0
"""[-] Of the diagonal of the bounds of loose faces, how far a part moves in them before it is asked for again."""

FAULTY = OutsideRule(most=MARGIN, by_one=False, near_caps=True, stride=-1.0)
"""Outside of components that close but for a few faults: the search has decided what is far from these."""

OPEN = OutsideRule(most=0.5, by_one=True, near_caps=False, stride=-1.0)
"""Outside of components with holes up to `closing.SOME`: an opening, past which a part is within or reaches in."""


class Holder(NamedTuple):
    """The components of a body that are open alike.

    Attributes:
        surface: with the winding number of these components, but for those of `loose`.
        loose: (k, 3, 3) [m] triangles of components that do not close one by one.
        bounds: (2, 3) [m] of the body.
    """

    surface: Surface
    loose: np.ndarray
    bounds: np.ndarray
    rule: OutsideRule

    @property
    def faces(self) -> tuple[Surface, np.ndarray, np.ndarray]:
        """As the kernel takes them."""
        return self.surface, self.loose, self.bounds


_holders: weakref.WeakKeyDictionary[Polyhedron, tuple[Holder, ...]] = weakref.WeakKeyDictionary()
_parts: weakref.WeakKeyDictionary[Polyhedron, tuple[np.ndarray, ...]] = weakref.WeakKeyDictionary()

_Sides = tuple[tuple[Holder, "np.ndarray | CloudPoints"], ...]
"""What may hold something, and (m, 3) points [m] of what that may be."""


class PossibleContainment:
    """What of one of two bodies may be inside the other; it does not keep the bodies alive."""

    def __init__(self, of_a: _Sides, of_b: _Sides) -> None:
        self._of_a, self._of_b = of_a, of_b

    def at(
        self, worlds_from_a: np.ndarray, worlds_from_b: np.ndarray, along_a_way: bool = False
    ) -> np.ndarray:
        """(n,) True at the poses (n, 4, 4) where it is open whether a body is inside, or where they touch.

        Where these are steps of a motion, loose faces are asked for now and then (`STRIDE`).
        """
        found = np.zeros(len(worlds_from_a), dtype=bool)
        ways = (
            (self._of_a, worlds_from_a, worlds_from_b),
            (self._of_b, worlds_from_b, worlds_from_a),
        )
        for sides, outer, inner in ways:
            for holder, points in sides:
                if isinstance(points, CloudPoints):
                    _search_cloud(holder, points, outer, inner, found)
                    continue
                rule = holder.rule if along_a_way else holder.rule._replace(stride=-1.0)
                in_doubt(*holder.faces, points, rule, outer, inner, found)
        return found


def doubt_of(a: Polyhedron, b: Polyhedron) -> PossibleContainment | None:
    """What can be in doubt of two bodies; None where all components are closed, or too open, or too small."""
    sides = _sides(a, b), _sides(b, a)
    return PossibleContainment(*sides) if any(sides) else None


def _sides(outer: Polyhedron, inner: Polyhedron) -> _Sides:
    holders = () if isinstance(outer, PointCloud) else _cached(_holders, outer, _holders_of)
    if not holders:
        return ()
    if isinstance(inner, PointCloud):
        points = CloudPoints.of(inner)
        return tuple((holder, points) for holder in holders)
    return tuple(
        (holder, points)
        for holder in holders
        for points in _points_asked(holder, inner)
        if not holder.rule.by_one or _may_contain(holder, points)
    )


def _points_asked(holder: Holder, inner: Polyhedron) -> Iterator[np.ndarray]:
    """(m, 3) [m] the corners of each component; where one decides for all, those outermost along the axes."""
    if len(holder.loose) and len(inner.component_closed) > PIECES:
        n_uses = np.bincount(inner.face_vertices, minlength=len(inner.vertices))
        parts = (inner.vertices[n_uses > 0],)
    else:
        parts = _cached(_parts, inner, _parts_of)
    for points in parts:
        ends = np.stack([points.argmin(axis=0), points.argmax(axis=0)], axis=1).reshape(-1)
        yield points[ends] if holder.rule.by_one else points


def _may_contain(holder: Holder, outermost: np.ndarray) -> bool:
    """False if two corners are farther apart than any two points within the holder's bounds."""
    breadth = np.linalg.norm(outermost[::2] - outermost[1::2], axis=1).max()
    return bool(breadth <= np.linalg.norm(holder.bounds[1] - holder.bounds[0]))


def _search_cloud(
    holder: Holder, cloud: CloudPoints, outer: np.ndarray, inner: np.ndarray, found: np.ndarray
) -> None:
    """Sets `found` (n,) where a point of a cloud is in doubt, at poses (n, 4, 4) of the holder and its own."""
    rule, is_loose = holder.rule._replace(by_one=False, stride=-1.0), len(holder.loose) > 0
    for k in np.flatnonzero(~found):
        points = cloud.within(holder.bounds, outer[k], inner[k], one_of_each=is_loose)
        if len(points):
            poses = outer[k : k + 1], inner[k : k + 1]
            in_doubt(*holder.faces, points, rule, *poses, found[k : k + 1])


def _holders_of(shape: Polyhedron) -> tuple[Holder, ...]:
    return tuple(
        Holder(surface, loose, shape.bounds, rule) for surface, loose, rule in _open_surfaces(shape)
    )


def _open_surfaces(shape: Polyhedron) -> Iterator[tuple[Surface, np.ndarray, OutsideRule]]:
    nothing = np.empty((0, 3, 3))
    few, some, loose = closing_of(shape), closing_of(shape, FEW, SOME), loose_triangles(shape)
    if few is not None and len(few.caps):
        yield surface_of(shape), nothing, FAULTY
    if some is not None and len(some.caps):
        yield _with(surface_of(shape), *some), nothing, OPEN
    if len(loose) > 3:
        stride = STRIDE * float(np.linalg.norm(shape.bounds[1] - shape.bounds[0]))
        rule = OutsideRule(most=WOUND, by_one=True, near_caps=False, stride=stride)
        yield _with(surface_of(shape), np.zeros(shape.n_faces), nothing), loose, rule


def _with(surface: Surface, turns: np.ndarray, caps: np.ndarray) -> Surface:
    corners = caps.reshape(-1, 3)
    starts = np.array([0, len(corners)])
    return surface._replace(turns=turns.astype(np.int32), caps=corners, cap_starts=starts)


def _parts_of(shape: Polyhedron) -> tuple[np.ndarray, ...]:
    of_corner = np.repeat(shape.face_component, np.diff(shape.face_starts))
    order = np.argsort(of_corner, kind="stable")
    ends = np.flatnonzero(np.diff(of_corner[order])) + 1
    of_parts = np.split(shape.face_vertices[order], ends)
    return tuple(shape.vertices[np.unique(corners)] for corners in of_parts)


def _cached(
    known: weakref.WeakKeyDictionary[Polyhedron, tuple],
    shape: Polyhedron,
    make: Callable[[Polyhedron], tuple],
) -> tuple:
    if shape not in known:
        known[shape] = make(shape)
    return known[shape]


class CloudPoints(NamedTuple):
    """Points of a cloud, ordered by x.

    Attributes:
        every: (n, 3) [m] all of them. heads: (k, 3) [m] one of each group whose balls hang together.
    """

    every: np.ndarray
    heads: np.ndarray

    @classmethod
    def of(cls, cloud: PointCloud) -> CloudPoints:
        """Those of a cloud."""
        _, firsts = np.unique(cloud.face_component, return_index=True)
        return cls(cloud.vertices, cloud.vertices[np.sort(firsts)])

    def within(
        self,
        bounds: np.ndarray,
        world_from_body: np.ndarray,
        world_from_cloud: np.ndarray,
        one_of_each: bool = False,
    ) -> np.ndarray:
        """(m, 3) [m] the points that may be within the bounds (2, 3) [m] of a body, in the frame of the cloud.

        Args:
            one_of_each: of each group of balls that hang together only one.
        """
        corners = np.array(list(itertools.product(*bounds.T)))
        corners = (
            corners @ world_from_body[:3, :3].T + world_from_body[:3, 3] - world_from_cloud[:3, 3]
        )
        corners = corners @ world_from_cloud[:3, :3]
        slack = _ROUNDING * np.abs(corners).max()
        low, high = corners.min(axis=0) - slack, corners.max(axis=0) + slack
        points = self.heads if one_of_each else self.every
        first, last = (
            np.searchsorted(points[:, 0], low[0]),
            np.searchsorted(points[:, 0], high[0], "right"),
        )
        near = points[first:last]
        return near[((near >= low) & (near <= high)).all(axis=1)]


_ROUNDING = 1e-9
"""[-] Of the coordinates, by which a box is made larger."""

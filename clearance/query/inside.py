"""Whether one solid may be inside another whose surface is too open to tell: where clearance 0 is not known.

The search takes a body for inside where a winding number proves it (`search.containment`). Here it is asked what
that leaves open: parts that reach through a hole of a surface that is closed but for a few faults, or are so near
one that its place decides; parts that larger holes leave wholly within a surface; and parts that loose faces go
round on nearly all sides, as those of a solid with cracks do. Other surfaces with more holes than `closing.SOME`
have no inside. Not for: the distance, which none of this changes.
"""

from __future__ import annotations

import weakref
from typing import NamedTuple

import numpy as np

from clearance.geometry.closing import Closing
from clearance.geometry.open_faces import open_faces_of
from clearance.geometry.point_cloud import PointCloud
from clearance.geometry.polyhedron import Polyhedron
from clearance.geometry.tree import surface_of
from clearance.kernels.mesh.surface import Surface
from clearance.kernels.search.containment import DOUBTFUL
from clearance.kernels.search.doubt import generalized_windings, near_holes, wound_by_loose
from clearance.query.cloud_points import CloudPoints

MOSTLY = 0.5
"""[turns] A part whose outermost corners are all wound round by more, past large holes, may be inside."""

PIECES = 16
"""Components of a body that loose faces may go round one by one; of more, only the body as a whole."""

STRIDE = 1.0 / 16.0
"""[-] Of the diagonal of the bounds of loose faces, how far a part moves in them before it is asked for again."""


class Shell(NamedTuple):
    """The components of a body that would close, and where they do not.

    Attributes:
        surface: with the winding number of these components.
        few: True if they are closed but for a few faults, so that the search decides what it can.
        bounds: (2, 3) [m] of the body.
        holes: (1 + h, 5) centres, radii [m] and areas [m^2] of balls about the caps of all holes, and of each.
    """

    surface: Surface
    few: bool
    bounds: np.ndarray
    holes: np.ndarray


class LooseFaces(NamedTuple):
    """The components of a body that would not close one by one.

    Attributes:
        triangles: (k, 3, 3) [m] turned alike where they hang together.
        bounds: (2, 3) [m] of the body. stride: [m] `STRIDE` of its diagonal.
    """

    triangles: np.ndarray
    bounds: np.ndarray
    stride: float


class Component(NamedTuple):
    """A connected component of a body.

    Attributes:
        points: (n, 3) [m] its corners. outermost: (6, 3) [m] those that reach farthest along the axes.
        low, high: (3,) [m] of its box.
    """

    points: np.ndarray
    outermost: np.ndarray
    low: np.ndarray
    high: np.ndarray


_Holders = tuple[tuple[Shell, ...], tuple[LooseFaces, ...]]

_holders: weakref.WeakKeyDictionary[Polyhedron, _Holders] = weakref.WeakKeyDictionary()
_parts: weakref.WeakKeyDictionary[Polyhedron, tuple[Component, ...]] = weakref.WeakKeyDictionary()
_pieces: weakref.WeakKeyDictionary[Polyhedron, tuple[Component, ...]] = weakref.WeakKeyDictionary()


_Sides = tuple[tuple["Shell | LooseFaces", "Component | CloudPoints"], ...]
"""What may hold something, and what that may be."""


class PossibleContainment:
    """What of one of two bodies may be inside the other; it does not keep the bodies alive."""

    def __init__(self, of_a: _Sides, of_b: _Sides) -> None:
        self._of_a, self._of_b = of_a, of_b

    def at(
        self, worlds_from_a: np.ndarray, worlds_from_b: np.ndarray, along_a_way: bool = False
    ) -> np.ndarray:
        """(n,) True at the poses (n, 4, 4) where it is open whether a body is inside, or where they touch.

        Where these are steps of a motion, loose faces are asked for now and then (`doubt.wound_by_loose`).
        """
        found = np.zeros(len(worlds_from_a), dtype=bool)
        ways = (
            (self._of_a, worlds_from_a, worlds_from_b),
            (self._of_b, worlds_from_b, worlds_from_a),
        )
        for sides, outer, inner in ways:
            for shell, part in sides:
                if isinstance(part, CloudPoints):
                    _look_at_points(shell, part, outer, inner, found)
                elif isinstance(shell, LooseFaces):
                    stride = shell.stride if along_a_way else -1.0
                    wound_by_loose(
                        shell.triangles, shell.bounds, part.outermost, outer, inner, stride, found
                    )
                else:
                    _look(shell, part, outer, inner, found)
        return found


def doubt_of(a: Polyhedron, b: Polyhedron) -> PossibleContainment | None:
    """What can be in doubt of two bodies; None where all components are closed, or too open, or too small."""
    sides = _sides(a, b), _sides(b, a)
    return PossibleContainment(*sides) if any(sides) else None


def _sides(outer: Polyhedron, inner: Polyhedron) -> _Sides:
    if isinstance(outer, PointCloud):
        return ()
    shells, loose = _kept(_holders, outer, _holders_of)
    if isinstance(inner, PointCloud):
        points = CloudPoints.of(inner) if shells or loose else None
        return tuple((shell, points) for shell in (*shells, *loose) if points is not None)
    parts = _kept(_parts, inner, _parts_of) if shells else ()
    pieces = _kept(_pieces, inner, _pieces_of) if loose else ()
    of_shells = (
        (shell, part) for shell in shells for part in parts if shell.few or _may_hold(shell, part)
    )
    return (
        *of_shells,
        *((shell, part) for shell in loose for part in pieces if _may_hold(shell, part)),
    )


def _may_hold(shell: Shell | LooseFaces, part: Component) -> bool:
    """False if two corners of the part are farther apart than any two points within the shell's bounds."""
    breadth = np.linalg.norm(part.outermost[::2] - part.outermost[1::2], axis=1).max()
    return bool(breadth <= np.linalg.norm(shell.bounds[1] - shell.bounds[0]))


def _look(
    shell: Shell, part: Component, outer: np.ndarray, inner: np.ndarray, found: np.ndarray
) -> None:
    """Sets `found` (n,) where the part is in doubt, at poses (n, 4, 4) of the shell's body and of its own."""
    asked = _near_a_hole if shell.few else _within_bounds
    near = asked(shell, part, outer, inner)
    if not near.any():
        return
    rows = np.flatnonzero(near & ~found)
    if not len(rows):
        return
    least, most = np.empty(len(rows)), np.empty(len(rows))
    points = part.points if shell.few else part.outermost
    generalized_windings(shell.surface, points, outer[rows], inner[rows], least, most)
    found[rows] = most > DOUBTFUL if shell.few else least > MOSTLY


def _look_at_points(
    shell: Shell | LooseFaces,
    cloud: CloudPoints,
    outer: np.ndarray,
    inner: np.ndarray,
    found: np.ndarray,
) -> None:
    """Sets `found` (n,) where a point of a cloud is in doubt, at poses (n, 4, 4) of the shell and its own."""
    least, most, any_wound = np.empty(1), np.empty(1), np.zeros(1, dtype=bool)
    for k in np.flatnonzero(~found):
        poses = outer[k : k + 1], inner[k : k + 1]
        if isinstance(shell, LooseFaces):
            for point in cloud.within(shell.bounds, outer[k], inner[k], one_of_each=True):
                one = point[None]
                wound_by_loose(shell.triangles, shell.bounds, one, *poses, -1.0, any_wound)
            found[k], any_wound[0] = any_wound[0], False
            continue
        points = cloud.within(shell.bounds, outer[k], inner[k])
        if len(points):
            generalized_windings(shell.surface, points, *poses, least, most)
            found[k] = most[0] > (DOUBTFUL if shell.few else MOSTLY)


def _near_a_hole(shell: Shell, part: Component, outer: np.ndarray, inner: np.ndarray) -> np.ndarray:
    """(n,) False where the caps are seen under at most `DOUBTFUL` from all of the part: the search has decided."""
    found = np.empty(len(outer), dtype=bool)
    near_holes(shell.holes, shell.bounds, part.low, part.high, outer, inner, found)
    return found


def _within_bounds(
    shell: Shell, part: Component, outer: np.ndarray, inner: np.ndarray
) -> np.ndarray:
    """(n,) True where the outermost corners of the part are within the body's bounds."""
    points = (
        part.outermost @ np.swapaxes(inner[:, :3, :3], 1, 2)
        + (inner[:, :3, 3] - outer[:, :3, 3])[:, None]
    )
    points = points @ outer[:, :3, :3]
    return ((points >= shell.bounds[0]) & (points <= shell.bounds[1])).all(axis=(1, 2))


def _holders_of(shape: Polyhedron) -> _Holders:
    found = open_faces_of(shape)
    shells = tuple(
        _shell(shape, closing, few)
        for few, closing in ((True, found.few), (False, found.some))
        if closing is not None and len(closing.caps)
    )
    stride = STRIDE * float(np.linalg.norm(shape.bounds[1] - shape.bounds[0]))
    loose = (LooseFaces(found.loose, shape.bounds, stride),) if len(found.loose) > 3 else ()
    return shells, loose


def _shell(shape: Polyhedron, closing: Closing, few: bool) -> Shell:
    surface = surface_of(shape)
    if not few:
        corners = closing.caps.reshape(-1, 3)
        surface = surface._replace(
            turns=closing.turns.astype(np.int32),
            caps=corners,
            cap_starts=np.array([0, len(corners)]),
        )
    fans = [
        closing.caps[start:end]
        for start, end in zip(closing.loops, closing.loops[1:], strict=False)
    ]
    return Shell(
        surface, few, shape.bounds, np.array([_ball_of(fan) for fan in (closing.caps, *fans)])
    )


def _ball_of(fan: np.ndarray) -> tuple[float, ...]:
    """(centre, radius [m], area [m^2]) of triangles (n, 3, 3)."""
    centre = fan.mean(axis=(0, 1))
    sides = fan[:, 1:] - fan[:, :1]
    area = 0.5 * np.linalg.norm(np.cross(sides[:, 0], sides[:, 1]), axis=1).sum()
    radius = np.linalg.norm(fan - centre, axis=2).max()
    return (*centre, radius * (1.0 + 1e-12), area * (1.0 + 1e-12))


def _parts_of(shape: Polyhedron) -> tuple[Component, ...]:
    of_corner = np.repeat(shape.face_component, np.diff(shape.face_starts))
    order = np.argsort(of_corner, kind="stable")
    ends = np.flatnonzero(np.diff(of_corner[order])) + 1
    return tuple(
        _part(shape.vertices[np.unique(rows)])
        for rows in np.split(shape.face_vertices[order], ends)
    )


def _pieces_of(shape: Polyhedron) -> tuple[Component, ...]:
    if len(shape.component_closed) <= PIECES:
        return _kept(_parts, shape, _parts_of)
    return (_part(shape.vertices[np.unique(shape.face_vertices)]),)


def _part(points: np.ndarray) -> Component:
    ends = np.stack([points.argmin(axis=0), points.argmax(axis=0)], axis=1).reshape(-1)
    return Component(points, points[ends], points.min(axis=0), points.max(axis=0))


def _kept(known: weakref.WeakKeyDictionary, shape: Polyhedron, make) -> tuple:
    if shape not in known:
        known[shape] = make(shape)
    return known[shape]

"""The common region of convex polytopes, with its volume and where each of its faces comes from.

Two methods: cutting the smallest body by the faces of the others ("cut", two threads take the halves on either
side of a plane), and the paper's duals about the common point with one hull over all half-spaces by Qhull
("dual"). Cutting is the faster at every size measured (`POLYTOPES.md`); the dual method remains where
rounding breaks it. Not for: concave bodies.
"""

from __future__ import annotations

from collections.abc import Sequence
from concurrent.futures import Future
from dataclasses import dataclass
from functools import cached_property
from threading import Thread

import numpy as np

from clearance.errors import BadDimension
from clearance.geometry.polytope import Polytope
from clearance.geometry.polytope_hull import NotSolid
from clearance.query.common_point import ROUNDING, CommonPoint, checked_bodies, common_point
from clearance.query.cutting import BrokenRim, Cutting, CuttingTask, cut_down, cut_whole
from clearance.query.region import Region
from clearance.query.thin import is_thin, refined

HALVED_FROM = 20000
"""Faces of all bodies together from which on the region is cut in two halves, which two threads can share."""


@dataclass(frozen=True, eq=False)
class Intersection:
    """The common region of bodies.

    Args:
        relation: "overlap", "touch" or "apart".
        volume: [m^3], exactly 0 unless "overlap".
        centroid: (3,) [m], of the region, polygon, segment or point; None when separate.
        common: the common point, or the certificate that there is no inner one.
        method: "cut", "dual", or "none" where nothing solid is shared.
    """

    relation: str
    volume: float
    centroid: np.ndarray | None
    common: CommonPoint
    method: str
    _cuttings: list[Cutting] | Region | None = None
    _touching: np.ndarray | None = None

    @property
    def empty(self) -> bool:
        """True if not even a point is shared."""
        return self.relation == "apart"

    @property
    def dimension(self) -> int:
        """3 for a solid region, 2, 1, 0 for a polygon, a segment, a point, -1 for nothing."""
        if self.relation == "overlap":
            return 3
        return -1 if self._touching is None else min(len(self._touching) - 1, 2)

    @property
    def vertices(self) -> np.ndarray:
        """(n, 3) [m] the corners: of the region, or of the polygon, segment or point in order."""
        if self._cuttings is not None:
            return self._surface[0]
        return np.zeros((0, 3)) if self._touching is None else self._touching

    @property
    def faces(self) -> list[np.ndarray]:
        """The corners of each face of the region as indices, counter-clockwise from outside."""
        return self._surface[1] if self._cuttings is not None else []

    @property
    def provenance(self) -> np.ndarray:
        """(f, 2) of each face: which body it comes from, and which face of that body."""
        return self._surface[2] if self._cuttings is not None else np.zeros((0, 2), dtype=np.int64)

    def polytope(self) -> Polytope:
        """The region as a body of its own.

        Raises:
            NotSolid: nothing solid is shared.
        """
        if self._cuttings is None:
            raise NotSolid(f"the bodies are {self.relation}", valid="bodies that overlap")
        return Polytope(self.vertices)

    @cached_property
    def _surface(self) -> tuple[np.ndarray, list[np.ndarray], np.ndarray]:
        assert self._cuttings is not None, "asked only where a solid region is shared"
        if isinstance(self._cuttings, Region):
            return self._cuttings.surface()
        if len(self._cuttings) == 2:
            corners, rings, provenance = Region.sewn(self._cuttings).surface()
            if 2 * (len(corners) + len(rings) - 2) == sum(map(len, rings)):
                return corners, rings, provenance
            return Region.of(cut_whole(self._cuttings[0].task)).surface()
        return Region.of(self._cuttings[0]).surface()


def intersect(
    polytopes: Sequence[Polytope], method: str = "auto", threads: int = 1
) -> Intersection:
    """The region that all `polytopes` share.

    Args:
        method: "cut", "dual" or "auto". threads: 2 or more cut the two halves of the bodies at once.

    Raises:
        EmptyMesh: no bodies. BadShape: not polytopes. BadDimension: another method, no threads.

    Exactness: corners to a few roundings of the smallest body's size; bodies that reach into each other
        by less than rounding touch, and then the volume is exactly 0.
    Source: Tereshchenko (2013), sections 2.1-2.3 (dual), 3 (halves in parallel).
    """
    if method not in ("auto", "cut", "dual"):
        raise BadDimension(f"method is {method!r}", valid="auto, cut or dual")
    if not isinstance(threads, int) or threads < 1:
        raise BadDimension(f"threads is {threads!r}", valid="1 or more")
    bodies = checked_bodies(polytopes)
    met = common_point(bodies)
    if met.point is None:  # separate
        return Intersection("apart", 0.0, None, met, "none")
    if met.relation == "overlap":
        region, moments, used = _region(CuttingTask.about(bodies, met.point), method, threads)
        if moments[0] > 0.0:
            centroid = met.point + moments[1:] / moments[0]
            return Intersection("overlap", float(moments[0]), centroid, met, used, region)
        return Intersection("touch", 0.0, met.point, met, "none", None, met.point[None, :])
    touching = touching_set(bodies, met)
    return Intersection("touch", 0.0, touching.mean(axis=0), met, "none", None, touching)


def _region(
    task: CuttingTask, method: str, threads: int
) -> tuple[list[Cutting] | Region | None, np.ndarray, str]:
    """(the region, its moments, the method)."""
    if method != "dual":
        try:
            found = _cut(task, threads)
            if any(half is None for half in found):
                return None, np.zeros(4), "cut"
            halves, moments = zip(*found, strict=True)
            total = sum(moments)
            if is_thin(task, total[0], max(half[4] for half in moments)):
                again = refined(task, np.concatenate([half.places() for half in halves]))
                if again is not None:
                    return *again, "cut"
            return list(halves), total[:4], "cut"
        except BrokenRim:
            if method == "cut":
                raise AssertionError("the cut has broken the surface") from None
    region = dual_region(task)
    return region, region.moments(), "dual"


def _cut(task: CuttingTask, threads: int) -> list[tuple[Cutting, np.ndarray] | None]:
    """The region whole, or where there is much to do in two halves, whatever the number of threads."""
    if task.seam < HALVED_FROM or len(task.bodies) < 3:
        return [_part(task)]
    if threads == 1:
        return [_part(task, side) for side in (1.0, -1.0)]
    for body in task.bodies:
        body.prepared()
    _ = task.order  # once, ahead of both
    other: Future = Future()
    worker = Thread(target=_answer, args=(other, task))  # a pool needs 50 us longer to start
    worker.start()
    try:
        return [_part(task, 1.0), other.result()]
    finally:
        worker.join()


def _answer(other: Future, task: CuttingTask) -> None:
    """The half on the far side, or why there is none."""
    try:
        other.set_result(_part(task, -1.0))
    except BaseException as error:  # it is raised where the result is read
        other.set_exception(error)


def _part(task: CuttingTask, side: float = 0.0) -> tuple[Cutting, np.ndarray] | None:
    """The part on one side, and its moments."""
    made = cut_down(task, side)
    return None if made is None else (made, made.moments())


def dual_region(task: CuttingTask) -> Region:
    """The region by one hull over all planes' dual points about the common point, by Qhull.

    Source: Tereshchenko (2013), section 2.3.
    """
    from scipy.spatial import ConvexHull

    normals = np.concatenate([body.normals for body in task.bodies])
    offsets = np.concatenate([body.offsets_about(task.origin) for body in task.bodies])
    points = normals / offsets[:, None]
    hull = ConvexHull(points)
    places = hull.equations[:, :3] / -hull.equations[:, 3:]
    corner = points[hull.simplices]
    turned = np.einsum("ij,ij->i", np.cross(corner[:, 0], corner[:, 1]), corner[:, 2])
    planes = np.where(turned[:, None] < 0.0, hull.simplices[:, ::-1], hull.simplices)
    return _rings_of_dual(task, places, planes)


def _rings_of_dual(task: CuttingTask, places: np.ndarray, planes: np.ndarray) -> Region:
    """Around each plane its dual triangles follow each other: (plane, b, c) after (plane, a, b)."""
    after = {
        (t[k], t[(k + 1) % 3]): (t[(k + 2) % 3], i)
        for i, t in enumerate(planes.tolist())
        for k in range(3)
    }
    begin = {name: second for name, second in after}
    names, starts, corners = [], [0], []
    for name in sorted(begin):
        second = first = begin[name]
        while True:
            second, i = after[(name, second)]
            corners.append(i)
            if second == first:
                break
        names.append(name)
        starts.append(len(corners))
    return Region(task, places, np.array(names), np.array(starts), np.array(corners))


def touching_set(bodies: list[Polytope], met: CommonPoint) -> np.ndarray:
    """(k, 3) [m] corners in order: three or more of a polygon, two of a segment, one point."""
    proof, point = met.certificate, met.point
    assert proof is not None and point is not None, "bodies that touch have both"
    heaviest = int(proof.weights.argmax())
    normal = bodies[proof.parts[heaviest]].normals[proof.faces[heaviest]]
    aside = np.cross(normal, np.eye(3)[np.abs(normal).argmin()])
    aside /= np.linalg.norm(aside)
    axes = np.stack([aside, np.cross(normal, aside)])
    size = min(body.size for body in bodies)
    slack = ROUNDING * max(body.size for body in bodies)
    ring = 2.0 * size * np.array([[-1.0, -1.0], [1.0, -1.0], [1.0, 1.0], [-1.0, 1.0]])
    for body in bodies:
        flat, offsets = body.normals @ axes.T, body.offsets_about(point)
        for i in np.flatnonzero(np.abs(flat).sum(axis=1) * 3.0 * size > offsets - slack):
            ring = _clipped(ring, flat[i], offsets[i], slack)
    ring = _distinct(ring, 8.0 * slack)
    return point + ring @ axes if len(ring) else point[None, :]


def _clipped(ring: np.ndarray, normal: np.ndarray, offset: float, slack: float) -> np.ndarray:
    """The corners of the ring on or below the line, with those where it crosses."""
    heights = ring @ normal - offset
    if not len(ring) or heights.max() <= slack:
        return ring
    inside = []
    for i, high in enumerate(heights):
        j = (i + 1) % len(ring)
        if high <= slack:
            inside.append(ring[i])
        if (high < -slack and heights[j] > slack) or (high > slack and heights[j] < -slack):
            inside.append(ring[i] + (ring[j] - ring[i]) * (high / (high - heights[j])))
    return np.array(inside).reshape(-1, 2)


def _distinct(ring: np.ndarray, slack: float) -> np.ndarray:
    """The corners without repeats; the two ends where they lie on a line; one where all agree."""
    if not len(ring):
        return ring
    corners = [ring[0]]
    for corner in ring[1:]:
        if min(np.linalg.norm(corner - other) for other in corners) > slack:
            corners.append(corner)
    inside = np.array(corners)
    if len(inside) < 2:
        return inside
    far = inside[np.linalg.norm(inside - inside[0], axis=1).argmax()]
    end = inside[np.linalg.norm(inside - far, axis=1).argmax()]
    along = (far - end) / np.linalg.norm(far - end)
    off = (inside - end) @ np.array([-along[1], along[0]])
    return inside if np.abs(off).max() > slack else np.stack([end, far])

"""The region that convex polytopes share, with its volume and where each of its faces comes from.

Two ways: cutting the smallest body by the faces of the others ("cut", several threads work on halves of the
bodies), and the paper's duals about the common point with one hull over all half-spaces by Qhull ("dual").
Cutting is the faster at every size measured (`POLYTOPES.md`); the dual way is what is left where rounding
breaks it. Not for: concave bodies.
"""

from __future__ import annotations

from collections.abc import Sequence
from concurrent.futures import ThreadPoolExecutor
from dataclasses import dataclass
from functools import cached_property

import numpy as np

from clearance.errors import BadDimension
from clearance.geometry.polytope import Polytope
from clearance.geometry.polytope_hull import NotSolid
from clearance.kernels.polytope_clip import ring_moments
from clearance.query.common_point import CommonPoint, checked_bodies, common_point
from clearance.query.cutting import Broken, Cutting, Task, cut_down, joined
from clearance.query.touching import touching_set


@dataclass(frozen=True, eq=False)
class Intersection:
    """What bodies share.

    Args:
        relation: "overlap", "touch" or "apart".
        volume: [m^3], exactly 0 unless "overlap".
        centroid: (3,) [m], of the region, polygon, segment or point; None when apart.
        common: the common point, or the certificate that there is no inner one.
        method: "cut", "dual", or "none" where nothing solid is shared.
    """

    relation: str
    volume: float
    centroid: np.ndarray | None
    common: CommonPoint
    method: str
    _region: _Region | None = None
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
        if self._region is not None:
            return self._surface[0]
        return np.zeros((0, 3)) if self._touching is None else self._touching

    @property
    def faces(self) -> list[np.ndarray]:
        """The corners of each face of the region as indices, counter-clockwise from outside."""
        return self._surface[1] if self._region is not None else []

    @property
    def provenance(self) -> np.ndarray:
        """(f, 2) of each face: which body it comes from, and which face of that body."""
        return self._surface[2] if self._region is not None else np.zeros((0, 2), dtype=np.int64)

    def polytope(self) -> Polytope:
        """The region as a body of its own.

        Raises:
            NotSolid: nothing solid is shared.
        """
        if self._region is None:
            raise NotSolid(f"the bodies are {self.relation}", valid="bodies that overlap")
        return Polytope(self.vertices)

    @cached_property
    def _surface(self) -> tuple[np.ndarray, list[np.ndarray], np.ndarray]:
        return self._region.surface()


@dataclass(frozen=True, eq=False)
class _Region:
    task: Task
    places: np.ndarray
    planes: np.ndarray
    starts: np.ndarray
    corners: np.ndarray

    @classmethod
    def of(cls, cutting: Cutting) -> _Region:
        return cls(cutting.task, cutting.places, *cutting.rings())

    def moments(self) -> np.ndarray:
        return ring_moments(self.places, self.starts, self.corners, np.zeros(3))

    def surface(self) -> tuple[np.ndarray, list[np.ndarray], np.ndarray]:
        """Corners no farther apart than rounding become one; faces left with fewer than three go."""
        from scipy.spatial import cKDTree

        rows, index = np.unique(self.corners, return_inverse=True)
        places = self.places[rows]
        near = 8.0 * self.task.tolerance
        pairs = cKDTree(places).query_pairs(near, output_type="ndarray")
        merged = _least_of_each_cluster(len(rows), pairs)
        kept, number = np.unique(merged, return_inverse=True)
        rings, names = [], []
        for name, ring in zip(self.planes, np.split(number[index], self.starts[1:-1]), strict=True):
            ring = ring[ring != np.roll(ring, 1)]
            if len(np.unique(ring)) > 2:
                rings.append(ring)
                names.append(name)
        names = np.array(names, dtype=np.int64)
        owners = np.searchsorted(self.task.bases, names, side="right") - 1
        provenance = np.column_stack([owners, names - self.task.bases[owners]])
        return places[kept] + self.task.origin, rings, provenance


def _least_of_each_cluster(n: int, pairs: np.ndarray) -> np.ndarray:
    from scipy.sparse import coo_array
    from scipy.sparse.csgraph import connected_components

    graph = coo_array((np.ones(len(pairs)), (pairs[:, 0], pairs[:, 1])), shape=(n, n))
    labels = connected_components(graph, directed=False)[1]
    least = np.full(n, n)
    np.minimum.at(least, labels, np.arange(n))
    return least[labels]


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
    if met.relation == "apart":
        return Intersection("apart", 0.0, None, met, "none")
    if met.relation == "overlap":
        region, used = _region(Task.about(bodies, met.point), method, threads)
        if region is not None:
            moments = region.moments()
            if moments[0] > 0.0:
                centroid = met.point + moments[1:] / moments[0]
                return Intersection("overlap", float(moments[0]), centroid, met, used, region)
        return Intersection("touch", 0.0, met.point, met, "none", None, met.point[None, :])
    touching = touching_set(bodies, met)
    return Intersection("touch", 0.0, touching.mean(axis=0), met, "none", None, touching)


def _region(task: Task, method: str, threads: int) -> tuple[_Region | None, str]:
    if method != "dual":
        try:
            cutting = _cut(task, threads)
            return (None if cutting is None else _Region.of(cutting)), "cut"
        except Broken:
            if method == "cut":
                raise AssertionError("the cut has broken the surface") from None
    return _dual(task), "dual"


def _cut(task: Task, threads: int) -> Cutting | None:
    members = range(len(task.bodies))
    if threads == 1 or len(task.bodies) < 4:
        return cut_down(task, members)
    for body in task.bodies:
        body.prepared()
    with ThreadPoolExecutor(2) as pool:
        a, b = pool.map(lambda half: cut_down(task, half), (members[::2], members[1::2]))
    return None if a is None or b is None else joined(a, b)


def _dual(task: Task) -> _Region:
    """The paper's way: the hull of all planes' dual points about the common point, and back."""
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


def _rings_of_dual(task: Task, places: np.ndarray, planes: np.ndarray) -> _Region:
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
    return _Region(task, places, np.array(names), np.array(starts), np.array(corners))

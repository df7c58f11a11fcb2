"""The surface of a common region: its moments at once, its corners, faces and their origin on demand.

A region cut in two halves is sewn together here. Not for: finding the region (`cutting`, `intersection`).
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from clearance.geometry.edges import rings_of
from clearance.kernels.arithmetic.union_find import joined_labels
from clearance.kernels.polytope.faces import ring_moments
from clearance.query.cutting import Cutting, CuttingTask, cut_whole


@dataclass(frozen=True, eq=False)
class Region:
    """Faces about the task's origin: places (c, 3), the plane of each face, face starts, corners as places."""

    task: CuttingTask
    places: np.ndarray
    planes: np.ndarray
    starts: np.ndarray
    corners: np.ndarray

    @classmethod
    def of(cls, cutting: Cutting) -> Region:
        """The remaining part of one polytope."""
        return cls(cutting.task, cutting.spots[:, :3], *cutting.rings())

    @classmethod
    def sewn(cls, halves: list[Cutting]) -> Region:
        """The remaining part of two halves. If rounding has made their seams differ, all is cut again as one."""
        one, other = (cls.of(half) for half in halves)
        rings, others = one._rings(), other._rings()
        seam = one.task.seam
        on_seam, on_other = set(rings.pop(seam, ())), set(others.pop(seam, ()))
        shift = len(one.places)
        for name, ring in others.items():
            here, there = _opened(rings.get(name, []), on_seam), _opened(ring, on_other)
            if here is None or there is None or (here == []) != (len(there) == len(ring)):
                return cls.of(cut_whole(one.task))
            rings[name] = here + [i + shift for i in there]
        if any(on_seam & set(ring) for ring in rings.values()):
            return cls.of(cut_whole(one.task))
        places = np.concatenate([one.places, other.places])
        starts = np.concatenate([[0], np.cumsum([len(ring) for ring in rings.values()])])
        return cls(
            one.task, places, np.array(list(rings)), starts, np.concatenate(list(rings.values()))
        )

    def _rings(self) -> dict[int, list[int]]:
        parts = np.split(self.corners, self.starts[1:-1])
        return {int(name): part.tolist() for name, part in zip(self.planes, parts, strict=True)}

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
        merged = _least_of_each_cluster(len(rows), ends[lengths <= 8.0 * self.task.tolerance])
        corners, number = np.unique(merged, return_inverse=True)
        rings, planes = [], []
        for name, ring in zip(self.planes, np.split(number[index], self.starts[1:-1]), strict=True):
            ring = ring[ring != np.roll(ring, 1)]
            if len(np.unique(ring)) > 2:
                rings.append(ring)
                planes.append(name)
        names = np.array(planes, dtype=np.int64)
        owners = np.searchsorted(self.task.bases, names, side="right") - 1
        provenance = np.column_stack([owners, names - self.task.bases[owners]])
        return places[corners] + self.task.origin, rings, provenance


def _opened(ring: list[int], on_seam: set[int]) -> list[int] | None:
    """The corners off the seam, from its one edge there onwards; None unless they are one such chain."""
    if not ring:
        return []
    flags = [i in on_seam for i in ring]
    ends = [i for i, flag in enumerate(flags) if flag and not flags[(i + 1) % len(ring)]]
    if not any(flags):
        return ring
    if sum(flags) != 2 or len(ends) != 1:
        return None
    return (ring[ends[0] + 1 :] + ring[: ends[0] + 1])[:-2]


def _least_of_each_cluster(n: int, pairs: np.ndarray) -> np.ndarray:
    labels = joined_labels(n, *np.ascontiguousarray(pairs.T))
    return np.unique(labels, return_index=True)[1][labels]

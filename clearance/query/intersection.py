"""The common region of convex polytopes, with its volume and where each of its faces comes from.

Not for: concave bodies.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from functools import cached_property

import numpy as np

from clearance.geometry.polytope import Polytope
from clearance.geometry.polytope_hull import NotSolid
from clearance.query.common_point import CommonPoint, checked_bodies, common_point
from clearance.query.region import Region, SharedPlanes
from clearance.query.thin import is_thin, refined
from clearance.query.touching import touching_set


@dataclass(frozen=True, eq=False)
class Intersection:
    """The common region of bodies.

    Args:
        relation: "overlap", "touch" or "apart".
        volume: [m^3], exactly 0 unless "overlap".
        centroid: (3,) [m], of the region, polygon, segment or point; None when separate.
        common: the common point, or the certificate that there is no inner one.
    """

    relation: str
    volume: float
    centroid: np.ndarray | None
    common: CommonPoint
    _region: Region | None = None
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
        assert self._region is not None, "asked only where a solid region is shared"
        return self._region.surface()


def intersect(polytopes: Sequence[Polytope]) -> Intersection:
    """The region that all `polytopes` share.

    Raises:
        EmptyMesh: no bodies. BadShape: not polytopes.

    Exactness: corners to a few roundings of the smallest body's size; bodies that reach into each other
        by less than rounding touch, and then the volume is exactly 0.
    Source: Tereshchenko (2013), sections 2.1-2.3.
    """
    bodies = checked_bodies(polytopes)
    met = common_point(bodies)
    if met.point is None:  # separate
        return Intersection("apart", 0.0, None, met)
    if met.relation != "overlap":
        touching = touching_set(bodies, met)
        return Intersection("touch", 0.0, touching.mean(axis=0), met, None, touching)
    found = _region(SharedPlanes.about(bodies, met.point))
    if found is None:
        return Intersection("touch", 0.0, met.point, met, None, met.point[None, :])
    region, moments = found
    centroid = met.point + moments[1:] / moments[0]
    return Intersection("overlap", float(moments[0]), centroid, met, region)


def _region(shared: SharedPlanes) -> tuple[Region, np.ndarray] | None:
    """The region and its moments; None where rounding leaves nothing of it."""
    region = Region.of(shared)
    if region is None:
        return None
    moments = region.moments()
    found = refined(region) if is_thin(region, moments[0]) else None
    region, moments = found or (region, moments)
    return (region, moments) if moments[0] > 0.0 else None

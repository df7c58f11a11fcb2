"""How deep two bodies of a run are in each other, and the way out; of balls of a cloud too. Not for: volumes
(`query.contact`)."""

from __future__ import annotations

from functools import cached_property
from typing import NamedTuple

import numpy as np

from clearance.geometry.point_cloud import PointCloud
from clearance.geometry.polyhedron import Polyhedron
from clearance.query.pair_query import Query

THIN = 1e-7
"""[m] Radius of the balls that stand for the points themselves."""


class BodyOverlap(NamedTuple):
    """How two bodies that touch are parted.

    Attributes:
        depth: [m] of the way out that was found. at_least: [m] no shorter way parts them.
        direction: (3,) unit vector, world: that in which b leaves a. point: (3,) [m] in both, world.
    """

    depth: float
    at_least: float
    direction: np.ndarray
    point: np.ndarray


class Overlaps:
    """The overlaps of two bodies in any pose.

    Args:
        bounded: False leaves `at_least` at 0 where it is not known anyway.
    """

    def __init__(self, a: Polyhedron, b: Polyhedron, *, bounded: bool = True) -> None:
        self.shapes, self.bounded = (a, b), bounded

    def at(self, pose_a: np.ndarray, pose_b: np.ndarray) -> BodyOverlap | None:
        """That at two poses (4, 4) [m]; None where they are apart, or no way out is known: the middle of a ball
        is inside a solid."""
        if any(isinstance(shape, PointCloud) for shape in self.shapes):
            return self._of_balls(pose_a, pose_b)
        from clearance.query.contact import contact

        found = contact(
            *self.shapes, pose_a=pose_a, pose_b=pose_b, rough=True, bounded=self.bounded
        )
        if found is None:
            return None
        return BodyOverlap(
            found.penetration, found.penetration_at_least, -found.direction, found.centroid
        )

    def _of_balls(self, pose_a: np.ndarray, pose_b: np.ndarray) -> BodyOverlap | None:
        """A ball that reaches depth past a point of the other body holds it until one is moved so far."""
        found = self._thin.distances(pose_a[None], pose_b[None])
        distance, (on_a, on_b) = float(found.distances[0]), found.points[0]
        depth = self._beyond - distance
        length = float(np.linalg.norm(on_b - on_a))
        if depth < 0.0 or distance <= THIN or length <= THIN:
            return None
        return BodyOverlap(depth, depth, (on_b - on_a) / length, (on_a + on_b) / 2.0)

    @cached_property
    def _thin(self) -> Query:
        return Query(*(_thinned(shape) for shape in self.shapes))

    @property
    def _beyond(self) -> float:
        """[m] What the balls are greater by than those that stand for their points."""
        clouds = (one for one in self.shapes if isinstance(one, PointCloud))
        return sum(max(one.ball_radius - THIN, 0.0) for one in clouds)


def _thinned(shape: Polyhedron) -> Polyhedron:
    if not isinstance(shape, PointCloud):
        return shape
    return PointCloud(shape.vertices, min(THIN, shape.ball_radius))

"""Where pairs come near: their nearest points at those steps, and the direction in which they part.

What a clearance changes by follows from it: where the points of bodies a and b move by v_a and v_b, it grows by
direction . (v_b - v_a) in first order. Not for: what moves (`point_motion`).
"""

from __future__ import annotations

from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass, replace
from functools import cached_property
from typing import NamedTuple

import numpy as np

from clearance.geometry.point_cloud import PointCloud
from clearance.geometry.polyhedron import Polyhedron
from clearance.query.pair_query import Query
from clearance.simulate.answers.point_motion import motion_of_frame
from clearance.simulate.answers.rule_pairs import MeasuredRule
from clearance.simulate.measure.sections import Section
from clearance.world.case import Case
from clearance.world.forest import link_poses_at
from clearance.world.pairs import Pair

MOST_DEPTHS = 12
"""Steps in contact of one pair whose depth is worked out, evenly spread; one takes 2 to 20 ms."""

NO_DIRECTION = 1e-9
"""[m] Nearest points that are nearer have no direction of their own."""


@dataclass(frozen=True, eq=False)
class Approach:
    """A pair at the steps at which it is near.

    Attributes:
        rule: the answer of what judges it. section: its part of the run.
        steps: (k,) of the run. poses: (k, links, 4, 4) `world_from_link` [m] there.
        clearances: (k,) [m] less padding; where the bodies overlap less their depth as well.
        points: (k, 2, 3) nearest points on a and b [m], world; of an overlap one in both.
        directions: (k, 3) unit vectors from a to b.
        depths_at_least: (k,) [m] no shorter way parts the bodies where they overlap; 0 where they are separate, or
            where that was not asked for.
    """

    rule: MeasuredRule
    section: Section
    pair: Pair
    steps: np.ndarray
    poses: np.ndarray
    clearances: np.ndarray
    points: np.ndarray
    directions: np.ndarray
    depths_at_least: np.ndarray

    @property
    def case(self) -> Case:
        """The plain case of its part of the run."""
        return self.section.phase.case

    @property
    def times(self) -> np.ndarray:
        """(k,) [s of the run] of the steps."""
        phase = self.section.phase
        return np.asarray(phase.times[self.steps - phase.first])

    def of_bodies(self, moved_a: np.ndarray, moved_b: np.ndarray) -> np.ndarray:
        """(k, ...) what the clearance grows by where the points move by these (k, ..., 3) [m]."""
        return np.einsum("k...i,ki->k...", moved_b - moved_a, self.directions)

    def by_columns(self) -> np.ndarray:
        """(k, columns) what it grows by for each rad or m of the columns of the forest."""
        moved = [
            motion_of_frame(self.case, self.poses, body.frame_in(self.case), self.points[:, side])
            for side, body in enumerate(self.pair)
        ]
        return self.of_bodies(*moved)


OfPair = Callable[[Case, Pair], bool]
"""Whether a pair of the plain case of a part of the run is asked about."""


def approaches(
    rules: Sequence[MeasuredRule],
    beyond: float,
    chosen: OfPair | None = None,
    *,
    bounded: bool = True,
) -> Iterator[Approach]:
    """All pairs that are less than `beyond` [m] above the fail limit of what judges them, with the steps.

    Args:
        chosen: which pairs; None for all. bounded: whether depths are bounded from below as well.
    """
    for rule in rules:
        if rule.pairs is None:
            continue
        for section, near in rule.pairs.near_by_section(rule.limits.fail + beyond):
            for place in np.unique(near.pairs).tolist():
                rows = near.pairs == place
                pair = section.pairs[int(np.flatnonzero(section.places == place)[0])]
                if chosen is not None and not chosen(section.phase.case, pair):
                    continue
                yield from _approach(rule, section, pair, near.steps[rows], bounded=bounded)


def _approach(
    rule: MeasuredRule, section: Section, pair: Pair, steps: np.ndarray, *, bounded: bool = True
) -> Iterator[Approach]:
    phase = section.phase
    case, own = phase.case, steps - phase.first
    poses = link_poses_at(case, phase.motions, own)
    a, b = (body.poses_in(case, poses) for body in pair)
    found = Query(*(body.shape_in(case) for body in pair)).distances(a, b)
    is_separate = found.distances > NO_DIRECTION
    gaps = found.points[:, 1] - found.points[:, 0]
    lengths = np.linalg.norm(gaps, axis=1)
    directions = np.divide(
        gaps, lengths[:, None], out=np.zeros_like(gaps), where=is_separate[:, None]
    )
    approach = Approach(
        rule, section, pair, steps, poses, found.distances - section.padding, found.points,
        directions, np.zeros(len(steps)),
    )  # fmt: skip
    touching = np.flatnonzero(~is_separate)
    if len(touching):
        approach = _with_depths(approach, touching, bounded=bounded)
    yield approach


def _with_depths(approach: Approach, touching: np.ndarray, *, bounded: bool) -> Approach:
    """The approach with depth and separation vector at some of the steps in contact; the others are dropped."""
    chosen = touching[np.unique(np.linspace(0, len(touching) - 1, MOST_DEPTHS).astype(int))]
    case, pair = approach.case, approach.pair
    overlaps = Overlaps(*(body.shape_in(case) for body in pair), bounded=bounded)
    selected = set(np.flatnonzero(approach.directions.any(axis=1)).tolist())
    columns = [approach.clearances.copy(), approach.points.copy(), approach.directions.copy()]
    columns.append(approach.depths_at_least.copy())
    for row in chosen.tolist():
        poses = [body.poses_in(case, approach.poses[row : row + 1])[0] for body in pair]
        found = overlaps.at(*poses)
        if found is None:
            continue
        selected.add(row)
        columns[0][row] -= found.depth
        columns[1][row] = found.point
        columns[2][row] = found.direction
        columns[3][row] = found.at_least
    rows = np.array(sorted(selected), dtype=np.int64)
    clearances, points, directions, depths = (column[rows] for column in columns)
    return replace(
        approach, steps=approach.steps[rows], poses=approach.poses[rows], clearances=clearances,
        points=points, directions=directions, depths_at_least=depths,
    )  # fmt: skip


POINT_RADIUS = 1e-7
"""[m] Radius of the balls that stand for the points themselves."""


class BodyOverlap(NamedTuple):
    """How two bodies that touch are parted.

    Attributes:
        depth: [m] of the separation vector that was found. at_least: [m] no shorter way parts them.
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
        """That at two poses (4, 4) [m]; None where they are separate, or no separation vector is known: the middle
        of a ball is inside a solid."""
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
        """A ball that reaches depth past a point of the other body overlaps it until one is moved so far."""
        found = self._point_query.distances(pose_a[None], pose_b[None])
        distance, (on_a, on_b) = float(found.distances[0]), found.points[0]
        depth = self._beyond - distance
        length = float(np.linalg.norm(on_b - on_a))
        if depth < 0.0 or distance <= POINT_RADIUS or length <= POINT_RADIUS:
            return None
        return BodyOverlap(depth, depth, (on_b - on_a) / length, (on_a + on_b) / 2.0)

    @cached_property
    def _point_query(self) -> Query:
        return Query(*(_with_point_radius(shape) for shape in self.shapes))

    @property
    def _beyond(self) -> float:
        """[m] What the balls are greater by than those that stand for their points."""
        clouds = (one for one in self.shapes if isinstance(one, PointCloud))
        return sum(max(one.ball_radius - POINT_RADIUS, 0.0) for one in clouds)


def _with_point_radius(shape: Polyhedron) -> Polyhedron:
    if not isinstance(shape, PointCloud):
        return shape
    return PointCloud(shape.vertices, min(POINT_RADIUS, shape.ball_radius))

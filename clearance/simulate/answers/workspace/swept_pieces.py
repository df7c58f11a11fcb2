"""What a robot's links and what they carry pass through, as convex pieces that contain all of it.

A piece is the hull of one convex part of a body at moments of a stretch of a run, made wider by what a point can
leave its chord between two of them. The moments are the samples, and more where the samples are too far apart. Not
for: distance between the samples (`certify`), which is far tighter.
"""

from __future__ import annotations

from collections.abc import Collection, Iterator
from dataclasses import dataclass
from functools import cached_property
from itertools import product
from typing import NamedTuple

import numpy as np

from clearance.geometry.convex_parts import convex_parts
from clearance.geometry.point_cloud import PointCloud
from clearance.geometry.polyhedron import Polyhedron
from clearance.geometry.polytope import Polytope
from clearance.geometry.polytope_hull import hull_corners
from clearance.kernels.motion.joint_path import JointPath
from clearance.kernels.motion.kinematics import BALL, SLIDING, TURNING, Links
from clearance.simulate.measure.certify import (
    columns_along,
    cubic_columns,
    joint_path,
    path_of,
)
from clearance.world.case import Case
from clearance.world.corner_paddings import corner_off
from clearance.world.cubic import cubics_of, extremes_between
from clearance.world.extents import own_floor
from clearance.world.forest import carried_by, forest_of, link_poses_at
from clearance.world.pairs import OBSTACLE, BodyIndex
from clearance.world.phase import Phase
from clearance.world.robot_in_cell import link_below
from clearance.world.timeline import Timeline

MOST_PARTS = 64
"""Into which an interval between two samples is divided."""

ROUNDING = 1e-9
"""[m] By how much every piece is wider still: far more than poses and hulls are rounded by."""


@dataclass(frozen=True, eq=False)
class SweptPiece:
    """A convex part of a body from `start` to `end` [s] of a run.

    Attributes:
        link: the name of a link of the robot, or of an obstacle that it carries.
        points: (n, 3) [m] the part's corners at moments of that time, world frame.
        leaves: [m] how far a point can be from the hull of `points` between two moments, and in a corner zone.
    """

    link: str
    start: float
    end: float
    points: np.ndarray
    leaves: float

    @cached_property
    def box(self) -> np.ndarray:
        """(2, 3) [m] least and greatest coordinates."""
        reach = self.leaves + ROUNDING
        return np.array([self.points.min(axis=0) - reach, self.points.max(axis=0) + reach])

    @cached_property
    def body(self) -> Polytope:
        """The convex body that contains the part throughout: the hull, wider by a cube."""
        corners = hull_corners(self.points)
        cube = (self.leaves + ROUNDING) * np.array(list(product((-1.0, 1.0), repeat=3)))
        return Polytope((corners[:, None] + cube[None]).reshape(-1, 3))


def swept_pieces(
    case: Case, timeline: Timeline, i_robot: int, within: float, cut_links: Collection[str] = ()
) -> list[SweptPiece]:
    """Pieces that together contain every measured link of a robot, and all that it carries, at every moment.

    Args:
        within: [m] a stretch ends before a point of the body can leave the chord over it by more. An interval over
            which it can is divided, into `MOST_PARTS` at most.
        cut_links: bodies to take by their convex parts instead of their hull; takes seconds a body.

    Exactness: an upper bound, at the steps and between them. Over one interval, of length 1, a point leaves its
        chord by at most
        1/8 max |x''| <= 1/8 (sum_k rho_k (w_k^2 + v_k + 2 w_k sum_{j above k} w_j) + sum_{k sliding} (v_k + 2 w_k
        sum_{j above k} w_j)), k turning in the first sum and j in both, with w_k and v_k bounds of the first two
        derivatives of joint k (`_Rates`), rho_k the motion radius of the body about joint k. The joints are all
        that move the body, down to what stands in the world; a ball joint turns about one axis in an interval.
        Source: as `certify` (Schwarzer, Saha & Latombe 2005), second derivatives of the chain.
    """
    present = [phase for phase in timeline.phases if i_robot not in phase.absent_robots]
    pieces: list[SweptPiece] = []
    for phase in present:
        bodies = list(_swept_bodies(case, phase, i_robot))
        pieces += _pieces_of_phase(phase, bodies, within, cut_links)
    return pieces


class _SweptBody(NamedTuple):
    """A body at the pose of a link of the forest, or up to `off` [m] from there."""

    name: str
    shape: Polyhedron
    link: int
    off: float


def _swept_bodies(case: Case, phase: Phase, i_robot: int) -> Iterator[_SweptBody]:
    """The measured links of a robot, then the obstacles in its hand or mounted on it."""
    placed, forest = phase.case.robots[i_robot], forest_of(phase.case)
    for i, body in enumerate(placed.robot.bodies):
        if body.name not in (*placed.exclude_links, own_floor(placed)):
            link = forest.robot_starts[i_robot] + placed.robot.link_names.index(body.name)
            off = corner_off(case, phase, BodyIndex(i_robot, i))
            yield _SweptBody(body.name, body.shape, link, off)
    for i, obstacle in enumerate(phase.case.obstacles):
        holder = link_below(phase, i)
        if holder is not None and holder[0] == i_robot:
            shape = obstacle.body.shape
            if isinstance(shape, PointCloud):
                shape = shape.box_about()
            off = corner_off(case, phase, BodyIndex(OBSTACLE, i))
            yield _SweptBody(obstacle.name, shape, forest.obstacle_links[i], off)


def _pieces_of_phase(
    phase: Phase, bodies: list[_SweptBody], within: float, cut_links: Collection[str]
) -> Iterator[SweptPiece]:
    case = phase.case
    links = forest_of(case).links
    path = path_of(links, case, phase.motions, slice(None))
    slides = _farthest(path)
    bends = [
        _Bend.of(list(carried_by(forest_of(case), body.link)), links, slides, body.shape)
        for body in bodies
    ]
    most = np.max([bend.at_most(_Rates.of(path)) for bend in bends], axis=0, initial=0.0)
    n_parts = np.clip(np.ceil(np.sqrt(most / within)), 1, MOST_PARTS).astype(int)
    path, poses = _divided(phase, path, n_parts)
    rates = _Rates.of(path)
    for body, bend in zip(bodies, bends, strict=True):
        parts = _parts(body.shape, body.name in cut_links)
        for first, last in _stretches(rates, bend, within):
            leaves = max(
                (float(bend.at_most(rates.at(i))) for i in range(first, last)), default=0.0
            )
            leaves += body.off + case.path_error
            chosen = poses[first : last + 1, body.link]
            for part in parts:
                points = np.einsum("nij,kj->nki", chosen[:, :3, :3], part) + chosen[:, None, :3, 3]
                span = float(path.times[first]), float(path.times[last])
                yield SweptPiece(body.name, *span, points.reshape(-1, 3), leaves)


def _divided(phase: Phase, path: JointPath, n_parts: np.ndarray) -> tuple[JointPath, np.ndarray]:
    """The motion of the joints with each interval in so many parts, and (k, links, 4, 4) all poses [m] on it."""
    case, motions, forest = phase.case, phase.motions, forest_of(phase.case)
    if (n_parts == 1).all():
        return path, link_poses_at(case, motions, slice(None))
    shares = [np.arange(n) / n for n in n_parts]
    found = [columns_along(case, motions, step, share) for step, share in enumerate(shares)]
    found.append(columns_along(case, motions, len(n_parts) - 1, np.ones(1)))
    positions, rates = (np.concatenate(rows) for rows in zip(*found, strict=True))
    steps = np.concatenate([step + share for step, share in enumerate(shares)] + [[len(n_parts)]])
    times = np.interp(steps, np.arange(len(path.times)), path.times)
    cubic = cubic_columns(motions, positions.shape[1])
    return joint_path(forest.links, times, positions, rates, cubic), forest.poses(positions)


def _parts(shape: Polyhedron, cut: bool) -> list[np.ndarray]:
    """The corners (k, 3) [m] of convex bodies that contain a shape."""
    if cut:
        return [part.vertices for part in convex_parts(shape).outer]
    return [Polytope(shape.vertices[np.unique(shape.face_vertices)]).vertices]


class _Rates(NamedTuple):
    """How fast the joint above each link moves in each interval, of length 1; (n - 1, n_links) or (n_links,).

    Attributes:
        most: its greatest speed; linear motion has that throughout. bend: its greatest acceleration.
    """

    most: np.ndarray
    bend: np.ndarray

    @classmethod
    def of(cls, path: JointPath) -> _Rates:
        """On a cubic the speed is a quadratic: it lies within its Bernstein coefficients; the bend is linear."""
        most = np.abs(np.diff(path.positions, axis=0))
        bend = np.zeros_like(most)
        if len(path.balls.links):
            most[:, path.balls.links] = path.balls.arcs[:, :, 7]
        if path.is_cubic.any():
            on = path.is_cubic
            _, step, e0, e1 = cubics_of(path.times, path.positions[:, on], path.velocities[:, on])
            most[:, on] = np.abs([step + e0, step - e0 - e1, step + e1]).max(axis=0)
            bend[:, on] = np.abs([4.0 * e0 + 2.0 * e1, 2.0 * e0 + 4.0 * e1]).max(axis=0)
        return cls(most, bend)

    def at(self, i: int) -> _Rates:
        """Those of one interval."""
        return _Rates(self.most[i], self.bend[i])

    def and_then(self, other: _Rates) -> _Rates:
        """Those of two stretches as one."""
        return _Rates(self.most + other.most, self.bend + other.bend)


def _stretches(rates: _Rates, bend: _Bend, within: float) -> list[tuple[int, int]]:
    """First and last step of stretches that follow each other, each as long as `within` allows."""
    n_intervals = len(rates.most)
    if not n_intervals:
        return [(0, 0)]
    found, first = [], 0
    while first < n_intervals:
        last, total = first + 1, rates.at(first)
        while last < n_intervals and bend.at_most(total.and_then(rates.at(last))) <= within:
            total = total.and_then(rates.at(last))
            last += 1
        found.append((first, last))
        first = last
    return found


@dataclass(frozen=True, eq=False)
class _Bend:
    """How much a link's points can bend off a straight way: the joints above it, root first.

    Attributes:
        links: (k,) the links below these joints. turning: (k,) else sliding. reach: (k,) [m] how far the
            link's points can be from each joint.
    """

    links: np.ndarray
    turning: np.ndarray
    reach: np.ndarray

    @classmethod
    def of(cls, above: list[int], links: Links, slides: np.ndarray, shape: Polyhedron) -> _Bend:
        """Of a shape on the first of some links that are above one another, nearest first."""
        reach = float(np.linalg.norm(shape.vertices[shape.face_vertices], axis=1).max())
        rows: list[tuple[int, bool, float]] = []
        for link in above[:-1]:  # the last is a root, which stands
            kind = links.kinds[link]
            if kind == SLIDING:
                reach += float(slides[link])
            if kind in (TURNING, BALL, SLIDING):
                rows.append((link, bool(kind != SLIDING), reach))
            reach += float(np.linalg.norm(links.parent_from_joint[link, :3, 3]))
        found, turning, reaches = zip(*rows[::-1], strict=True) if rows else ((), (), ())
        return cls(np.array(found, dtype=int), np.array(turning, dtype=bool), np.array(reaches))

    def at_most(self, rates: _Rates) -> np.ndarray:
        """() or (n - 1,) [m] no point leaves its chord by more when the joints above the links move like this."""
        most, bend = (part[..., self.links] for part in rates)
        turned = np.where(self.turning, most, 0.0)
        above = np.zeros_like(turned)
        above[..., 1:] = np.cumsum(turned, axis=-1)[..., :-1]
        around = self.reach * (turned * (turned + 2.0 * above) + np.where(self.turning, bend, 0.0))
        along = np.where(self.turning, 0.0, bend + 2.0 * most * above)
        return np.asarray((around + along).sum(axis=-1) / 8.0)


def _farthest(path: JointPath) -> np.ndarray:
    """(links,) the greatest position that the joint above each link has, either way, also between the steps."""
    farthest = np.abs(path.positions).max(axis=0)
    if path.is_cubic.any() and len(path.positions) > 1:
        on = path.is_cubic
        reached = extremes_between(path.times, path.positions[:, on], path.velocities[:, on])
        farthest[on] = np.abs(np.concatenate(reached)).max(axis=0)
    return farthest

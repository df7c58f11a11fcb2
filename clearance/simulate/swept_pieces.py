"""What a robot's links pass through, as convex pieces that hold all of it.

A piece is the hull of one convex part of a link at the samples of a stretch of the trajectory, made wider by
what a point can leave its chord between two samples. Not for: distance between the samples (`certify`), which
is far tighter.
"""

from __future__ import annotations

from collections.abc import Collection
from dataclasses import dataclass
from functools import cached_property
from itertools import product
from typing import NamedTuple

import numpy as np

from clearance.geometry.convex_parts import convex_parts
from clearance.geometry.polyhedron import Polyhedron
from clearance.geometry.polytope import Polytope
from clearance.kernels.motion.kinematics import SLIDING, TURNING
from clearance.world.cubic import cubics_of, extremes_between
from clearance.world.kinematics import kinematic_tree_arrays, positions_by_link, velocities_by_link
from clearance.world.motion import Motion

ROUNDING = 1e-9
"""[m] By how much every piece is wider still: far more than poses and hulls are rounded by."""


@dataclass(frozen=True, eq=False)
class SweptPiece:
    """A convex part of a link over the steps `first` to `last`.

    Attributes:
        points: (n, 3) [m] the part's corners at those steps, world frame.
        leaves: [m] how far a point can be from the hull of `points` between two steps.
    """

    link: str
    first: int
    last: int
    points: np.ndarray
    leaves: float

    @cached_property
    def box(self) -> np.ndarray:
        """(2, 3) [m] least and greatest coordinates."""
        reach = self.leaves + ROUNDING
        return np.array([self.points.min(axis=0) - reach, self.points.max(axis=0) + reach])

    @cached_property
    def body(self) -> Polytope:
        """The convex body that holds the part throughout: the hull, wider by a cube."""
        corners = _corners_of_hull(self.points)
        cube = (self.leaves + ROUNDING) * np.array(list(product((-1.0, 1.0), repeat=3)))
        return Polytope((corners[:, None] + cube[None]).reshape(-1, 3))


def swept_pieces(
    motion: Motion, within: float, cut_links: Collection[str] = ()
) -> list[SweptPiece]:
    """Pieces that together hold every measured link at every moment, at the steps and between them.

    Args:
        within: [m] a stretch ends before a point of the link can leave the chord over it by more.
        cut_links: links to take by their convex parts instead of their hull; takes seconds a link.

    Exactness: an upper bound. Over one interval, of length 1, a point leaves its chord by at most
        1/8 max |x''| <= 1/8 (sum_k rho_k (w_k^2 + v_k + 2 w_k sum_{j above k} w_j) + sum_{k sliding} (v_k + 2 w_k
        sum_{j above k} w_j)), k turning in the first sum and j in both, with w_k and v_k bounds of the first two
        derivatives of joint k (`_Rates`), rho_k the motion radius of the link about joint k.
        Source: as `certify` (Schwarzer, Saha & Latombe 2005), second derivatives of the chain.
    """
    placed = motion.placed
    rates = _Rates.of(motion)
    poses = motion.poses()
    pieces: list[SweptPiece] = []
    for body in placed.robot.bodies:
        if body.name in placed.exclude_links:
            continue
        i_link = placed.robot.link_names.index(body.name)
        bend = _Bend.of(motion, i_link, body.shape)
        parts = _parts(body.shape, body.name in cut_links)
        for first, last in _stretches(rates, bend, within):
            leaves = max((bend.at_most(rates.at(i)) for i in range(first, last)), default=0.0)
            chosen = poses[first : last + 1, i_link]
            for part in parts:
                points = np.einsum("nij,kj->nki", chosen[:, :3, :3], part) + chosen[:, None, :3, 3]
                pieces.append(SweptPiece(body.name, first, last, points.reshape(-1, 3), leaves))
    return pieces


def _corners_of_hull(points: np.ndarray) -> np.ndarray:
    """The points that are corners of their hull; all of them where Qhull finds them flat."""
    from scipy.spatial import ConvexHull, QhullError

    try:
        return points[ConvexHull(points).vertices]
    except QhullError:
        return points


def _parts(shape: Polyhedron, cut: bool) -> list[np.ndarray]:
    """The corners (k, 3) [m] of convex bodies that hold a link."""
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
    def of(cls, motion: Motion) -> _Rates:
        """On a cubic the speed is a quadratic: it lies within its Bernstein coefficients; the bend is linear."""
        robot = motion.placed.robot
        positions = positions_by_link(robot, motion.positions)
        if motion.velocities is None:
            steps = np.abs(np.diff(positions, axis=0))
            return cls(steps, np.zeros_like(steps))
        velocities = velocities_by_link(robot, motion.velocities)
        _, step, e0, e1 = cubics_of(motion.times, positions, velocities)
        most = np.abs([step + e0, step - e0 - e1, step + e1]).max(axis=0)
        return cls(most, np.abs([4.0 * e0 + 2.0 * e1, 2.0 * e0 + 4.0 * e1]).max(axis=0))

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
    def of(cls, motion: Motion, i_link: int, shape: Polyhedron) -> _Bend:
        robot = motion.placed.robot
        parents, kinds, fixed_parts, _ = kinematic_tree_arrays(robot)
        slides = _farthest(motion)
        reach = float(np.linalg.norm(shape.vertices[shape.face_vertices], axis=1).max())
        rows: list[tuple[int, bool, float]] = []
        while i_link != 0:
            if kinds[i_link] == SLIDING:
                reach += float(slides[i_link])
            if kinds[i_link] in (TURNING, SLIDING):
                rows.append((i_link, bool(kinds[i_link] == TURNING), reach))
            reach += float(np.linalg.norm(fixed_parts[i_link, :3, 3]))
            i_link = int(parents[i_link])
        links, turning, reaches = zip(*rows[::-1], strict=True) if rows else ((), (), ())
        return cls(np.array(links, dtype=int), np.array(turning, dtype=bool), np.array(reaches))

    def at_most(self, rates: _Rates) -> float:
        """[m] no point leaves its chord by more when the joints above the links move like this."""
        most, bend = (part[self.links] for part in rates)
        turned = np.where(self.turning, most, 0.0)
        above = np.concatenate([[0.0], np.cumsum(turned)[:-1]]) if len(turned) else turned
        around = self.reach * (turned * (turned + 2.0 * above) + np.where(self.turning, bend, 0.0))
        along = np.where(self.turning, 0.0, bend + 2.0 * most * above)
        return float((around + along).sum() / 8.0)


def _farthest(motion: Motion) -> np.ndarray:
    """(n_links,) the greatest position that the joint above each link has, either way, also between the steps."""
    robot = motion.placed.robot
    positions = positions_by_link(robot, motion.positions)
    if motion.velocities is not None and len(positions) > 1:
        velocities = velocities_by_link(robot, motion.velocities)
        positions = np.concatenate(extremes_between(motion.times, positions, velocities))
    return np.abs(positions).max(axis=0)

"""What a robot's links pass through, as convex pieces that hold all of it.

A piece is the hull of one convex part of a link at the samples of a stretch of the trajectory, made wider by
what a point can leave its chord between two samples. Not for: distance between the samples (`certify`), which
is far tighter.
"""

from __future__ import annotations

from collections.abc import Collection, Sequence
from dataclasses import dataclass
from functools import cached_property
from itertools import product

import numpy as np

from clearance.geometry.convex_parts import convex_parts
from clearance.geometry.polyhedron import Polyhedron
from clearance.geometry.polytope import Polytope
from clearance.kernels.kinematics import SLIDING, TURNING
from clearance.world.kinematics import chain_arrays, positions_by_link
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
    """Pieces that together hold every measured link at every moment, joints moving linearly between steps.

    Args:
        within: [m] a stretch ends before a point of the link can leave the chord over it by more.
        cut_links: links to take by their convex parts instead of their hull; takes seconds a link.

    Exactness: an upper bound. Over one interval of the joints' linear motion a point leaves its chord by at
        most 1/8 max |x''| <= 1/8 (sum_k d_k rho_k (d_k + 2 sum_{j above k} d_j) + 2 sum_{k sliding} d_k sum_{j
        above k} d_j), with d_k what joint k turns or slides and rho_k how far the link reaches from joint k in
        any pose. Source: as `certify` (Schwarzer, Saha & Latombe 2005), second derivatives of the chain.
    """
    motion.require_linear("a shared workspace")
    placed = motion.placed
    turns = np.abs(np.diff(positions_by_link(placed.robot, motion.positions), axis=0))
    poses = motion.poses()
    pieces: list[SweptPiece] = []
    for body in placed.robot.bodies:
        if body.name in placed.exclude_links:
            continue
        i_link = placed.robot.link_names.index(body.name)
        bend = _Bend.of(motion, i_link, body.shape)
        parts = _parts(body.shape, body.name in cut_links)
        for first, last in _stretches(turns, bend, within):
            leaves = max((bend.at_most(turns[i]) for i in range(first, last)), default=0.0)
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


def _stretches(turns: np.ndarray, bend: _Bend, within: float) -> list[tuple[int, int]]:
    """First and last step of stretches that follow each other, each as long as `within` allows."""
    if not len(turns):
        return [(0, 0)]
    found, first = [], 0
    while first < len(turns):
        last, total = first + 1, turns[first].copy()
        while last < len(turns) and bend.at_most(total + turns[last]) <= within:
            total += turns[last]
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
        parents, kinds, fixed_parts, _ = chain_arrays(robot)
        slides = np.abs(positions_by_link(robot, motion.positions)).max(axis=0)
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

    def at_most(self, turns: Sequence[float] | np.ndarray) -> float:
        """[m] no point leaves its chord by more when the joint above each link moves by `turns`."""
        moved = np.asarray(turns)[self.links]
        turned = np.where(self.turning, moved, 0.0)
        above = np.concatenate([[0.0], np.cumsum(turned)[:-1]]) if len(turned) else turned
        bends = turned * self.reach * (turned + 2.0 * above)
        slid = np.where(self.turning, 0.0, moved)
        return float((bends + 2.0 * slid * above).sum() / 8.0)

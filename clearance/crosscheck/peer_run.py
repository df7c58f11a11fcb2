"""The peer's own answer to a case: the least clearance of every step, by FCL and a winding number.

Every measured pair takes part in every step; a pair is skipped only where a lower bound made of
numpy boxes, or of FCL's own last answer less the motion since then, shows that it cannot be the
nearest. None of this shares code with our own pruning.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass

import numpy as np

from clearance.crosscheck.pairs import PeerPair, peer_pairs
from clearance.crosscheck.triangles import is_inside
from clearance.record.record import Samples
from clearance.world.forest import link_poses_at
from clearance.world.pairs import Pair

_CORNERS = np.array([[i, j, k] for i in (0, 1) for j in (0, 1) for k in (0, 1)])
_STEPS_AT_ONCE = 512
_CELL = 2.0 / 3.0**0.5 * (1.0 - 1e-6)  # [-] edge of a cell whose diagonal is just below 2
_ROUNDING = (
    1e-12  # [m] subtracted from every lower bound: far above float64, far below the tolerance
)


@dataclass(frozen=True, eq=False)
class PeerAnswers:
    """The findings of the peer.

    Attributes:
        clearances: (n,) [m].
        i_pairs: (n,) index of the pair that attains it.
        diagonal: [m] of the box along the world axes that contains every measured body at every step.
        n_queries: distances that FCL measured.
    """

    clearances: np.ndarray
    i_pairs: np.ndarray
    diagonal: float
    n_queries: int


class PeerRun:
    """The bodies of a record in FCL, and the measuring of all its steps."""

    def __init__(self, record: Samples, measured: Sequence[Pair]) -> None:
        self.record = record
        self.movers, self.pairs = peer_pairs(record.case, measured)
        self._i_movers = np.array([pair.i_mover for pair in self.pairs])
        self._i_others = np.array([pair.i_other for pair in self.pairs])
        self._low, self._high = np.full(3, np.inf), np.full(3, -np.inf)
        self._carried = np.zeros(len(self.pairs))  # [m] lower bounds from the step before
        self._n_queries = 0

    @property
    def point_size(self) -> float:
        """[m] by how much the points of two clouds can seem nearer to FCL than they are; 0 without clouds."""
        return 2.0 * max(mover.side.peer.point_size for mover in self.movers)

    def measure(self, progress: Callable[[int, int], None] | None = None) -> PeerAnswers:
        """The peer's answers to all steps; `progress(done, total)` is called after each chunk of
        steps.
        """
        n_steps = self.record.motions[0].n_steps
        clearances, i_pairs = np.empty(n_steps), np.empty(n_steps, dtype=np.int64)
        for start in range(0, n_steps, _STEPS_AT_ONCE):
            stop = min(start + _STEPS_AT_ONCE, n_steps)
            poses = self.poses(max(0, start - 1), stop)  # one more, for the motion into the first
            clearances[start:stop], i_pairs[start:stop] = self._measure_chunk(poses, stop - start)
            if progress is not None:
                progress(stop, n_steps)
        diagonal = float(np.linalg.norm(self._high - self._low))
        return PeerAnswers(clearances, i_pairs, diagonal, self._n_queries)

    def poses(self, start: int, stop: int) -> np.ndarray:
        """(movers, steps, 4, 4) `world_from_link` [m] of the steps `start` to `stop`."""
        case = self.record.case
        poses = link_poses_at(case, self.record.motions, slice(start, stop))
        return np.array([mover.body.poses_in(case, poses) for mover in self.movers])

    def collides(self, step: int, i_pair: int) -> bool:
        """True if FCL's collision test or the winding number finds contact of one pair at one
        step.
        """
        pair = self.pairs[i_pair]
        poses = self.poses(step, step + 1)
        pair.link.peer.place(poses[pair.i_mover][0])
        pair.other.peer.place(poses[pair.i_other][0])
        return pair.link.peer.collides(pair.other.peer) or self.is_nested(step, i_pair)

    def is_nested(self, step: int, i_pair: int) -> bool:
        """True if the winding number finds one body of a pair inside the other at one step."""
        pair = self.pairs[i_pair]
        poses = self.poses(step, step + 1)
        if pair.radii > 0.0:
            pair.link.peer.place(poses[pair.i_mover][0])
            pair.other.peer.place(poses[pair.i_other][0])
            return contains_a_point(pair, poses[pair.i_mover][0], poses[pair.i_other][0])
        return bool(nested_steps(pair, poses[pair.i_mover], poses[pair.i_other])[0])

    def _measure_chunk(self, poses: np.ndarray, n_new: int) -> tuple[np.ndarray, np.ndarray]:
        moved = self._displacements(poses)[-n_new:]
        poses = poses[:, -n_new:]
        boxes = np.array(
            [
                world_boxes(mover.side.soup.bounds, p)
                for mover, p in zip(self.movers, poses, strict=True)
            ]
        )
        self._low = np.minimum(self._low, boxes[:, :, 0].min(axis=(0, 1)))
        self._high = np.maximum(self._high, boxes[:, :, 1].max(axis=(0, 1)))
        gap = np.array(
            [
                lower_bound_boxes(boxes[m], boxes[other])
                for m, other in zip(self._i_movers, self._i_others, strict=True)
            ]
        ).T
        within = np.array(
            [nested_steps(pair, poses[pair.i_mover], poses[pair.i_other]) for pair in self.pairs]
        ).T
        found = [self._measure_step(poses[:, k], moved[k], gap[k], within[k]) for k in range(n_new)]
        return np.array([d for d, _ in found]), np.array([i for _, i in found])

    def _displacements(self, poses: np.ndarray) -> np.ndarray:
        """(steps, movers) [m] how far each body can have moved since the step before; infinite at
        the first.
        """
        moved = np.array(
            [
                greatest_displacements(mover.side.soup.bounds, p)
                for mover, p in zip(self.movers, poses, strict=True)
            ]
        ).reshape(len(self.movers), -1)
        return np.vstack([np.full(len(self.movers), np.inf), moved.T])

    def _measure_step(
        self, poses: np.ndarray, moved: np.ndarray, gap: np.ndarray, within: np.ndarray
    ) -> tuple[float, int]:
        """The least clearance [m] and its pair, nearest lower bound first."""
        motion = moved[self._i_movers] + moved[self._i_others]
        bounds = np.maximum(self._carried - motion, gap) - _ROUNDING
        self._carried = np.maximum(bounds, 0.0)
        if within.any():
            return 0.0, int(np.argmax(within))
        for mover, pose in zip(self.movers, poses, strict=True):
            mover.side.peer.place(pose)
        best, i_best = np.inf, -1
        for i_pair in np.argsort(bounds, kind="stable"):
            if bounds[i_pair] >= best or best == 0.0:
                break
            pair = self.pairs[i_pair]
            distance = pair.link.peer.distance(pair.other.peer)
            if distance > 0.0 and pair.radii > 0.0:
                if contains_a_point(pair, poses[pair.i_mover], poses[pair.i_other]):
                    distance = 0.0
            self._carried[i_pair] = distance
            self._n_queries += 1
            if distance < best:
                best, i_best = distance, int(i_pair)
        return best, i_best


def nested_steps(
    pair: PeerPair, world_from_link: np.ndarray, world_from_other: np.ndarray
) -> np.ndarray:
    """(n,) True at the poses (n, 4, 4) where a part of one body of the pair is inside the other.

    Clouds are omitted: their points are tested one by one where the surfaces are known to be separate.
    """
    if pair.radii > 0.0:
        return np.zeros(len(world_from_link), dtype=bool)
    other_from_link = np.linalg.inv(world_from_other) @ world_from_link
    nested = np.zeros(len(world_from_link), dtype=bool)
    for outer, inner, relative in (
        (pair.other.soup, pair.link.soup, other_from_link),
        (pair.link.soup, pair.other.soup, np.linalg.inv(other_from_link)),
    ):
        turned = inner.part_points @ relative[:, :3, :3].transpose(0, 2, 1)
        points = turned + relative[:, None, :3, 3]
        nested |= is_inside(outer, points.reshape(-1, 3)).reshape(points.shape[:2]).any(axis=1)
    return nested


def contains_a_point(
    pair: PeerPair, world_from_link: np.ndarray, world_from_other: np.ndarray
) -> bool:
    """True if a point of a cloud is inside the other body, whose surface no ball meets.

    By FCL no point is nearer to the surface than `gap`: so no surface is between two points less than twice that
    from each other, and one of each cell so small is tested. Both bodies are placed in FCL.
    """
    gap = pair.link.peer.distance_of_centres(pair.other.peer)
    sides = (pair.link, world_from_link), (pair.other, world_from_other)
    for (cloud, world_from_cloud), (body, world_from_body) in (sides, sides[::-1]):
        if cloud.soup.radius > 0.0 and body.soup.holds:
            body_from_cloud = np.linalg.inv(world_from_body) @ world_from_cloud
            low, high = body.soup.bounds
            middle = np.linalg.inv(body_from_cloud) @ [*(0.5 * (low + high)), 1.0]
            near = cloud.tree.query_ball_point(middle[:3], 0.5 * np.linalg.norm(high - low) + 1e-9)
            points = cloud.soup.vertices[near]
            if body.soup.encloses:  # else a path leads from in to out through a hole
                cells = np.floor(points / (gap * _CELL))
                points = points[np.unique(cells, axis=0, return_index=True)[1]]
            points = points @ body_from_cloud[:3, :3].T + body_from_cloud[:3, 3]
            if is_inside(body.soup, points).any():
                return True
    return False


def box_corners(bounds: np.ndarray) -> np.ndarray:
    """(8, 3) corners [m] of a box given as (2, 3)."""
    return bounds[_CORNERS, np.arange(3)]


def world_boxes(bounds: np.ndarray, poses: np.ndarray) -> np.ndarray:
    """(n, 2, 3) [m] boxes along the world axes that contain a body box (2, 3) at poses (n, 4, 4)."""
    corners = box_corners(bounds) @ poses[:, :3, :3].transpose(0, 2, 1) + poses[:, None, :3, 3]
    return np.stack([corners.min(axis=1), corners.max(axis=1)], axis=1)


def lower_bound_boxes(boxes: np.ndarray, others: np.ndarray) -> np.ndarray:
    """(n,) [m] the distance of boxes (n, 2, 3) from as many others, or from one (2, 3), along the world axes."""
    gap = np.maximum(others[..., 0, :] - boxes[:, 1], boxes[:, 0] - others[..., 1, :]).clip(min=0.0)
    return np.sqrt((gap * gap).sum(axis=1))


def greatest_displacements(bounds: np.ndarray, poses: np.ndarray) -> np.ndarray:
    """(n - 1,) [m] upper bounds on how far any point of a body box (2, 3) moves from one pose to
    the next.

    The displacement |(B - A) x| is convex in x, so its greatest value in a box is at a corner.
    """
    corners = box_corners(bounds)
    change = np.diff(poses, axis=0)
    moved = corners @ change[:, :3, :3].transpose(0, 2, 1) + change[:, None, :3, 3]
    return np.sqrt((moved * moved).sum(axis=2).max(axis=1))

"""Two solids measured at many poses: an object that caches the findings of the last answer."""

from __future__ import annotations

import os
import threading
from dataclasses import dataclass

import numpy as np

from clearance.errors import BadShape, at
from clearance.geometry.polyhedron import Polyhedron
from clearance.geometry.pose import validated_pose
from clearance.kernels.search.pair_query import POSES_ARE_RIGID, nearest_at_poses
from clearance.kernels.search.scratch import new_scratch
from clearance.query.one_pair import OnePair, answer_rows
from clearance.query.result import Nearest

_processes = 0
"""How many forks lie between the first process and this one. A child has the locks of its parent as they were, and
what other threads were searching in half done: each query begins anew there."""


def _count_process() -> None:
    global _processes
    _processes += 1


if hasattr(os, "register_at_fork"):
    os.register_at_fork(after_in_child=_count_process)


@dataclass(frozen=True, eq=False)
class NearestAtPoses:
    """How close two solids come at each of n poses, and where; row by row as in `Nearest`.

    Attributes:
        distances: (n,) [m]; 0 where they touch, overlap, or one is inside the other.
        points: (n, 2, 3) [m] witness points on a and b in the world frame.
        faces: (n, 2) polygons with the witness points; -1 where one body is inside the other.
        error_bounds: (n,) [m].
        undecided: (n,) True where one body may be inside the other, as `Nearest.inside` says.
    """

    distances: np.ndarray
    points: np.ndarray
    faces: np.ndarray
    error_bounds: np.ndarray
    undecided: np.ndarray


class Query:
    """The distance of one pair of polyhedra at many poses.

    The answers are those of `distance`, whatever came before; poses near the last ones are answered faster.
    Threads may share a query, but its questions are answered one at a time; give each thread its own.

    Args:
        a, b: the solids; they may be the same object.
    """

    def __init__(self, a: Polyhedron, b: Polyhedron) -> None:
        self.a, self.b = a, b
        self._begin()

    def _begin(self) -> None:
        self._process = _processes
        self._lock = threading.Lock()
        self._pair = OnePair(self.a, self.b, new_scratch(), goes_on=True)

    def _alone(self) -> threading.Lock:
        """The lock under which the pair is measured; both are made anew in a process that was forked off."""
        if self._process != _processes:
            self._begin()
        return self._lock

    def distance(
        self, world_from_a: np.ndarray | None = None, world_from_b: np.ndarray | None = None
    ) -> Nearest:
        """The global minimum distance at one pose of each and where it is attained.

        Args:
            world_from_a, world_from_b: (4, 4) poses [m]; the identity if not given.

        Raises:
            BadPose, BadShape, NotFinite: not a rigid motion.

        Exactness, Ties: as `distance`.
        """
        with self._alone():
            return self._pair.nearest(world_from_a, world_from_b)

    def distances(
        self, worlds_from_a: np.ndarray | None = None, worlds_from_b: np.ndarray | None = None
    ) -> NearestAtPoses:
        """The global minimum distance at each of n poses, in one compiled call.

        Args:
            worlds_from_a, worlds_from_b: (n, 4, 4) poses [m], or one (4, 4) for a body that stands; the
                identity if not given.

        Raises:
            BadPose, BadShape, NotFinite: the first that is not a rigid motion, or not as many of both.
        """
        poses_a, poses_b = (
            _poses(worlds_from_a, "worlds_from_a"),
            _poses(worlds_from_b, "worlds_from_b"),
        )
        lengths = {len(poses) for poses in (poses_a, poses_b) if len(poses) != 1}
        if len(lengths) > 1:
            raise BadShape(
                f"{len(poses_a)} poses of a and {len(poses_b)} of b", valid="as many of each"
            )
        numbers, points, counts = answer_rows(lengths.pop() if lengths else 1)
        with self._alone():
            arrays = self._pair.arrays
            if nearest_at_poses(arrays, poses_a, poses_b, 0, numbers, points, counts) != -1:
                _validate(poses_a, "worlds_from_a")
                _validate(poses_b, "worlds_from_b")
                how = POSES_ARE_RIGID
                nearest_at_poses(arrays, poses_a, poses_b, how, numbers, points, counts)
        distances = numbers[:, 0].copy()
        undecided = _undecided(self._pair, distances, poses_a, poses_b)
        return NearestAtPoses(
            distances, points, counts[:, :2].copy(), numbers[:, 1].copy(), undecided
        )


def _undecided(
    pair: OnePair, distances: np.ndarray, poses_a: np.ndarray, poses_b: np.ndarray
) -> np.ndarray:
    """(n,) `NearestAtPoses.undecided`."""
    found = np.zeros(len(distances), dtype=bool)
    separate = np.flatnonzero(distances > 0.0)
    if pair.doubt is not None and len(separate):
        at_a, at_b = (
            np.resize(poses if len(poses) == 1 else poses[separate], (len(separate), 4, 4))
            for poses in (poses_a, poses_b)
        )
        found[separate] = pair.doubt.at(at_a, at_b)
    return found


def _poses(given: np.ndarray | None, where: str) -> np.ndarray:
    """(n, 4, 4) a copy of what is given."""
    try:
        poses = np.array(np.eye(4) if given is None else given, dtype=np.float64, order="C")
    except (TypeError, ValueError):
        raise BadShape(
            f"{given!r:.60}", where=where, valid="an (n, 4, 4) array of numbers"
        ) from None
    if poses.ndim not in (2, 3) or poses.shape[-2:] != (4, 4):
        raise BadShape(f"shape {poses.shape}", where=where, valid="(n, 4, 4) or (4, 4) is needed")
    return poses.reshape(-1, 4, 4)


def _validate(poses: np.ndarray, where: str) -> None:
    for i, pose in enumerate(poses):
        with at(f"{where}[{i}]"):
            validated_pose(pose)

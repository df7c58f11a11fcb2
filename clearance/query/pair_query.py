"""Two solids asked about at many poses: an object that keeps what the last answer has found.

Not for: single questions (`distance`, which gives the same answers).
"""

from __future__ import annotations

import threading
from dataclasses import dataclass

import numpy as np

from clearance.errors import BadShape, at
from clearance.geometry.polyhedron import Polyhedron
from clearance.geometry.pose import validated_pose
from clearance.geometry.tree import surface_of
from clearance.kernel_table import call
from clearance.kernels.pair_query import hold_pair, nearest_at_poses
from clearance.query.result import Nearest

_AT_REST = np.eye(4)


@dataclass(frozen=True, eq=False)
class NearestAtPoses:
    """How close two solids come at each of n poses, and where; row by row as in `Nearest`.

    Attributes:
        distances: (n,) [m]; 0 where they touch, overlap, or one is inside the other.
        points: (n, 2, 3) [m] witness points on a and b in the world frame.
        faces: (n, 2) polygons that hold them; -1 where one body is inside the other.
        error_bounds: (n,) [m].
    """

    distances: np.ndarray
    points: np.ndarray
    faces: np.ndarray
    error_bounds: np.ndarray


class Query:
    """The distance of one pair of polyhedra at many poses.

    The answers are those of `distance`, whatever was asked before; poses near the last ones are answered faster.
    Threads may share a query, but its questions are answered one at a time; give each thread its own.

    Args:
        a, b: the solids; they may be the same object.
    """

    def __init__(self, a: Polyhedron, b: Polyhedron) -> None:
        self.a, self.b = a, b
        self._lock = threading.Lock()
        self._held = hold_pair(surface_of(a), surface_of(b))
        poses, rows = (np.empty((1, 4, 4)), np.empty((1, 4, 4))), _rows(1)
        self._asked = (self._held, *poses, False, *rows)
        (self._pose_a,), (self._pose_b,) = poses
        (self._number,), (self._point,), (self._count,) = rows

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
        pose_a, pose_b = _pose(world_from_a), _pose(world_from_b)
        with self._lock:
            self._pose_a[...], self._pose_b[...] = pose_a, pose_b
            if call(nearest_at_poses, *self._asked) >= 0:
                validated_pose(pose_a), validated_pose(pose_b)
                call(nearest_at_poses, *self._asked[:3], True, *self._asked[4:])
            (distance, error), points = self._number.tolist(), self._point.copy()
            face_a, face_b, n_nodes, n_faces, n_exact = self._count.tolist()
        return Nearest(
            distance, points[0], points[1], face_a, face_b, distance == 0.0, error,
            {"nodes": n_nodes, "polygons": n_faces, "exact_decisions": n_exact},
        )  # fmt: skip

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
        poses_a, poses_b = _poses(worlds_from_a, "worlds_from_a"), _poses(worlds_from_b, "worlds_from_b")
        lengths = {len(poses) for poses in (poses_a, poses_b) if len(poses) != 1}
        if len(lengths) > 1:
            raise BadShape(f"{len(poses_a)} poses of a and {len(poses_b)} of b", valid="as many of each")
        numbers, points, counts = _rows(lengths.pop() if lengths else 1)
        with self._lock:
            if call(nearest_at_poses, self._held, poses_a, poses_b, False, numbers, points, counts) >= 0:
                _validate(poses_a, "worlds_from_a")
                _validate(poses_b, "worlds_from_b")
                call(nearest_at_poses, self._held, poses_a, poses_b, True, numbers, points, counts)
        return NearestAtPoses(
            numbers[:, 0].copy(), points, counts[:, :2].copy(), numbers[:, 1].copy()
        )


def _rows(n: int) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """Room for n answers, as `nearest_at_poses` fills it."""
    return np.empty((n, 2)), np.empty((n, 2, 3)), np.empty((n, 5), dtype=np.int64)


def _pose(given: np.ndarray | None) -> np.ndarray:
    """A (4, 4) array that is not yet known to be a pose."""
    if given is None:
        return _AT_REST
    try:
        pose = np.asarray(given, dtype=np.float64)
    except (TypeError, ValueError):
        return validated_pose(given)
    return pose if pose.shape == (4, 4) else validated_pose(pose)


def _poses(given: np.ndarray | None, where: str) -> np.ndarray:
    """(n, 4, 4) a copy of what is given."""
    try:
        poses = np.array(np.eye(4) if given is None else given, dtype=np.float64, order="C")
    except (TypeError, ValueError):
        raise BadShape(f"{given!r:.60}", where=where, valid="an (n, 4, 4) array of numbers") from None
    if poses.ndim not in (2, 3) or poses.shape[-2:] != (4, 4):
        raise BadShape(f"shape {poses.shape}", where=where, valid="(n, 4, 4) or (4, 4) is needed")
    return poses.reshape(-1, 4, 4)


def _validate(poses: np.ndarray, where: str) -> None:
    for i, pose in enumerate(poses):
        with at(f"{where}[{i}]"):
            validated_pose(pose)

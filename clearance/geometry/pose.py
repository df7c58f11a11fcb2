"""Poses: (4, 4) rigid motions `world_from_body`, made from the forms that files use and checked where given."""

from __future__ import annotations

import math
from collections.abc import Sequence
from functools import lru_cache

import numpy as np

from clearance.errors import BadPose, BadShape, NotFinite
from clearance.tolerance import LARGEST, ROTATION


def pose_from_quaternion(xyz: Sequence[float], quat_xyzw: Sequence[float]) -> np.ndarray:
    """The (4, 4) pose that turns by a unit quaternion and then moves by `xyz` [m].

    Args:
        xyz: (3,) [m].
        quat_xyzw: (4,) the scalar last, as in ROS; its length is made 1 where it is nearly so.

    Raises:
        BadPose: length not 1 within `tolerance.ROTATION`. BadShape, NotFinite: not such numbers.

    Exactness: quaternions with a single non-zero component give exact matrices; else entries are right to
        a few roundings, R^T R = I to about 1e-15.
    """
    x, y, z, w = _numbers(quat_xyzw, 4, "quat_xyzw")
    with np.errstate(over="ignore"):  # an infinite length is refused
        length = float(np.linalg.norm((x, y, z, w)))
    if not abs(length - 1.0) <= ROTATION:
        raise BadPose(
            f"the quaternion {[float(part) for part in (x, y, z, w)]} has length {length:.9g}",
            where="quat_xyzw",
            valid=f"length 1 within {ROTATION:g}, the scalar last",
        )
    x, y, z, w = x / length, y / length, z / length, w / length
    rotation = [
        [1 - 2 * (y * y + z * z), 2 * (x * y - z * w), 2 * (x * z + y * w)],
        [2 * (x * y + z * w), 1 - 2 * (x * x + z * z), 2 * (y * z - x * w)],
        [2 * (x * z - y * w), 2 * (y * z + x * w), 1 - 2 * (x * x + y * y)],
    ]
    return _pose(np.array(rotation), xyz)


def pose_from_rpy(xyz: Sequence[float], rpy: Sequence[float]) -> np.ndarray:
    """The (4, 4) pose that turns by roll, pitch, yaw [rad] about the fixed axes x, y, z and moves by `xyz` [m].

    Raises:
        BadShape, NotFinite: not three finite numbers each.

    Exactness: entries are right to a few roundings; pi/2 as a float is not a right angle (cosine 6e-17).
    Source: URDF specification, element `origin`: R = Rz(yaw) Ry(pitch) Rx(roll).
    """
    roll, pitch, yaw = _numbers(rpy, 3, "rpy")
    (sr, sp, sy), (cr, cp, cy) = np.sin((roll, pitch, yaw)), np.cos((roll, pitch, yaw))
    rotation = [
        [cy * cp, cy * sp * sr - sy * cr, cy * sp * cr + sy * sr],
        [sy * cp, sy * sp * sr + cy * cr, sy * sp * cr - cy * sr],
        [-sp, cp * sr, cp * cr],
    ]
    return _pose(np.array(rotation), xyz)


def rpy_from_pose(pose: np.ndarray) -> tuple[float, float, float]:
    """The angles [rad] of a pose (4, 4) as `pose_from_rpy` takes them; pitch is within a quarter turn, and roll 0
    where pitch is one.
    """
    turn = pose[:3, :3].tolist()
    level = math.hypot(turn[0][0], turn[1][0])
    roll, yaw = math.atan2(turn[2][1], turn[2][2]), math.atan2(turn[1][0], turn[0][0])
    if level < 1e-12:
        roll, yaw = 0.0, math.atan2(-turn[0][1], turn[1][1])
    return roll, math.atan2(-turn[2][0], level), yaw


def pose_from_rotation_vector(xyz: Sequence[float], vector: Sequence[float]) -> np.ndarray:
    """The (4, 4) pose that turns about a vector by its length [rad] and then moves by `xyz` [m].

    Raises:
        BadShape, NotFinite: not three finite numbers each. BadPose: more than 1,000 rad.
    """
    turn = _numbers(vector, 3, "rotation vector")
    with np.errstate(over="ignore"):
        angle = float(np.linalg.norm(turn))
    if not angle <= 1e3:
        raise BadPose(f"a turn by {angle:.3g} rad", where="rotation vector", valid="1000 or less")
    axis = turn / angle if angle > 0.0 else turn
    return pose_from_quaternion(xyz, [*(np.sin(0.5 * angle) * axis), np.cos(0.5 * angle)])


def inverse(pose: np.ndarray) -> np.ndarray:
    """The (..., 4, 4) poses that undo the given ones: `body_from_world` of `world_from_body`.

    Exactness: the rotation is transposed, which is exact for an exact rotation; a rotation that is off
    orthonormal by e gives an inverse that is off by e.
    """
    pose = np.asarray(pose, dtype=np.float64)
    undone = np.zeros_like(pose)
    rotation = np.swapaxes(pose[..., :3, :3], -1, -2)
    undone[..., :3, :3] = rotation
    undone[..., :3, 3] = -np.einsum("...ij,...j->...i", rotation, pose[..., :3, 3])
    undone[..., 3, 3] = 1.0
    return undone


def validated_pose(pose: np.ndarray) -> np.ndarray:
    """The given pose as a C-ordered float64 (4, 4) array, unchanged in value, if it is a rigid motion.

    Raises:
        BadPose: the rotation part is not orthonormal within `tolerance.ROTATION`, is a reflection, or the
            last row is not 0 0 0 1. BadShape, NotFinite: not sixteen finite numbers.
    """
    try:
        matrix = np.ascontiguousarray(pose, dtype=np.float64)
    except (TypeError, ValueError):
        raise BadShape(f"the pose is {pose!r:.60}", valid="a (4, 4) array of numbers") from None
    if matrix.shape != (4, 4):
        raise BadShape(f"the pose has shape {matrix.shape}", valid="(4, 4) is needed")
    _require_rigid(matrix.tobytes())
    return matrix


@lru_cache(maxsize=256)  # a robot's base is needed for each of its motions
def _require_rigid(content: bytes) -> None:
    """Nothing, if the numbers of a (4, 4) array are a rigid motion."""
    matrix = np.frombuffer(content).reshape(4, 4)
    if not np.isfinite(matrix).all():
        raise NotFinite("the pose holds NaN or infinity", valid="finite numbers")
    if np.abs(matrix[:3, 3]).max() > LARGEST:
        reach = float(np.abs(matrix[:3, 3]).max())
        raise BadPose(f"the pose's origin is {reach:g} m away", valid=f"{LARGEST:g} m or less")
    if not np.array_equal(matrix[3], (0.0, 0.0, 0.0, 1.0)):
        raise BadPose(f"the pose's last row is {matrix[3].tolist()}", valid="0 0 0 1 is needed")
    rotation = matrix[:3, :3]
    with np.errstate(over="ignore", invalid="ignore"):
        off = float(np.abs(rotation.T @ rotation - np.eye(3)).max())
    if not off <= ROTATION:
        raise BadPose(
            f"the pose's rotation is off orthonormal by {off:.3g}", valid=f"{ROTATION:g} or less"
        )
    if np.linalg.det(rotation) < 0.0:
        raise BadPose("the pose's rotation is a reflection", valid="determinant +1 is needed")


def _pose(rotation: np.ndarray, xyz: Sequence[float]) -> np.ndarray:
    pose = np.eye(4)
    pose[:3, :3] = rotation
    pose[:3, 3] = _numbers(xyz, 3, "xyz")
    return pose


def _numbers(given: Sequence[float], n: int, field: str) -> np.ndarray:
    try:
        numbers = np.asarray(given, dtype=np.float64)
    except (TypeError, ValueError):
        raise BadShape(f"{given!r:.60} is not {n} numbers", where=field) from None
    if numbers.shape != (n,):
        raise BadShape(
            f"shape {numbers.shape} is given", where=field, valid=f"{n} numbers are needed"
        )
    if not np.isfinite(numbers).all():
        raise NotFinite(f"{numbers.tolist()}", where=field, valid=f"{n} finite numbers are needed")
    return numbers

"""Poses and quaternions of rotations: inverses, what is refused, and scipy's to the last bit."""

from __future__ import annotations

import itertools
import math

import numpy as np
import pytest
from hypothesis import assume, given
from hypothesis import strategies as st
from scipy.spatial.transform import Rotation

from clearance.errors import BadPose, BadShape, ClearanceError, NotFinite
from clearance.geometry.pose import (
    inverse,
    pose_from_quaternion,
    pose_from_rpy,
    rpy_from_pose,
    validated_pose,
)
from clearance.geometry.quaternions import quaternions_of

number = st.floats(-10, 10)
quaternions = st.lists(st.floats(-1, 1), min_size=4, max_size=4).map(np.array)


def test_a_quarter_turn_about_z_takes_x_to_y():
    h = np.sqrt(0.5)
    assert np.allclose(pose_from_quaternion([0, 0, 0], [0, 0, h, h])[:3, 0], [0, 1, 0], atol=1e-15)
    assert np.allclose(pose_from_rpy([0, 0, 0], [0, 0, np.pi / 2])[:3, 0], [0, 1, 0], atol=1e-15)


@given(number, number, number)
def test_rpy_is_yaw_after_pitch_after_roll(roll, pitch, yaw):
    def about(axis, angle):
        half = 0.5 * angle
        return pose_from_quaternion([0, 0, 0], [*(np.sin(half) * np.eye(3)[axis]), np.cos(half)])

    expected = about(2, yaw) @ about(1, pitch) @ about(0, roll)
    assert np.allclose(pose_from_rpy([0, 0, 0], [roll, pitch, yaw]), expected, atol=1e-14)


@given(quaternions, st.tuples(number, number, number))
def test_a_pose_is_rigid_and_undone_by_its_inverse(quaternion, xyz):
    assume(np.linalg.norm(quaternion) > 1e-3)
    pose = pose_from_quaternion(xyz, quaternion / np.linalg.norm(quaternion))
    assert validated_pose(pose) is pose
    assert np.allclose(pose[:3, :3].T @ pose[:3, :3], np.eye(3), atol=2e-15)
    assert np.allclose(inverse(pose) @ pose, np.eye(4), atol=1e-13)
    assert np.array_equal(inverse(np.stack([pose, pose]))[1], inverse(pose))


@pytest.mark.filterwarnings("error")  # a warning would be a second line
@pytest.mark.parametrize(
    ("make", "fault"),
    [
        (lambda: pose_from_quaternion([0, 0, 0], [0, 0, 0, 0]), BadPose),
        (lambda: pose_from_quaternion([0, 0, 0], [0, 0, 0, 1.00001]), BadPose),
        (lambda: pose_from_quaternion([0, 0, 0], [0, 0, 1]), BadShape),
        (lambda: pose_from_quaternion([0, 0, np.nan], [0, 0, 0, 1]), NotFinite),
        (lambda: pose_from_rpy([0, 0, 0], [0, np.inf, 0]), NotFinite),
        (lambda: validated_pose(np.eye(3)), BadShape),
        (lambda: validated_pose(np.eye(4) * np.nan), NotFinite),
        (lambda: validated_pose(np.diag([1.0, 1, -1, 1])), BadPose),
        (lambda: validated_pose(np.diag([1.0, 1, 1.001, 1])), BadPose),
        (lambda: validated_pose(np.diag([1e300, 1e300, 1e300, 1])), BadPose),
    ],
)
def test_refuses(make, fault):
    with pytest.raises(fault) as caught:
        make()
    assert isinstance(caught.value, ClearanceError)


_RANDOM = Rotation.random(2000, random_state=7).as_matrix()


def _products() -> np.ndarray:
    """Each turned on by the next: rounding has added up."""
    found = _RANDOM[:300].copy()
    for other in _RANDOM[300:320]:
        found = found @ other
    return found


def _half_turns() -> np.ndarray:
    axes = np.array([*itertools.product((-1.0, 0.0, 1.0), repeat=3)])
    axes = axes[np.abs(axes).any(axis=1)]
    axes /= np.linalg.norm(axes, axis=1)[:, None]
    return 2.0 * axes[:, :, None] * axes[:, None, :] - np.eye(3)


@pytest.mark.parametrize(
    "rotations",
    [
        _RANDOM,
        _products(),
        _half_turns(),
        Rotation.create_group("O").as_matrix().round(),
        Rotation.from_rotvec(1e-9 * _RANDOM[:, 0]).as_matrix(),
        np.eye(3)[None],
        np.empty((0, 3, 3)),
    ],
    ids=["any", "products", "half turns", "cube", "nearly none", "none", "no matrix"],
)
def test_they_are_those_of_scipy_to_the_last_bit(rotations):
    found = quaternions_of(rotations)
    expected = Rotation.from_matrix(rotations).as_quat(canonical=True) if len(rotations) else found
    assert found.tobytes() == np.ascontiguousarray(expected).tobytes()
    assert found.shape == (len(rotations), 4)


@pytest.mark.parametrize("pitch", [0.0, 0.4, -1.5, math.pi / 2, -math.pi / 2])
def test_the_angles_of_a_pose_make_it_again(pitch):
    pose = pose_from_rpy([1.0, 2.0, 3.0], [0.3, pitch, -2.0])
    again = pose_from_rpy([1.0, 2.0, 3.0], rpy_from_pose(pose))
    assert np.allclose(again, pose, atol=1e-12)

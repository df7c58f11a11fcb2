"""Quaternions of rotations: to the last bit those of scipy, for half turns and products with their rounding."""

import itertools

import numpy as np
import pytest
from scipy.spatial.transform import Rotation

from clearance.geometry.quaternions import quaternions_of

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

"""Unit quaternions: of rotation matrices and back, without importing scipy for it, and of rounded ones."""

from __future__ import annotations

import numpy as np

from clearance.tolerance import ROTATION, ROUNDED_ROTATION


def of_unit_length(quaternions: np.ndarray) -> tuple[np.ndarray, int]:
    """(n, 4) the quaternions, of which those rounded to three digits or so are made of length 1; and how many."""
    with np.errstate(over="ignore"):
        lengths = np.linalg.norm(quaternions, axis=1)
    off = np.abs(lengths - 1.0)
    rounded = (off > ROTATION) & (off <= ROUNDED_ROTATION)
    return quaternions / np.where(rounded, lengths, 1.0)[:, None], int(rounded.sum())


def yaw_pitch_roll(quaternions: np.ndarray) -> np.ndarray:
    """(n, 3) [rad] the angles about z, y and x, one after the other, of unit quaternions (n, 4) x, y, z, w.

    Exactness: to a few roundings; yaw and roll are lost where pitch is a quarter turn.
    """
    x, y, z, w = quaternions.T
    yaw = np.arctan2(2.0 * (x * y + w * z), 1.0 - 2.0 * (y * y + z * z))
    pitch = np.arcsin(np.clip(2.0 * (w * y - z * x), -1.0, 1.0))
    roll = np.arctan2(2.0 * (y * z + w * x), 1.0 - 2.0 * (x * x + y * y))
    return np.column_stack([yaw, pitch, roll])


def quaternions_of(rotations: np.ndarray) -> np.ndarray:
    """(n, 4) x, y, z, w of rotation matrices (n, 3, 3); of the two of each the one whose last part that is not 0,
    from w to x and then y and z, is positive.

    Exactness: to the last bit what scipy 1.17 gives for matrices that are rotations but for rounding.
    Source: Markley (2008), Unit quaternion from rotation matrix: of four ways the one that loses least.
    """
    diagonal = np.diagonal(rotations, axis1=1, axis2=2)
    trace = diagonal[:, 0] + diagonal[:, 1] + diagonal[:, 2]
    way = np.argmax(np.column_stack([diagonal, trace]), axis=1)
    found = np.empty((len(rotations), 4))
    for i in range(3):
        rows, j, k = way == i, (i + 1) % 3, (i + 2) % 3
        own = rotations[rows]
        found[rows, i] = 1.0 - trace[rows] + 2.0 * own[:, i, i]
        found[rows, j] = own[:, j, i] + own[:, i, j]
        found[rows, k] = own[:, k, i] + own[:, i, k]
        found[rows, 3] = own[:, k, j] - own[:, j, k]
    rows = way == 3
    own = rotations[rows]
    for i in range(3):
        j, k = (i + 1) % 3, (i + 2) % 3
        found[rows, i] = own[:, k, j] - own[:, j, k]
    found[rows, 3] = 1.0 + trace[rows]
    x, y, z, w = found.T
    found /= np.sqrt(x * x + y * y + z * z + w * w)[:, None]
    found[_is_negative(found)] *= -1.0
    return found


def rotations_of(quaternions: np.ndarray) -> np.ndarray:
    """(n, 3, 3) the rotations of quaternions (n, 4) x, y, z, w of length 1 but for rounding."""
    x, y, z, w = quaternions.T / np.linalg.norm(quaternions, axis=1)
    rows = [
        [1.0 - 2.0 * (y * y + z * z), 2.0 * (x * y - w * z), 2.0 * (x * z + w * y)],
        [2.0 * (x * y + w * z), 1.0 - 2.0 * (x * x + z * z), 2.0 * (y * z - w * x)],
        [2.0 * (x * z - w * y), 2.0 * (y * z + w * x), 1.0 - 2.0 * (x * x + y * y)],
    ]
    return np.moveaxis(np.array(rows), 2, 0)


def rotation_vector(rotation: np.ndarray) -> np.ndarray:
    """(3,) axis times angle [rad], at most pi, of a rotation (3, 3)."""
    x, y, z, w = quaternions_of(rotation[None])[0]
    sine = float(np.linalg.norm([x, y, z]))
    angle = 2.0 * np.arctan2(sine, w)
    return np.array([x, y, z]) * (2.0 if sine < 1e-12 else angle / sine)


def half_skew(matrices: np.ndarray) -> np.ndarray:
    """(..., 3) half the skew part of matrices (..., 3, 3): of a rotation, the sine of its angle times its axis."""
    pairs = [
        matrices[..., (k + 2) % 3, (k + 1) % 3] - matrices[..., (k + 1) % 3, (k + 2) % 3]
        for k in range(3)
    ]
    return 0.5 * np.stack(pairs, axis=-1)


def _is_negative(found: np.ndarray) -> np.ndarray:
    """(n,) True where the first of w, x, y, z that is not 0 is below it."""
    negative = np.zeros(len(found), dtype=bool)
    undecided = np.ones(len(found), dtype=bool)
    for i in (3, 0, 1, 2):
        negative |= undecided & (found[:, i] < 0.0)
        undecided &= found[:, i] == 0.0
    return negative

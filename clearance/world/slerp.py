"""Orientations between two orientations: a turn about one axis at constant speed, the shorter way round.

Orientations are quaternions (x, y, z, w) of length one to within rounding, the scalar last; q and -q are the same.
Every reader of a table takes the orientation between two rows from here, so that there is one answer
also where both ways round are equally long. Not for: quaternions as users give them (`geometry.pose`).
"""

from __future__ import annotations

import numpy as np


def slerp(before: np.ndarray, after: np.ndarray, share: np.ndarray | float) -> np.ndarray:
    """(..., 4) the orientations at a share (0 to 1) of the way from one to another.

    Args:
        before, after: (..., 4). share: (...,); all three are broadcast against each other.

    Exactness: `before` at 0 and `after` at 1, to the last bit; else right to a few roundings.
    Ties: half a turn goes the way of the signs as they are given, see `arcs_between`.
    Source: Shoemake 1985, in the form q exp(share log(q^-1 q')).
    """
    before, after = np.asarray(before, dtype=np.float64), np.asarray(after, dtype=np.float64)
    share = np.asarray(share, dtype=np.float64)[..., None]
    arcs = arcs_between(before, after)
    half = 0.5 * share * arcs[..., 3:]
    between = product(before, np.concatenate([np.sin(half) * arcs[..., :3], np.cos(half)], -1))
    return np.where(share == 0.0, before, np.where(share == 1.0, after, between))


def arcs_between(before: np.ndarray, after: np.ndarray) -> np.ndarray:
    """(..., 4) the turns from one orientation to another: a unit axis, and an angle from 0 to pi [rad].

    The axis is seen from the orientation before, and is z where the angle is 0.

    Exactness: the axis times the angle is right to 2^-47.
    Ties: where the quaternions are at a right angle both ways are half a turn; the way is that from `before` to
        `after` with the signs that they have.
    """
    before, after = np.broadcast_arrays(before, after)
    across = _across(before, after)
    dots = _dots(before, after)
    across = np.where(dots[..., None] < 0.0, -across, across)
    length = np.hypot(np.hypot(across[..., 0], across[..., 1]), across[..., 2])
    turns = (length > 0.0)[..., None]
    axes = np.where(turns, across, [0.0, 0.0, 1.0]) / np.where(turns, length[..., None], 1.0)
    return np.concatenate([axes, 2.0 * np.arctan2(length, np.abs(dots))[..., None]], axis=-1)


def aligned(quaternions: np.ndarray) -> np.ndarray:
    """(n, 4) the same orientations with signs that make neighbours nearest; the first keeps its own.

    Aligned quaternions stay as they are. Ties: at a right angle the sign goes with that of the row before.
    """
    flips = np.where(_dots(quaternions[:-1], quaternions[1:]) < 0.0, -1.0, 1.0)
    return (
        quaternions * np.concatenate([np.ones(min(1, len(quaternions))), flips.cumprod()])[:, None]
    )


def _dots(p: np.ndarray, q: np.ndarray) -> np.ndarray:
    """(...,) scalar products, summed in this order everywhere: their signs decide the way round."""
    return (
        p[..., 0] * q[..., 0]
        + p[..., 1] * q[..., 1]
        + p[..., 2] * q[..., 2]
        + p[..., 3] * q[..., 3]
    )


def _across(p: np.ndarray, q: np.ndarray) -> np.ndarray:
    """(..., 3) the vector part of p^-1 q; 0 to the last bit where q is p or -p."""
    (px, py, pz, pw), (qx, qy, qz, qw) = np.moveaxis(p, -1, 0), np.moveaxis(q, -1, 0)
    return np.stack(
        [
            (pw * qx - px * qw) - (py * qz - pz * qy),
            (pw * qy - py * qw) - (pz * qx - px * qz),
            (pw * qz - pz * qw) - (px * qy - py * qx),
        ],
        axis=-1,
    )


def product(p: np.ndarray, q: np.ndarray) -> np.ndarray:
    """(..., 4) the quaternion p q: the turn q, then p."""
    (px, py, pz, pw), (qx, qy, qz, qw) = np.moveaxis(p, -1, 0), np.moveaxis(q, -1, 0)
    return np.stack(
        [
            pw * qx + px * qw + (py * qz - pz * qy),
            pw * qy + py * qw + (pz * qx - px * qz),
            pw * qz + pz * qw + (px * qy - py * qx),
            pw * qw - (px * qx + py * qy + pz * qz),
        ],
        axis=-1,
    )

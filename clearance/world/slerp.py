"""Rotation about one axis at constant speed between two unit quaternions. Not for: compiled poses
(`kernels.motion`).
"""

from __future__ import annotations

import numpy as np


def aligned(quaternions: np.ndarray) -> np.ndarray:
    """(n, 4) the same rotations, signs chosen so that each is nearest to the one before."""
    if len(quaternions) < 2:
        return quaternions
    flips = np.einsum("ij,ij->i", quaternions[1:], quaternions[:-1]) < 0.0
    signs = np.concatenate([[1.0], np.where(np.cumsum(flips) % 2, -1.0, 1.0)])
    return quaternions * signs[:, None]


def slerp(before: np.ndarray, after: np.ndarray, share: np.ndarray) -> np.ndarray:
    """(n, 4) the rotations at `share` (n,) of the way from (n, 4) to (n, 4), xyzw, by the shorter arc.

    Exactness: the ends are the given quaternions; between, to a few roundings. Source: Shoemake 1985.
    """
    dots = np.einsum("ij,ij->i", before, after)
    after = np.where(dots[:, None] < 0.0, -after, after)
    half = np.arctan2(
        np.linalg.norm(after - before, axis=1), np.linalg.norm(after + before, axis=1)
    )
    angle = 2.0 * half  # between the two as vectors, at most a right angle
    small = angle < 1e-8
    whole = np.where(small, 1.0, np.sin(angle))
    first = np.where(small, 1.0 - share, np.sin((1.0 - share) * angle) / whole)
    second = np.where(small, share, np.sin(share * angle) / whole)
    mixed = first[:, None] * before + second[:, None] * after
    return mixed / np.linalg.norm(mixed, axis=1)[:, None]

"""Triangle strips and fans, as several mesh formats have them, to triangles."""

from __future__ import annotations

import numpy as np


def strip(corners: np.ndarray) -> np.ndarray:
    """(n - 2, 3) the triangles of a strip of n corners; every other one is turned, so that all face one way."""
    triangles = (
        np.lib.stride_tricks.sliding_window_view(corners, 3).copy() if len(corners) > 2 else _none()
    )
    triangles[1::2] = triangles[1::2][:, [1, 0, 2]]
    return triangles


def fan(corners: np.ndarray) -> np.ndarray:
    """(n - 2, 3) the triangles of a fan of n corners about its first."""
    if len(corners) < 3:
        return _none()
    return np.stack([np.full(len(corners) - 2, corners[0]), corners[1:-1], corners[2:]], axis=1)


def _none() -> np.ndarray:
    return np.empty((0, 3), dtype=np.int64)

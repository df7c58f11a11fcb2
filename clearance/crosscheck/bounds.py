"""Lower bounds on the distance of two bodies by numpy alone, so that the peer may skip what cannot
win.

None of this shares code with our own pruning: world boxes from body boxes, and how far a body can
have moved since the peer last measured it.
"""

from __future__ import annotations

import numpy as np

_CORNERS = np.array([[i, j, k] for i in (0, 1) for j in (0, 1) for k in (0, 1)])


def box_corners(bounds: np.ndarray) -> np.ndarray:
    """(8, 3) corners [m] of a box given as (2, 3)."""
    return bounds[_CORNERS, np.arange(3)]


def world_boxes(bounds: np.ndarray, poses: np.ndarray) -> np.ndarray:
    """(n, 2, 3) [m] boxes along the world axes that hold a body box (2, 3) at poses (n, 4, 4)."""
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

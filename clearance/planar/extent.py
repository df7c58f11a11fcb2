"""The least box around a curve: its control polygons halved where they stand out. Not for: quick ones."""

from __future__ import annotations

import numpy as np

from clearance.kernels.curve.bezier import Pieces
from clearance.tolerance import LAST_BITS

HALVINGS = 60


def least_box(pieces: Pieces) -> np.ndarray:
    """(2, 2) lower and upper corner; the curve may stand out by LAST_BITS of its largest coordinate."""
    parts = _by_degree(pieces)
    return np.array([[-_farthest(parts, axis, -1.0) for axis in (0, 1)],
                     [_farthest(parts, axis, 1.0) for axis in (0, 1)]])  # fmt: skip


def _by_degree(pieces: Pieces) -> list[np.ndarray]:
    """Homogeneous control points (k, degree + 1, 3) of the pieces of each degree."""
    count = np.diff(pieces.first)
    return [
        pieces.control[pieces.first[:-1][count == n][:, None] + np.arange(n)]
        for n in np.unique(count)
    ]


def _farthest(parts: list[np.ndarray], axis: int, sign: float) -> float:
    """The greatest coordinate (times `sign`) of any of the curves, from above."""
    best = max(_coordinate(rows[:, [0, -1]], axis, sign).max() for rows in parts)
    return max(_farthest_of(rows, axis, sign, best) for rows in parts)


def _farthest_of(rows: np.ndarray, axis: int, sign: float, best: float) -> float:
    slack = LAST_BITS * float(np.abs(_coordinate(rows, axis, sign)).max())
    for _ in range(HALVINGS):
        rows = rows[_coordinate(rows, axis, sign).max(axis=1) > best + slack]
        if not len(rows):
            return best
        rows = np.concatenate(_halved(rows))
        best = max(best, _coordinate(rows[:, [0, -1]], axis, sign).max())
    return max(best, _coordinate(rows, axis, sign).max())


def _coordinate(rows: np.ndarray, axis: int, sign: float) -> np.ndarray:
    return sign * rows[:, :, axis] / rows[:, :, 2]


def _halved(rows: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Both halves of each control polygon, by de Casteljau at 1/2."""
    left, right, inner = np.empty_like(rows), np.empty_like(rows), rows
    for k in range(rows.shape[1]):
        left[:, k], right[:, -1 - k] = inner[:, 0], inner[:, -1]
        inner = 0.5 * (inner[:, :-1] + inner[:, 1:])
    return left, right

"""The distance of points from a body of boxes on a grid of whole numbers: all points, all walls, no rounding.

The body is some boxes that lie apart, each with or without a cavity, a box wholly inside it. Everything is an
integer, so that inside, on and outside are told apart exactly.
"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np


class GridBox(NamedTuple):
    """A box between two corners (3,), with the corners of its cavity if it has one."""

    low: np.ndarray
    high: np.ndarray
    cavity: tuple[np.ndarray, np.ndarray] | None


def distances_sq(points: np.ndarray, boxes: list[GridBox]) -> np.ndarray:
    """(n,) the squared distance of each point (n, 3) from the solid body; 0 in it and on it."""
    return np.min([_from_box(points, box) for box in boxes], axis=0)


def _from_box(points: np.ndarray, box: GridBox) -> np.ndarray:
    beyond = np.maximum(np.maximum(box.low - points, points - box.high), 0)
    found = (beyond * beyond).sum(axis=1)
    if box.cavity is not None:
        low, high = box.cavity
        to_wall = np.minimum(points - low, high - points).min(axis=1)
        found = np.where(to_wall > 0, to_wall * to_wall, found)
    return found

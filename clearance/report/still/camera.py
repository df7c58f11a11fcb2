"""From where a still is looked at: the page's camera (`replay.js`), so that picture and page agree.

Of 16 sides it takes the one from which fewest boxes hide the line, and the line, or in contact the way out, is
least foreshortened. Not for: drawing.
"""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np

from clearance.report.still.scene import Still, box_of

FIELD_OF_VIEW = math.radians(40.0)
"""From top to bottom."""

N_SIDES, LIFT = 16, 0.42
"""Sides that are tried, and how far above the target they are [rad]."""


@dataclass(frozen=True, eq=False)
class Camera:
    """A pinhole camera.

    Attributes:
        eye: (3,) [m]. axes: (3, 3) rows right, up and forward, in the world frame. near: [m] what is nearer is not
            seen.
    """

    eye: np.ndarray
    axes: np.ndarray
    near: float

    def seen_from_it(self, points: np.ndarray) -> np.ndarray:
        """(n, 3) [m] to the right, up and ahead, of (n, 3) points in the world."""
        return (points - self.eye) @ self.axes.T


def overview(still: Still) -> Camera:
    """All of the room."""
    distance = 0.5 * still.size / math.sin(0.5 * FIELD_OF_VIEW) * 0.8
    return _look(still, still.room.mean(axis=0), distance)


def at_gap(still: Still) -> Camera:
    """The line, from near."""
    length = float(np.linalg.norm(still.line[1] - still.line[0]))
    return _look(still, still.line.mean(axis=0), max(6.0 * length, still.size / 12.0))


def _look(still: Still, target: np.ndarray, distance: float) -> Camera:
    line = still.line[1] - still.line[0] if still.way_out is None else still.way_out[1]
    length = np.linalg.norm(line)
    line = line / length if length > 0.0 else line
    boxes = [
        box_of(still.shapes[body.i_shape][0].astype(np.float64), body.pose)
        for i, body in enumerate(still.bodies)
        if i not in still.nearest
    ]
    best, best_cost = target, math.inf
    for k in range(N_SIDES):
        turn = (k + 0.5) * 2.0 * math.pi / N_SIDES
        towards = np.array(
            [math.cos(turn) * math.cos(LIFT), math.sin(turn) * math.cos(LIFT), math.sin(LIFT)]
        )
        eye = target + distance * towards
        cost = _n_hiding(boxes, still.line.mean(axis=0), eye) + 0.8 * abs(float(towards @ line))
        if cost < best_cost - 1e-9:
            best, best_cost = eye, cost
    return _aimed(best, target, still.size / 2000.0)


def _aimed(eye: np.ndarray, target: np.ndarray, near: float) -> Camera:
    """A camera that is held upright."""
    forward = (target - eye) / np.linalg.norm(target - eye)
    right = np.cross(forward, [0.0, 0.0, 1.0])
    right /= np.linalg.norm(right)
    return Camera(eye, np.array([right, np.cross(right, forward), forward]), near)


def _n_hiding(boxes: list[np.ndarray], point: np.ndarray, eye: np.ndarray) -> int:
    """How many boxes stand between the eye and a point."""
    if not boxes:
        return 0
    way = eye - point
    with np.errstate(divide="ignore", invalid="ignore"):
        ends = (np.array(boxes) - point) / way
    first, last = np.nanmin(ends, axis=1).max(axis=1), np.nanmax(ends, axis=1).min(axis=1)
    hit = np.where(first >= 0.0, first, last)
    return int(((first <= last) & (last >= 0.0) & (hit < 1.0)).sum())

"""The Hausdorff distance where both curves are polylines: straight from the segments, no biarcs, no map.

Ten times as fast as the general method on long outlines, with the same meaning of every number. Not for: curves
with a curved piece.
"""

from __future__ import annotations

import math

import numpy as np

from clearance.kernels.hausdorff.polyline import directed_polyline
from clearance.kernels.hausdorff.segments import Segments
from clearance.kernels.hausdorff.state import (
    COMMON_NORMAL,
    END,
    SEARCH_STATE,
    SELF_BISECTOR,
    SearchGoal,
)
from clearance.planar.curve import Curve
from clearance.tolerance import MEETING, NORMAL, PARAMETER, TANGENT


def solve_polylines(
    a: Curve, b: Curve, shift: np.ndarray, aim: SearchGoal
) -> tuple[np.ndarray, np.ndarray]:
    """Both directed searches, (2,) SEARCH_STATE and witnesses (2, 5), as those of other curves."""
    states, points = np.zeros(2, SEARCH_STATE), np.empty((2, 5))
    for k, (one, two, step) in enumerate(((a, b, shift), (b, a, -shift))):
        directed_polyline(_segments(one), _segments(two), step[0], step[1], aim, states[k : k + 1])
        if states["lower"][k] > aim.limit:
            states["lower"][1 - k :] = states["lower"][k]
            break
        points[k] = _witness(one, two, step, states[k])
    return states, points


def _segments(curve: Curve) -> Segments:
    return Segments(curve.pieces.control, curve.segment_boxes)


def _witness(one: Curve, two: Curve, shift: np.ndarray, state: np.void) -> tuple[float, ...]:
    """The points that `state` names, each in its curve's frame, and the kind of solution."""
    i, j, t, s = (state[name].item() for name in ("piece_a", "piece_b", "at_a", "at_b"))
    (ax, ay), (bx, by) = _on(one, i, t), _on(two, j, s)
    gap = (ax + shift[0] - bx, ay + shift[1] - by)
    return ax, ay, bx, by, _kind((one, i, t), (two, j, s), gap)


def _kind(here: tuple[Curve, int, float], there: tuple[Curve, int, float], gap) -> float:
    """The kind of solution at a segment and parameter of each of two curves, at the distance `gap`."""
    if _is_corner(*here):
        return END
    dx, dy = _direction(*here[:2])
    if abs(gap[0] * dx + gap[1] * dy) > NORMAL * math.hypot(*gap):
        return SELF_BISECTOR
    return END if _is_corner(*there) else COMMON_NORMAL


def _on(curve: Curve, k: int, t: float) -> tuple[float, float]:
    (x0, y0, _), (x1, y1, _) = curve.pieces.control[2 * k : 2 * k + 2].tolist()
    return (1.0 - t) * x0 + t * x1, (1.0 - t) * y0 + t * y1


def _direction(curve: Curve, k: int) -> tuple[float, float]:
    (x0, y0), (x1, y1) = _on(curve, k, 0.0), _on(curve, k, 1.0)
    length = math.hypot(x1 - x0, y1 - y0)
    return (x1 - x0) / length, (y1 - y0) / length


def _is_corner(curve: Curve, k: int, t: float) -> bool:
    """Whether segment `k` has at `t` an end of its contour or a joint that is not smooth."""
    if PARAMETER < t < 1.0 - PARAMETER:
        return False
    step = 1 if t > 0.5 else -1
    head, tail = np.searchsorted(curve.contour, [curve.contour[k], curve.contour[k] + 1])
    other = int(head + (k + step - head) % (tail - head))
    end, start = _on(curve, k, float(step > 0)), _on(curve, other, float(step < 0))
    if math.dist(end, start) > MEETING * curve.size:
        return True
    (ux, uy), (vx, vy) = _direction(curve, k), _direction(curve, other)
    return abs(ux * vy - uy * vx) > TANGENT or ux * vx + uy * vy <= 0.0

"""Polylines, splines, Bézier curves and arcs as the pieces of a curve, their input checked.

Not for: curves made of curves (`joining`).
"""

from __future__ import annotations

import math

import numpy as np

from clearance.kernels.curve.bezier import HIGHEST_DEGREE, Pieces, pieces_of_spline
from clearance.planar.assembly import CurveFields, assembled, checked_size, origin_of
from clearance.planar.entries import (
    BadCurve,
    checked_knots,
    checked_points,
    checked_weights,
    sweep_of,
)
from clearance.tolerance import PARAMETER


def polyline_of(points: np.ndarray, closed: bool) -> CurveFields:
    """See `Curve.polyline`."""
    points = checked_points(points, "points", least=2)
    if closed and np.any(points[0] != points[-1]):
        points = np.concatenate([points, points[:1]])
    x, y = points.T
    box = np.array([[x.min(), y.min()], [x.max(), y.max()]])
    checked_size(box[1] - box[0])
    origin = origin_of(box)
    step = np.flatnonzero((x[1:] != x[:-1]) | (y[1:] != y[:-1]))
    n = len(step)
    control, limits = np.empty((n, 2, 3)), np.empty((n, 2))
    for end in range(2):
        control[:, end, 0] = x[step + end] - origin[0]
        control[:, end, 1] = y[step + end] - origin[1]
        limits[:, end] = step + end
    control[:, :, 2] = 1.0
    pieces = Pieces(control.reshape(-1, 3), 2 * np.arange(n + 1), np.zeros(n, bool))
    return CurveFields(pieces, origin, limits, np.zeros(n, np.int64))


def bspline_of(control, degree: int, knots, weights) -> CurveFields:
    """See `Curve.bspline`."""
    degree = _checked_degree(degree)
    control = checked_points(control, "control", least=degree + 1)
    weights = checked_weights(weights, len(control))
    knots = checked_knots(knots, len(control), degree)
    base = origin_of(control)
    weighted = np.column_stack([(control - base) * weights[:, None], weights])
    rows, limits = pieces_of_spline(weighted, knots, degree)
    rows[:, :2] /= rows[:, 2:]
    return assembled(rows, np.arange(len(limits) + 1) * (degree + 1), limits, base=base)


def bezier_of(control: np.ndarray, weights: np.ndarray | None) -> CurveFields:
    """See `Curve.bezier`."""
    control = checked_points(control, "control", least=2)
    _checked_degree(len(control) - 1)
    rows = np.empty((len(control), 3))
    rows[:, :2], rows[:, 2] = control, checked_weights(weights, len(control))
    return assembled(rows, np.array([0, len(control)]), np.array([[0.0, 1.0]]))


def arc_of(center, radius: float, start: float, end: float) -> CurveFields:
    """See `Curve.arc`."""
    center, radius, sweep = sweep_of(center, radius, start, end)
    n = max(1, math.ceil(abs(sweep) / (0.5 * math.pi) - PARAMETER))
    half = 0.5 * sweep / n
    angles = start + half * np.arange(2 * n + 1)
    turn = np.stack([np.cos(angles), np.sin(angles)], axis=1)
    turn[1::2] /= math.cos(half)
    if abs(sweep) == 2.0 * math.pi:
        turn[-1] = turn[0]
    rows = np.empty((3 * n, 3))
    for k in range(3):
        rows[k::3, :2] = radius * turn[k : 2 * n - 1 + k : 2]
        rows[k::3, 2] = math.cos(half) if k == 1 else 1.0
    low = np.arange(n) / n
    limits = np.stack([low, low + 1.0 / n], axis=1)
    return assembled(rows, np.arange(n + 1) * 3, limits, base=center)


def _checked_degree(degree: int) -> int:
    if not isinstance(degree, (int, np.integer)) or not 1 <= degree <= HIGHEST_DEGREE:
        raise BadCurve(
            f"degree {degree!r}", where="degree", valid=f"a whole number 1 to {HIGHEST_DEGREE}"
        )
    return int(degree)

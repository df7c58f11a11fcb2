"""Polylines, splines, Bézier curves and arcs as the pieces of a curve, their input checked."""

from __future__ import annotations

import math
from collections.abc import Sequence
from typing import TYPE_CHECKING

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

if TYPE_CHECKING:
    from numpy.typing import ArrayLike


def polyline_of(points: ArrayLike | Sequence[ArrayLike], closed: bool) -> CurveFields:
    """See `Curve.polyline`."""
    vertices = checked_points(points, "points", least=2)
    if closed and np.any(vertices[0] != vertices[-1]):
        vertices = np.concatenate([vertices, vertices[:1]])
    x, y = vertices.T
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


def bspline_of(
    control: ArrayLike, degree: int, knots: ArrayLike | None, weights: ArrayLike | None
) -> CurveFields:
    """See `Curve.bspline`."""
    degree = _checked_degree(degree)
    points = checked_points(control, "control", least=degree + 1)
    weight = checked_weights(weights, len(points))
    knot = checked_knots(knots, len(points), degree)
    base = origin_of(points)
    weighted = np.column_stack([(points - base) * weight[:, None], weight])
    rows, limits = pieces_of_spline(weighted, knot, degree)
    rows[:, :2] /= rows[:, 2:]
    return assembled(rows, np.arange(len(limits) + 1) * (degree + 1), limits, base=base)


def bezier_of(control: ArrayLike, weights: ArrayLike | None) -> CurveFields:
    """See `Curve.bezier`."""
    points = checked_points(control, "control", least=2)
    _checked_degree(len(points) - 1)
    rows = np.empty((len(points), 3))
    rows[:, :2], rows[:, 2] = points, checked_weights(weights, len(points))
    return assembled(rows, np.array([0, len(points)]), np.array([[0.0, 1.0]]))


def arc_of(center: ArrayLike, radius: float, start: float, end: float) -> CurveFields:
    """See `Curve.arc`."""
    middle, radius, sweep = sweep_of(center, radius, start, end)
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
    return assembled(rows, np.arange(n + 1) * 3, limits, base=middle)


def _checked_degree(degree: int) -> int:
    if not isinstance(degree, (int, np.integer)) or not 1 <= degree <= HIGHEST_DEGREE:
        raise BadCurve(
            f"degree {degree!r}", where="degree", valid=f"a whole number 1 to {HIGHEST_DEGREE}"
        )
    return int(degree)

"""Bézier pieces joined as in a curve: about an origin of their own, without pieces of no extent."""

from __future__ import annotations

import math
from typing import NamedTuple

import numpy as np

from clearance.kernels.curve.bezier import Pieces, piece_spans
from clearance.ordered import ascending
from clearance.planar.entries import BadCurve
from clearance.tolerance import CURVE_SIZES


class CurveFields(NamedTuple):
    """The fields of a curve; see `Curve`."""

    pieces: Pieces
    origin: np.ndarray
    limits: np.ndarray
    contour: np.ndarray


def origin_of(points: np.ndarray) -> np.ndarray:
    """About the middle of `points`, with so few digits that taking it off a coordinate is exact.

    A coordinate far larger than the extent is a multiple of its own last bit, and so is the difference;
    any other difference is rounded relative to the extent.
    """
    low, high = points.min(axis=0), points.max(axis=0)
    unit = 2.0 ** (math.frexp(float((high - low).max()) or 1.0)[1] - 5)
    return np.round((0.5 * low + 0.5 * high) / unit) * unit


def checked_size(extent: np.ndarray) -> float:
    """The diagonal of a curve's box (2,), refused where it is 0 or leaves the range of floats."""
    size = math.hypot(*extent)
    if size == 0.0:
        raise BadCurve("a curve of zero length", valid="at least two points that differ")
    least, most = CURVE_SIZES
    if not least < size < most:
        raise BadCurve(f"a curve of size {size:g}", valid=f"a size between {least:g} and {most:g}")
    return size


def assembled(rows, first, limits, contour=None, base=(0.0, 0.0)) -> CurveFields:
    """The curve of Cartesian control points about `base` with weights, `rows` (m, 3); pieces of no extent go."""
    first = np.ascontiguousarray(first, np.int64)
    contour = np.zeros(len(limits), np.int64) if contour is None else np.asarray(contour, np.int64)
    ascending(contour, strictly=False)
    low, high = piece_spans(rows, first)
    extent = (high[:, :2] > low[:, :2]).any(axis=1)
    size = checked_size((high.max(axis=0) - low.min(axis=0))[:2])
    degree = np.diff(first)
    if not extent.all():
        rows, limits, contour = rows[np.repeat(extent, degree)], limits[extent], contour[extent]
        low, high, degree = low[extent], high[extent], degree[extent]
        first = np.concatenate([[0], np.cumsum(degree)])
    rational = high[:, 2] > low[:, 2]
    origin = origin_of(np.stack([low.min(axis=0)[:2], high.max(axis=0)[:2]]))
    if np.any(base) and np.abs(origin).max() <= 2.0 * size:
        origin[:] = 0.0  # near enough, and `base` stays as exact as it was given
    weight = np.where(np.repeat(rational, degree), rows[:, 2], 1.0)
    control = np.empty((len(rows), 3))
    control[:, :2], control[:, 2] = (rows[:, :2] - origin) * weight[:, None], weight
    pieces = Pieces(control, first, np.ascontiguousarray(rational))
    return CurveFields(pieces, origin + base, np.ascontiguousarray(limits), contour)

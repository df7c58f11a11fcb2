"""The checks of what curves are made from: one clear line for each fault. Not for: the curves themselves."""

from __future__ import annotations

import math
from collections.abc import Sequence
from typing import TYPE_CHECKING

import numpy as np

from clearance.errors import BadInput, BadShape, NotFinite
from clearance.tolerance import PARAMETER, WEIGHTS

if TYPE_CHECKING:
    from numpy.typing import ArrayLike


class BadCurve(BadInput):
    """Control points, knots, weights or angles that make no curve."""


def checked_points(
    points: ArrayLike | Sequence[ArrayLike], where: str, *, least: int
) -> np.ndarray:
    """`points` as float64 (n, 2), n >= `least`, all finite."""
    array = _numbers(points, where, f"({least} or more, 2) numbers")
    if array.ndim != 2 or array.shape[1] != 2:
        raise BadShape(f"an array of shape {array.shape}", where=where, valid="shape (n, 2)")
    if len(array) < least:
        raise BadCurve(f"{len(array)} point(s)", where=where, valid=f"at least {least}")
    _finite(array, where)
    return array


def checked_weights(weights: ArrayLike | None, n: int) -> np.ndarray:
    """`weights` as float64 (n,), all positive, none more than WEIGHTS times another; ones where None."""
    if weights is None:
        return np.ones(n)
    array = _numbers(weights, "weights", f"{n} numbers")
    if array.shape != (n,):
        raise BadShape(f"an array of shape {array.shape}", where="weights", valid=f"shape ({n},)")
    _finite(array, "weights")
    if not (array > 0.0).all():
        k = int(np.argmin(array))
        raise BadCurve(
            f"weight {array[k]:g} at index {k}", where="weights", valid="positive weights"
        )
    if array.max() / WEIGHTS > array.min():
        raise BadCurve(
            f"weights from {array.min():g} to {array.max():g}",
            where="weights",
            valid=f"weights within {WEIGHTS:g} times of each other",
        )
    return array


def checked_knots(knots: ArrayLike | None, n: int, degree: int) -> np.ndarray:
    """`knots` as float64 (n + degree + 1,), non-decreasing, continuous inside; clamped uniform where None."""
    if knots is None:
        inner = np.linspace(0.0, 1.0, n - degree + 1)
        return np.concatenate([np.zeros(degree), inner, np.ones(degree)])
    array = _numbers(knots, "knots", f"{n + degree + 1} numbers")
    if array.shape != (n + degree + 1,):
        raise BadCurve(
            f"{array.size} knots for {n} control points of degree {degree}",
            where="knots",
            valid=f"{n + degree + 1}",
        )
    _finite(array, "knots")
    falls = np.flatnonzero(np.diff(array) < 0.0)
    if len(falls):
        k = int(falls[0])
        problem = f"knot {array[k + 1]:g} at index {k + 1} after {array[k]:g}"
        raise BadCurve(problem, where="knots", valid="knots that do not decrease")
    if not array[n] > array[degree]:
        raise BadCurve(
            f"an empty domain from {array[degree]:g} to {array[n]:g}",
            where="knots",
            valid="knots[degree] < knots[-degree - 1]",
        )
    inside = array[(array > array[degree]) & (array < array[n])]
    values, counts = np.unique(inside, return_counts=True)
    if len(counts) and counts.max() > degree:
        k = int(np.argmax(counts))
        raise BadCurve(
            f"knot {values[k]:g} {counts[k]} times, which tears the curve",
            where="knots",
            valid=f"inner knots at most {degree} times",
        )
    return array


def sweep_of(
    center: ArrayLike, radius: float, start: float, end: float
) -> tuple[np.ndarray, float, float]:
    """Centre (2,), radius and signed sweep [rad] of an arc."""
    middle = _numbers(center, "center", "two numbers")
    if middle.shape != (2,):
        raise BadShape(f"an array of shape {middle.shape}", where="center", valid="shape (2,)")
    numbers = _numbers([radius, start, end], "radius, start, end", "three numbers")
    _finite(np.concatenate([middle, numbers]), "center, radius, start, end")
    sweep = float(numbers[2] - numbers[1])
    if not numbers[0] > 0.0:
        raise BadCurve(f"radius {numbers[0]:g}", where="radius", valid="a positive number")
    if not 0.0 < abs(sweep) <= 2.0 * math.pi * (1.0 + PARAMETER):
        valid = "more than 0 and at most a full turn, 2 pi"
        raise BadCurve(f"a sweep of {sweep:g} rad", where="start, end", valid=valid)
    return middle, float(numbers[0]), math.copysign(min(abs(sweep), 2.0 * math.pi), sweep)


def checked_transform(matrix: ArrayLike) -> np.ndarray:
    """The upper two rows (2, 3) of an affine map that is not singular."""
    array = _numbers(matrix, "matrix", "(2, 3) or (3, 3) numbers")
    if array.shape not in ((2, 3), (3, 3)):
        raise BadShape(f"an array of shape {array.shape}", where="matrix", valid="(2, 3) or (3, 3)")
    _finite(array, "matrix")
    if array.shape == (3, 3) and array[2].tolist() != [0.0, 0.0, 1.0]:
        raise BadCurve(f"last row {array[2].tolist()}", where="matrix", valid="[0, 0, 1]")
    if np.linalg.det(array[:2, :2]) == 0.0:
        raise BadCurve("a singular matrix", where="matrix", valid="an invertible map")
    return array[:2]


def checked_number(value: float, where: str, *, least: float = -math.inf) -> float:
    """`value` as a finite float of at least `least`."""
    if type(value) is float and least <= value < math.inf:
        return value
    array = _numbers(value, where, "a number")
    if array.shape != ():
        raise BadShape(f"an array of shape {array.shape}", where=where, valid="one number")
    _finite(array, where)
    if array < least:
        raise BadCurve(f"{float(array):g}", where=where, valid=f"at least {least:g}")
    return float(array)


def _numbers(value: ArrayLike | Sequence[ArrayLike], where: str, valid: str) -> np.ndarray:
    try:
        array = np.array(value, dtype=np.float64, order="C")
    except (TypeError, ValueError):
        shown = repr(value)
        raise BadShape(
            f"{shown if len(shown) < 60 else type(value).__name__}", where=where, valid=valid
        ) from None
    return array


def _finite(array: np.ndarray, where: str) -> None:
    good = np.isfinite(array)
    if not good.all():
        index = tuple(int(k) for k in np.argwhere(~good)[0])
        place = f"{where}{list(index)}" if index else where
        raise NotFinite(f"{array[index]}", where=place, valid="finite numbers")

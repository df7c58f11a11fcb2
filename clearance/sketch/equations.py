"""The equations of a sketch: residuals and derivatives of every kind of constraint.

A sketch is one flat vector `x`: two numbers a point (x, y), two a line (direction theta and signed
offset d of n . p = d with the normal n = (-sin theta, cos theta)), one a circle (its radius; its
centre is a point). An equation names up to eight numbers, has up to four coefficients and a value.
Lengths [m], angles [rad]; every residual is a length except those of
angles, which are scaled by the caller.

A residual is written once: with `math` it takes the numbers of one equation, with `numpy` the columns of many.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np

Numbers = Sequence[Any]
"""The numbers that an equation names: floats, or arrays with one entry an equation."""

POINT_POINT, POINT_LINE, POINT_CIRCLE, LINE_CIRCLE, CIRCLE_CIRCLE, LINEAR = 1, 2, 3, 4, 5, 6
LENGTHS, MIDDLE_ON, ACROSS, RATIO, IN_LINE = 7, 8, 9, 10, 11


@dataclass(frozen=True)
class Equation:
    """A kind of equation.

    Attributes:
        says: in words of its numbers.
        width: how many numbers it names.
        residual: of (math or numpy, numbers, coefficients, value).
        slopes: the derivatives by every number, of (numbers, coefficients, value).
    """

    says: str
    width: int
    residual: Callable[[Any, Numbers, Numbers, Any], Any]
    slopes: Callable[[Numbers, Numbers, Any], list]


def _gap(m, x: Numbers) -> Any:
    """n . p - d of a point and a line."""
    return m.cos(x[2]) * x[1] - m.sin(x[2]) * x[0] - x[3]


def _gap_slopes(x: Numbers) -> list:
    s, c = np.sin(x[2]), np.cos(x[2])
    return [-s, c, -c * x[0] - s * x[1], -1.0]


def _span(m, x: Numbers, i: int = 0) -> Any:
    """The distance of the points in slots i..i + 3."""
    return m.hypot(x[i] - x[i + 2], x[i + 1] - x[i + 3])


def _span_slopes(x: Numbers, i: int = 0, factor: Any = 1.0) -> list:
    """The derivatives of the distance, times a factor; along x where the points are one."""
    dx, dy = x[i] - x[i + 2], x[i + 1] - x[i + 3]
    length = np.hypot(dx, dy)
    one = length == 0.0
    length = length + one
    ux, uy = factor * (dx + one) / length, factor * dy / length
    return [ux, uy, -ux, -uy]


def _linear(m, x: Numbers, c: Numbers, v: Any) -> Any:
    return c[0] * x[0] + c[1] * x[1] + c[2] * x[2] + c[3] * x[3] - v


def _middle(m, x: Numbers, c: Numbers, v: Any) -> Any:
    return 0.5 * (m.cos(x[4]) * (x[1] + x[3]) - m.sin(x[4]) * (x[0] + x[2])) - x[5]


def _middle_slopes(x: Numbers, c: Numbers, v: Any) -> list:
    s, k = 0.5 * np.sin(x[4]), 0.5 * np.cos(x[4])
    return [-s, k, -s, k, -k * (x[0] + x[2]) - s * (x[1] + x[3]), -1.0]


def _across(m, x: Numbers, c: Numbers, v: Any) -> Any:
    return m.cos(x[4]) * (x[2] - x[0]) + m.sin(x[4]) * (x[3] - x[1])


def _across_slopes(x: Numbers, c: Numbers, v: Any) -> list:
    s, k = np.sin(x[4]), np.cos(x[4])
    return [-k, -s, k, s, k * (x[3] - x[1]) - s * (x[2] - x[0])]


def _beside(m, x: Numbers, c: Numbers, v: Any) -> Any:
    wx, wy = x[4] - x[2], x[5] - x[3]
    qx, qy = x[0] - x[2], x[1] - x[3]
    length = m.hypot(wx, wy)
    one = length == 0.0  # the centres are one: the distance from it
    return (wx * qy - wy * qx + one * m.hypot(qx, qy)) / (length + one)


def _beside_slopes(x: Numbers, c: Numbers, v: Any) -> list:
    wx, wy = x[4] - x[2], x[5] - x[3]
    qx, qy = x[0] - x[2], x[1] - x[3]
    length = np.hypot(wx, wy)
    length = np.where(length == 0.0, np.inf, length)
    ux, uy = wx / length, wy / length
    f = ux * qy - uy * qx
    hx, hy = (qy - f * ux) / length, (-qx - f * uy) / length
    return [-uy, ux, uy - hx, -ux - hy, hx, hy]


EQUATIONS: dict[int, Equation] = {
    POINT_POINT: Equation(
        "|p - q| = value", 4,
        lambda m, x, c, v: _span(m, x) - v,
        lambda x, c, v: _span_slopes(x),
    ),
    POINT_LINE: Equation(
        "n . p - d = value", 4,
        lambda m, x, c, v: _gap(m, x) - v,
        lambda x, c, v: _gap_slopes(x),
    ),
    POINT_CIRCLE: Equation(
        "|p - c| - r = value", 5,
        lambda m, x, c, v: _span(m, x) - x[4] - v,
        lambda x, c, v: [*_span_slopes(x), -1.0],
    ),
    LINE_CIRCLE: Equation(
        "n . c - d - coef0 r = value", 5,
        lambda m, x, c, v: _gap(m, x) - c[0] * x[4] - v,
        lambda x, c, v: [*_gap_slopes(x), -c[0]],
    ),
    CIRCLE_CIRCLE: Equation(
        "|c1 - c2| - coef0 r1 - coef1 r2 = value", 6,
        lambda m, x, c, v: _span(m, x) - c[0] * x[4] - c[1] * x[5] - v,
        lambda x, c, v: [*_span_slopes(x), -c[0], -c[1]],
    ),
    LINEAR: Equation("sum of coef_k x_k = value", 4, _linear, lambda x, c, v: list(c)),
    LENGTHS: Equation(
        "|p - q| = value |u - w|", 8,
        lambda m, x, c, v: _span(m, x) - v * _span(m, x, 4),
        lambda x, c, v: [*_span_slopes(x), *_span_slopes(x, 4, -v)],
    ),
    MIDDLE_ON: Equation("n . (p + q) / 2 = d", 6, _middle, _middle_slopes),
    ACROSS: Equation("t . (q - p) = 0 with t the line's direction", 5, _across, _across_slopes),
    RATIO: Equation(
        "x0 = value x1", 2,
        lambda m, x, c, v: x[0] - v * x[1],
        lambda x, c, v: [1.0, -v],
    ),
    IN_LINE: Equation(
        "a point lies on the line through two centres: its distance from it is 0", 6,
        _beside, _beside_slopes,
    ),
}  # fmt: skip
"""Every kind of equation by its code."""


class Rows:
    """Some equations, block by block of one kind, each evaluated at once. They may be asked at several places."""

    def __init__(self, code, var, coef, value) -> None:
        self.m = code.size
        self._blocks = []
        for kind in np.unique(code).tolist():
            at = np.flatnonzero(code == kind)
            equation = EQUATIONS[kind]
            slots = np.maximum(var[at, : equation.width], 0).T.copy()
            self._blocks.append((equation, at, slots, coef[at].T, value[at]))
        self._whole = len(self._blocks) == 1

    def errors(self, x: np.ndarray) -> np.ndarray:
        """(..., m) the residuals at numbers (..., n)."""
        out = np.empty((*x.shape[:-1], self.m))
        for equation, at, slots, coef, value in self._blocks:
            numbers = [x[..., i] for i in slots]
            error = equation.residual(np, numbers, coef, value)
            if self._whole:
                return error
            out[..., at] = error
        return out

    def slopes(self, x: np.ndarray) -> np.ndarray:
        """(..., m, 8) the derivatives by slot at numbers (..., n)."""
        out = np.zeros((*x.shape[:-1], self.m, 8))
        for equation, at, slots, coef, value in self._blocks:
            numbers = [x[..., i] for i in slots]
            for k, slope in enumerate(equation.slopes(numbers, coef, value)):
                out[..., at, k] = slope
        return out

    def curvatures(self, x: np.ndarray) -> np.ndarray:
        """(m, 8, 8) the second derivatives by slots at numbers (n,).

        Central differences of the first; a number in two slots is moved in the first of them only, in both.
        """
        out = np.zeros((self.m, 8, 8))
        for equation, at, slots, coef, value in self._blocks:
            numbers = x[slots]
            for k in range(equation.width):
                same = slots == slots[k]
                fresh = ~same[:k].any(axis=0)
                h = 1e-6 * (1.0 + np.abs(numbers[k]))
                ahead = equation.slopes(list(numbers + same * h), coef, value)
                behind = equation.slopes(list(numbers - same * h), coef, value)
                for j, (a, b) in enumerate(zip(ahead, behind, strict=True)):
                    out[at, k, j] = fresh * (0.5 * (a - b) / h)
        return out


def residual_at(code: int, numbers: list[float], coef: Sequence[float], value: float) -> float:
    """The residual of one equation."""
    return EQUATIONS[code].residual(math, numbers, coef, value)


def residuals(code, var, coef, value, x) -> np.ndarray:
    """The residual (m,) of every equation at `x`."""
    return Rows(code, var, coef, value).errors(x)

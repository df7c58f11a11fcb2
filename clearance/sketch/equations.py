"""The equations of a sketch: residuals and derivatives of every kind of constraint.

A sketch is one flat vector `x`: two numbers a point (x, y), two a line (direction theta and signed
offset d of n . p = d with the normal n = (-sin theta, cos theta)), one a circle (its radius; its
centre is a point). An equation names up to eight of them, has up to four coefficients and a value. Lengths [m],
angles [rad]; every residual is a length except those of angles, which are scaled by the caller.

A kind of equation is a named tuple: of places in `x` where an equation is kept; of floats where one is
evaluated (with `math`), of columns where many of a kind are evaluated at once (with `numpy`).
"""

from __future__ import annotations

from typing import Any, NamedTuple

import numpy as np


class PointPoint(NamedTuple):
    """|p - q| = value"""

    px: Any
    py: Any
    qx: Any
    qy: Any

    def residual(self, m, coef, value) -> Any:
        return m.hypot(self.px - self.qx, self.py - self.qy) - value

    def slopes(self, coef, value) -> list:
        return _span_slopes(self.px - self.qx, self.py - self.qy)


class FromLine(NamedTuple):
    """n . p - d - coef0 r = value, with a radius r about p, or none"""

    px: Any
    py: Any
    theta: Any
    d: Any
    r: Any = -1

    def residual(self, m, coef, value) -> Any:
        gap = m.cos(self.theta) * self.py - m.sin(self.theta) * self.px - self.d
        return gap - coef[0] * self.r - value

    def slopes(self, coef, value) -> list:
        s, c = np.sin(self.theta), np.cos(self.theta)
        return [-s, c, -c * self.px - s * self.py, -1.0, -coef[0]]


class FromCircle(NamedTuple):
    """|p - c| - coef0 r - coef1 s = value, with the circle's radius r about c, and a radius s about p, or none"""

    px: Any
    py: Any
    cx: Any
    cy: Any
    r: Any
    s: Any = -1

    def residual(self, m, coef, value) -> Any:
        between = m.hypot(self.px - self.cx, self.py - self.cy)
        return between - coef[0] * self.r - coef[1] * self.s - value

    def slopes(self, coef, value) -> list:
        return [*_span_slopes(self.px - self.cx, self.py - self.cy), -coef[0], -coef[1]]


class Linear(NamedTuple):
    """coef0 a + coef1 b + coef2 c + coef3 d = value; the coefficients of missing numbers are 0"""

    a: Any
    b: Any = -1
    c: Any = -1
    d: Any = -1

    def residual(self, m, coef, value) -> Any:
        first = coef[0] * self.a + coef[1] * self.b
        return first + coef[2] * self.c + coef[3] * self.d - value

    def slopes(self, coef, value) -> list:
        return list(coef)


class Lengths(NamedTuple):
    """|p - q| = value |u - w|"""

    px: Any
    py: Any
    qx: Any
    qy: Any
    ux: Any
    uy: Any
    wx: Any
    wy: Any

    def residual(self, m, coef, value) -> Any:
        other = m.hypot(self.ux - self.wx, self.uy - self.wy)
        return m.hypot(self.px - self.qx, self.py - self.qy) - value * other

    def slopes(self, coef, value) -> list:
        first = _span_slopes(self.px - self.qx, self.py - self.qy)
        return [*first, *_span_slopes(self.ux - self.wx, self.uy - self.wy, -value)]


class MiddleOn(NamedTuple):
    """n . (p + q) / 2 = d"""

    px: Any
    py: Any
    qx: Any
    qy: Any
    theta: Any
    d: Any

    def residual(self, m, coef, value) -> Any:
        twice = m.cos(self.theta) * (self.py + self.qy) - m.sin(self.theta) * (self.px + self.qx)
        return 0.5 * twice - self.d

    def slopes(self, coef, value) -> list:
        s, c = 0.5 * np.sin(self.theta), 0.5 * np.cos(self.theta)
        return [-s, c, -s, c, -c * (self.px + self.qx) - s * (self.py + self.qy), -1.0]


class Across(NamedTuple):
    """t . (q - p) = 0 with t the line's direction"""

    px: Any
    py: Any
    qx: Any
    qy: Any
    theta: Any

    def residual(self, m, coef, value) -> Any:
        return m.cos(self.theta) * (self.qx - self.px) + m.sin(self.theta) * (self.qy - self.py)

    def slopes(self, coef, value) -> list:
        s, c = np.sin(self.theta), np.cos(self.theta)
        return [-c, -s, c, s, c * (self.qy - self.py) - s * (self.qx - self.px)]


class Ratio(NamedTuple):
    """a = value b"""

    a: Any
    b: Any

    def residual(self, m, coef, value) -> Any:
        return self.a - value * self.b

    def slopes(self, coef, value) -> list:
        return [1.0, -value]


class InLine(NamedTuple):
    """p lies on the line through the centres a and b: its distance from it (from them where they are one) is 0"""

    px: Any
    py: Any
    ax: Any
    ay: Any
    bx: Any
    by: Any

    def residual(self, m, coef, value) -> Any:
        wx, wy = self.bx - self.ax, self.by - self.ay
        qx, qy = self.px - self.ax, self.py - self.ay
        length = m.hypot(wx, wy)
        one = length == 0.0
        return (wx * qy - wy * qx + one * m.hypot(qx, qy)) / (length + one)

    def slopes(self, coef, value) -> list:
        wx, wy = self.bx - self.ax, self.by - self.ay
        qx, qy = self.px - self.ax, self.py - self.ay
        length = np.hypot(wx, wy)
        length = np.where(length == 0.0, np.inf, length)
        ux, uy = wx / length, wy / length
        f = ux * qy - uy * qx
        hx, hy = (qy - f * ux) / length, (-qx - f * uy) / length
        return [-uy, ux, uy - hx, -ux - hy, hx, hy]


def _span_slopes(dx, dy, factor: Any = 1.0) -> list:
    """The derivatives of |p - q|, times a factor, by p and q at p - q; along x where the points are one."""
    length = np.hypot(dx, dy)
    one = length == 0.0
    length = length + one
    ux, uy = factor * (dx + one) / length, factor * dy / length
    return [ux, uy, -ux, -uy]


KINDS: Any = (
    PointPoint, FromLine, FromCircle, Linear, Lengths, MiddleOn, Across, Ratio, InLine,
)  # fmt: skip
"""Every kind of equation; the place of a kind is its code in arrays."""

CODES: dict[type, int] = {kind: code for code, kind in enumerate(KINDS)}
"""The code of every kind."""

OF_LENGTH = (PointPoint, FromLine, FromCircle)
"""The kinds whose value is a length."""


def are(code: np.ndarray, *kinds: type) -> np.ndarray:
    """Marks the equations, by their codes, that are of some kinds."""
    return np.isin(code, [CODES[kind] for kind in kinds])


def places(kind: Any, var: np.ndarray) -> Any:
    """The numbers' places of equations of one kind, by name: columns (m,) of `var` (m, 8), or those of one row."""
    return kind(*var[..., : len(kind._fields)].T)


class Rows:
    """Some equations, block by block of one kind, each evaluated at once. They may be evaluated at several places.

    Args:
        code: (m,) the kinds. var: (m, 8) the places of their numbers, -1 pads.
        coef: (m, 4) coefficients. value: (m,) values.
    """

    def __init__(self, code, var, coef, value) -> None:
        self.m = code.size
        self._blocks = []
        for k in np.unique(code).tolist():
            kind, at = KINDS[k], np.flatnonzero(code == k)
            places = np.maximum(var[at, : len(kind._fields)], 0).T.copy()
            self._blocks.append((kind, at, places, coef[at].T, value[at]))

    def errors(self, x: np.ndarray) -> np.ndarray:
        """(..., m) the residuals at numbers (..., n)."""
        out = np.empty((*x.shape[:-1], self.m))
        for kind, at, places, coef, value in self._blocks:
            error = kind(*(x[..., i] for i in places)).residual(np, coef, value)
            if len(self._blocks) == 1:
                return error
            out[..., at] = error
        return out

    def slopes(self, x: np.ndarray) -> np.ndarray:
        """(..., m, 8) the derivatives by slot at numbers (..., n)."""
        out = np.zeros((*x.shape[:-1], self.m, 8))
        for kind, at, places, coef, value in self._blocks:
            slopes = kind(*(x[..., i] for i in places)).slopes(coef, value)
            for k, slope in enumerate(slopes):
                out[..., at, k] = slope
        return out

    def curvatures(self, x: np.ndarray) -> np.ndarray:
        """(m, 8, 8) the second derivatives by slots at numbers (n,).

        Central differences of the first; a number in two slots is moved in the first of them only, in both.
        """
        out = np.zeros((self.m, 8, 8))
        for kind, at, places, coef, value in self._blocks:
            numbers = x[places]
            for k in range(len(places)) if kind not in (Linear, Ratio) else ():
                same = places == places[k]
                fresh = ~same[:k].any(axis=0)
                h = 1e-6 * (1.0 + np.abs(numbers[k]))
                ahead = kind(*(numbers + same * h)).slopes(coef, value)
                behind = kind(*(numbers - same * h)).slopes(coef, value)
                for j, (a, b) in enumerate(zip(ahead, behind, strict=True)):
                    out[at, k, j] = fresh * (0.5 * (a - b) / h)
        return out

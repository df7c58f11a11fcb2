"""Loci of a point: what a condition leaves to it, a line n . p = c or a circle, and where two of them meet.

Two loci meet in at most two points; the one is taken that lies on the same side as in the sketch, so that no
branch ever flips. Not for: placing (`sketch.solve.place`).
"""

import math

from clearance.compile.jit import inline
from clearance.kernels.sketch.equations import (
    CIRCLE_CIRCLE,
    LENGTHS,
    LINE_CIRCLE,
    LINEAR,
    MIDDLE_ON,
    POINT_CIRCLE,
    POINT_LINE,
    POINT_POINT,
)

GRAZING = 4e-13
"""How far, relative to the squared lengths, two loci may miss each other and still count as
touching."""


@inline
def _unit_line(nx, ny, c):
    length = math.hypot(nx, ny)
    if length == 0.0:
        return 0, 0.0, 0.0, 0.0
    return 1, nx / length, ny / length, c / length


@inline
def _other(s, row, i, x):
    """The coordinates of the end of a point pair (slots 0..3) that is not point i."""
    k = 2 if s.var[row, 0] == i else 0
    return x[s.var[row, k]], x[s.var[row, k + 1]]


@inline
def _lengths_locus(s, row, i, x):
    """Where p may be for |p - q| = k |u - w| or |p - q| = k |p - w| (p at i, in either pair)."""
    k = s.value[row]
    first = s.var[row, 0] == i or s.var[row, 2] == i
    second = s.var[row, 4] == i or s.var[row, 6] == i
    at = 0 if first else 4
    if s.var[row, at] == i and s.var[row, at + 2] == i:
        return 0, 0.0, 0.0, 0.0
    j = at + 2 if s.var[row, at] == i else at
    qx, qy = x[s.var[row, j]], x[s.var[row, j + 1]]
    if not (first and second):
        o = 4 - at
        ax, ay = x[s.var[row, o]], x[s.var[row, o + 1]]
        bx, by = x[s.var[row, o + 2]], x[s.var[row, o + 3]]
        length = math.hypot(ax - bx, ay - by)
        return 2, qx, qy, (k * length if first else length / k)
    if s.var[row, 4] == i and s.var[row, 6] == i:
        return 0, 0.0, 0.0, 0.0
    j = 6 if s.var[row, 4] == i else 4
    wx, wy = x[s.var[row, j]], x[s.var[row, j + 1]]
    if k == 1.0:
        return _unit_line(wx - qx, wy - qy, 0.5 * (wx * wx + wy * wy - qx * qx - qy * qy))
    g = 1.0 - k * k
    radius = k * math.hypot(qx - wx, qy - wy) / abs(g)
    return 2, (qx - k * k * wx) / g, (qy - k * k * wy) / g, radius


@inline
def locus(s, row, i, x):
    """Where the point at variable i may lie for equation `row`: (1, nx, ny, c), (2, cx, cy, r) or
    (0, ...)."""
    code = s.code[row]
    v = s.value[row]
    if code == LINEAR:
        a, b, rest = 0.0, 0.0, v
        for k in range(4):
            j = s.var[row, k]
            if j == i:
                a += s.coef[row, k]
            elif j == i + 1:
                b += s.coef[row, k]
            elif j >= 0:
                rest -= s.coef[row, k] * x[j]
        return _unit_line(a, b, rest)
    if code == POINT_LINE or code == LINE_CIRCLE:
        theta = x[s.var[row, 2]]
        c = x[s.var[row, 3]] + v
        if code == LINE_CIRCLE:
            c += s.coef[row, 0] * x[s.var[row, 4]]
        return 1, -math.sin(theta), math.cos(theta), c
    if code == LENGTHS:
        return _lengths_locus(s, row, i, x)
    if s.var[row, 0] == s.var[row, 2]:
        return 0, 0.0, 0.0, 0.0
    qx, qy = _other(s, row, i, x)
    if code == POINT_POINT:
        return 2, qx, qy, v
    if code == POINT_CIRCLE:
        return 2, qx, qy, x[s.var[row, 4]] + v
    if code == CIRCLE_CIRCLE:
        r = s.coef[row, 0] * x[s.var[row, 4]] + s.coef[row, 1] * x[s.var[row, 5]] + v
        return 2, qx, qy, r
    theta = x[s.var[row, 4]]
    sin, cos = math.sin(theta), math.cos(theta)
    if code == MIDDLE_ON:
        return 1, -sin, cos, 2.0 * x[s.var[row, 5]] + sin * qx - cos * qy
    return 1, cos, sin, cos * qx + sin * qy


@inline
def nearest_on(kind, a, b, c, px, py):
    """The nearest point of a locus to p, and whether there is one."""
    if kind == 1:
        gap = a * px + b * py - c
        return True, px - gap * a, py - gap * b
    dx, dy = px - a, py - b
    length = math.hypot(dx, dy)
    if length == 0.0:
        return c >= 0.0, a + c, b
    return c >= 0.0, a + c * dx / length, b + c * dy / length


@inline
def root_of(square, scale):
    """The square root, 0 for a negative number within rounding of `scale`, -1 otherwise."""
    if square >= 0.0:
        return math.sqrt(square)
    return 0.0 if square >= -GRAZING * scale else -1.0


@inline
def _side(value, plus, minus):
    """Which of two solutions: the sketch's side, or the nearer one when the sketch lies on the
    border."""
    if value == 0.0:
        return 1.0 if plus <= minus else -1.0
    return 1.0 if value > 0.0 else -1.0


@inline
def meet(k1, a1, b1, c1, k2, a2, b2, c2, sketch1, sketch2, px, py, turned):
    """The common point of two loci on the sketch's side (`turned` 1) or the other (-1). p: the point
    in the sketch."""
    if k1 == 1 and k2 == 1:
        det = a1 * b2 - a2 * b1
        if abs(det) < 1e-12:
            return False, 0.0, 0.0
        return True, (c1 * b2 - c2 * b1) / det, (a1 * c2 - a2 * c1) / det
    if k1 == 2 and k2 == 2:
        dx, dy = a2 - a1, b2 - b1
        d = math.hypot(dx, dy)
        if d == 0.0 or c1 < 0.0 or c2 < 0.0:
            return False, 0.0, 0.0
        along = 0.5 * (d + (c1 - c2) * (c1 + c2) / d)
        h = root_of((c1 - along) * (c1 + along), c1 * c1 + d * d)
        ux, uy = dx / d, dy / d
        fx, fy = a1 + along * ux, b1 + along * uy
        tx, ty = -uy, ux
        ox, oy = sketch1[1], sketch1[2]
        sx, sy = sketch2[1] - ox, sketch2[2] - oy
        side = sx * (py - oy) - sy * (px - ox)
    else:
        if k1 == 2:
            k1, a1, b1, c1, k2, a2, b2, c2 = k2, a2, b2, c2, k1, a1, b1, c1
            sketch1, sketch2 = sketch2, sketch1
        if c2 < 0.0:
            return False, 0.0, 0.0
        gap = a1 * a2 + b1 * b2 - c1
        h = root_of((c2 - gap) * (c2 + gap), c2 * c2)
        fx, fy = a2 - gap * a1, b2 - gap * b1
        tx, ty = -b1, a1
        side = -sketch1[2] * (px - sketch2[1]) + sketch1[1] * (py - sketch2[2])
    if h < 0.0:
        return False, 0.0, 0.0
    plus = (fx + h * tx - px) ** 2 + (fy + h * ty - py) ** 2
    minus = (fx - h * tx - px) ** 2 + (fy - h * ty - py) ** 2
    h *= turned * _side(side, plus, minus)
    return True, fx + h * tx, fy + h * ty

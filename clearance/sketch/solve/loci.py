"""Loci of a point: what a condition leaves to it, a line n . p = c or a circle, and where two of them meet.

Two loci meet in at most two points; the one is taken that lies on the same side as in the sketch, so that no
branch ever flips. Not for: placing (`sketch.solve.place`).
"""

from __future__ import annotations

import math
from typing import NamedTuple

from clearance.sketch.equations import (
    CIRCLE_CIRCLE,
    LENGTHS,
    LINE_CIRCLE,
    LINEAR,
    MIDDLE_ON,
    POINT_CIRCLE,
    POINT_LINE,
    POINT_POINT,
)
from clearance.sketch.solve.system import PlainSystem

GRAZING = 4e-13
"""How far, relative to the squared lengths, two loci may miss each other and still count as touching."""


class Locus(NamedTuple):
    """Where a point may lie: on the line a x + b y = c with unit normal (kind 1), or on the circle
    about (a, b) of radius c (2). Kind 0 is neither: the equation does not place the point."""

    kind: int
    a: float
    b: float
    c: float


NO_LOCUS = Locus(0, 0.0, 0.0, 0.0)


def _unit_line(nx: float, ny: float, c: float) -> Locus:
    length = math.hypot(nx, ny)
    if length == 0.0:
        return NO_LOCUS
    return Locus(1, nx / length, ny / length, c / length)


def _other(s: PlainSystem, row: int, i: int, x: list[float]) -> tuple[float, float]:
    """The coordinates of the end of a point pair (slots 0..3) that is not point i."""
    k = 2 if s.var[row][0] == i else 0
    return x[s.var[row][k]], x[s.var[row][k + 1]]


def _lengths_locus(s: PlainSystem, row: int, i: int, x: list[float]) -> Locus:
    """Where p may be for |p - q| = k |u - w| or |p - q| = k |p - w| (p at i, in either pair)."""
    k = s.value[row]
    first = s.var[row][0] == i or s.var[row][2] == i
    second = s.var[row][4] == i or s.var[row][6] == i
    at = 0 if first else 4
    if s.var[row][at] == i and s.var[row][at + 2] == i:
        return NO_LOCUS
    j = at + 2 if s.var[row][at] == i else at
    qx, qy = x[s.var[row][j]], x[s.var[row][j + 1]]
    if not (first and second):
        o = 4 - at
        ax, ay = x[s.var[row][o]], x[s.var[row][o + 1]]
        bx, by = x[s.var[row][o + 2]], x[s.var[row][o + 3]]
        length = math.hypot(ax - bx, ay - by)
        return Locus(2, qx, qy, (k * length if first else length / k))
    if s.var[row][4] == i and s.var[row][6] == i:
        return NO_LOCUS
    j = 6 if s.var[row][4] == i else 4
    wx, wy = x[s.var[row][j]], x[s.var[row][j + 1]]
    if k == 1.0:
        return _unit_line(wx - qx, wy - qy, 0.5 * (wx * wx + wy * wy - qx * qx - qy * qy))
    g = 1.0 - k * k
    radius = k * math.hypot(qx - wx, qy - wy) / abs(g)
    return Locus(2, (qx - k * k * wx) / g, (qy - k * k * wy) / g, radius)


def locus(s: PlainSystem, row: int, i: int, x: list[float]) -> Locus:
    """Where the point at variable i may lie for equation `row`."""
    code = s.code[row]
    v = s.value[row]
    if code == LINEAR:
        a, b, rest = 0.0, 0.0, v
        for k in range(4):
            j = s.var[row][k]
            if j == i:
                a += s.coef[row][k]
            elif j == i + 1:
                b += s.coef[row][k]
            elif j >= 0:
                rest -= s.coef[row][k] * x[j]
        return _unit_line(a, b, rest)
    if code == POINT_LINE or code == LINE_CIRCLE:
        theta = x[s.var[row][2]]
        c = x[s.var[row][3]] + v
        if code == LINE_CIRCLE:
            c += s.coef[row][0] * x[s.var[row][4]]
        return Locus(1, -math.sin(theta), math.cos(theta), c)
    if code == LENGTHS:
        return _lengths_locus(s, row, i, x)
    if s.var[row][0] == s.var[row][2]:
        return NO_LOCUS
    qx, qy = _other(s, row, i, x)
    if code == POINT_POINT:
        return Locus(2, qx, qy, v)
    if code == POINT_CIRCLE:
        return Locus(2, qx, qy, x[s.var[row][4]] + v)
    if code == CIRCLE_CIRCLE:
        r = s.coef[row][0] * x[s.var[row][4]] + s.coef[row][1] * x[s.var[row][5]] + v
        return Locus(2, qx, qy, r)
    theta = x[s.var[row][4]]
    sin, cos = math.sin(theta), math.cos(theta)
    if code == MIDDLE_ON:
        return Locus(1, -sin, cos, 2.0 * x[s.var[row][5]] + sin * qx - cos * qy)
    return Locus(1, cos, sin, cos * qx + sin * qy)


def nearest_on(locus: Locus, px: float, py: float) -> tuple[bool, float, float]:
    """Whether there is a nearest point of a line or circle to p, and that point."""
    a, b, c = locus.a, locus.b, locus.c
    if locus.kind == 1:
        gap = a * px + b * py - c
        return True, px - gap * a, py - gap * b
    dx, dy = px - a, py - b
    length = math.hypot(dx, dy)
    if length == 0.0:
        return c >= 0.0, a + c, b
    return c >= 0.0, a + c * dx / length, b + c * dy / length


def root_of(square: float, scale: float) -> float:
    """The square root, 0 for a negative number within rounding of `scale`, -1 otherwise."""
    if square >= 0.0:
        return math.sqrt(square)
    return 0.0 if square >= -GRAZING * scale else -1.0


def _side(value: float, plus: float, minus: float) -> float:
    """Which of two solutions: the sketch's side, or the nearer one when the sketch lies on the
    border."""
    if value == 0.0:
        return 1.0 if plus <= minus else -1.0
    return 1.0 if value > 0.0 else -1.0


def _two_lines(first: Locus, second: Locus) -> tuple[bool, float, float]:
    """Whether two lines meet, and where."""
    det = first.a * second.b - second.a * first.b
    if abs(det) < 1e-12:
        return False, 0.0, 0.0
    x = (first.c * second.b - second.c * first.b) / det
    return True, x, (first.a * second.c - second.a * first.c) / det


class CommonChord(NamedTuple):
    """The two common points f + h t and f - h t of two loci, and the side of the drawn point.

    Attributes:
        fx, fy: [m] the foot. tx, ty: the unit vector along. h: [m] half the length, -1 where there are none.
        side: above 0 where the point in the sketch lies towards t.
    """

    fx: float
    fy: float
    tx: float
    ty: float
    h: float
    side: float


NO_CHORD = CommonChord(0.0, 0.0, 0.0, 0.0, -1.0, 0.0)


def _two_circles(first, second, drawn_first, drawn_second, px, py):
    """The common chord of two circles."""
    dx, dy = second.a - first.a, second.b - first.b
    d = math.hypot(dx, dy)
    if d == 0.0 or first.c < 0.0 or second.c < 0.0:
        return NO_CHORD
    along = 0.5 * (d + (first.c - second.c) * (first.c + second.c) / d)
    h = root_of((first.c - along) * (first.c + along), first.c * first.c + d * d)
    ux, uy = dx / d, dy / d
    ox, oy = drawn_first.a, drawn_first.b
    sx, sy = drawn_second.a - ox, drawn_second.b - oy
    side = sx * (py - oy) - sy * (px - ox)
    return CommonChord(first.a + along * ux, first.b + along * uy, -uy, ux, h, side)


def _line_and_circle(line, circle, drawn_line, drawn_circle, px, py):
    """The chord that a line cuts off a circle."""
    if circle.c < 0.0:
        return NO_CHORD
    gap = line.a * circle.a + line.b * circle.b - line.c
    h = root_of((circle.c - gap) * (circle.c + gap), circle.c * circle.c)
    side = -drawn_line.b * (px - drawn_circle.a) + drawn_line.a * (py - drawn_circle.b)
    return CommonChord(circle.a - gap * line.a, circle.b - gap * line.b, -line.b, line.a, h, side)


def meet(first, second, drawn_first, drawn_second, px, py, turned):
    """Whether two loci meet, and their common point on the sketch's side (`turned` 1) or the other (-1).

    `drawn_first` and `drawn_second` are the same loci in the sketch, p the point there.
    """
    if first.kind == 1 and second.kind == 1:
        return _two_lines(first, second)
    if first.kind == 2 and second.kind == 2:
        chord = _two_circles(first, second, drawn_first, drawn_second, px, py)
    elif first.kind == 2:
        chord = _line_and_circle(second, first, drawn_second, drawn_first, px, py)
    else:
        chord = _line_and_circle(first, second, drawn_first, drawn_second, px, py)
    fx, fy, tx, ty, h = chord.fx, chord.fy, chord.tx, chord.ty, chord.h
    if h < 0.0:
        return False, 0.0, 0.0
    plus = (fx + h * tx - px) ** 2 + (fy + h * ty - py) ** 2
    minus = (fx - h * tx - px) ** 2 + (fy - h * ty - py) ** 2
    h *= turned * _side(chord.side, plus, minus)
    return True, fx + h * tx, fy + h * ty

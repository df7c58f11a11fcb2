"""Ruler and compass: one vertex (or a line, or a circle) placed in closed form from what already
stands.

A condition on a point is a locus, a line n . p = c or a circle; two loci meet in at most two
points, and the one is taken that lies on the same side as in the sketch, so that no branch ever
flips. Where a condition is missing the sketch is moved least (the paper's assumptions): the nearest
point of a locus, a line's old direction.
"""

import math
from typing import NamedTuple

import numpy as np

from clearance.jit import inlined
from clearance.kernels.sketch_equations import (
    ACROSS,
    CIRCLE_CIRCLE,
    LENGTHS,
    LINE_CIRCLE,
    LINEAR,
    MIDDLE_ON,
    POINT_CIRCLE,
    POINT_LINE,
    POINT_POINT,
    evaluate,
)
from clearance.kernels.sketch_graph import POINT, SIZE, SLIDE, TURN

GRAZING = 4e-13
"""How far, relative to the squared lengths, two loci may miss each other and still count as
touching."""


class System(NamedTuple):
    """Equations and graph as flat arrays; `member` lists the merged variables of a vertex."""

    code: np.ndarray
    var: np.ndarray
    coef: np.ndarray
    value: np.ndarray
    kind: np.ndarray
    root: np.ndarray
    parent: np.ndarray
    scale: np.ndarray
    shift: np.ndarray
    member_start: np.ndarray
    member: np.ndarray
    vertex_of: np.ndarray
    ends: np.ndarray


@inlined
def assign(s, v, number, x):
    """Sets a class of directions, offsets or radii: its root and every merged variable."""
    for at in range(s.member_start[v], s.member_start[v + 1]):
        i = s.member[at]
        x[i] = s.scale[i] * number + s.shift[i]


@inlined
def _unit_line(nx, ny, c):
    length = math.hypot(nx, ny)
    if length == 0.0:
        return 0, 0.0, 0.0, 0.0
    return 1, nx / length, ny / length, c / length


@inlined
def _other(s, row, i, x):
    """The coordinates of the end of a point pair (slots 0..3) that is not point i."""
    k = 2 if s.var[row, 0] == i else 0
    return x[s.var[row, k]], x[s.var[row, k + 1]]


@inlined
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


@inlined
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


@inlined
def _nearest_on(kind, a, b, c, px, py):
    """The nearest point of a locus to p, and whether there is one."""
    if kind == 1:
        gap = a * px + b * py - c
        return True, px - gap * a, py - gap * b
    dx, dy = px - a, py - b
    length = math.hypot(dx, dy)
    if length == 0.0:
        return c >= 0.0, a + c, b
    return c >= 0.0, a + c * dx / length, b + c * dy / length


@inlined
def _root_of(square, scale):
    """The square root, 0 for a negative number within rounding of `scale`, -1 otherwise."""
    if square >= 0.0:
        return math.sqrt(square)
    return 0.0 if square >= -GRAZING * scale else -1.0


@inlined
def _side(value, plus, minus):
    """Which of two solutions: the sketch's side, or the nearer one when the sketch lies on the
    border."""
    if value == 0.0:
        return 1.0 if plus <= minus else -1.0
    return 1.0 if value > 0.0 else -1.0


@inlined
def _meet(k1, a1, b1, c1, k2, a2, b2, c2, sketch1, sketch2, px, py, turned):
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
        h = _root_of((c1 - along) * (c1 + along), c1 * c1 + d * d)
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
        h = _root_of((c2 - gap) * (c2 + gap), c2 * c2)
        fx, fy = a2 - gap * a1, b2 - gap * b1
        tx, ty = -b1, a1
        side = -sketch1[2] * (px - sketch2[1]) + sketch1[1] * (py - sketch2[2])
    if h < 0.0:
        return False, 0.0, 0.0
    plus = (fx + h * tx - px) ** 2 + (fy + h * ty - py) ** 2
    minus = (fx - h * tx - px) ** 2 + (fy - h * ty - py) ** 2
    h *= turned * _side(side, plus, minus)
    return True, fx + h * tx, fy + h * ty


@inlined
def _place_point(s, v, rows, count, x, sketch, turned):
    i = s.root[v]
    px, py = sketch[i], sketch[i + 1]
    if count == 0:
        x[i], x[i + 1] = px, py
        return True
    k1, a1, b1, c1 = locus(s, rows[0], i, x)
    if k1 == 0:
        return False
    if count == 1:
        good, x[i], x[i + 1] = _nearest_on(k1, a1, b1, c1, px, py)
        return good
    k2, a2, b2, c2 = locus(s, rows[1], i, x)
    if k2 == 0:
        return False
    first = locus(s, rows[0], i, sketch)
    second = locus(s, rows[1], i, sketch)
    good, mx, my = _meet(k1, a1, b1, c1, k2, a2, b2, c2, first, second, px, py, turned)
    if good:
        x[i], x[i + 1] = mx, my
    return good


@inlined
def _place_number(s, v, row, x, gradient):
    """Places an offset or a radius, in which every equation is linear; a radius must not be
    negative."""
    assign(s, v, 0.0, x)
    f0 = evaluate(s.code, s.var, s.coef, s.value, x, row, gradient)
    assign(s, v, 1.0, x)
    slope = evaluate(s.code, s.var, s.coef, s.value, x, row, gradient) - f0
    if abs(slope) < 1e-12:
        return False
    number = -f0 / slope
    assign(s, v, number, x)
    if s.kind[v] == SIZE:
        for at in range(s.member_start[v], s.member_start[v + 1]):
            if x[s.member[at]] < 0.0:
                return False
    return True


@inlined
def _line_condition(s, row, own, x):
    """(1, px, py, w) for n . p - d = w on the line at variables own, own + 1; (2, ux, uy, 0) for n
    || u."""
    code = s.code[row]
    if code == ACROSS:
        ux = x[s.var[row, 2]] - x[s.var[row, 0]]
        uy = x[s.var[row, 3]] - x[s.var[row, 1]]
        turn = s.shift[s.var[row, 4]] - s.shift[own]
        c, si = math.cos(turn), math.sin(turn)
        return 2, c * ux + si * uy, c * uy - si * ux, 0.0
    px, py, w = x[s.var[row, 0]], x[s.var[row, 1]], s.value[row]
    theta, d = s.var[row, 2], s.var[row, 3]
    if code == MIDDLE_ON:
        px, py, w = 0.5 * (px + x[s.var[row, 2]]), 0.5 * (py + x[s.var[row, 3]]), 0.0
        theta, d = s.var[row, 4], s.var[row, 5]
    elif code == LINE_CIRCLE:
        w += s.coef[row, 0] * x[s.var[row, 4]]
    sign = 1.0 if math.cos(s.shift[theta] - s.shift[own]) > 0.0 else -1.0
    return 1, px, py, sign * (w + s.shift[d])


@inlined
def _set_line(s, turn, slide, own, nx, ny, d, x, sketch):
    """Gives the line at `own` the normal (nx, ny) and offset d; its direction stays near the
    sketch's."""
    theta = math.atan2(-nx, ny)
    theta += 2.0 * math.pi * round((sketch[own] - theta) / (2.0 * math.pi))
    assign(s, turn, theta - s.shift[own], x)
    if slide >= 0:
        assign(s, slide, d, x)


@inlined
def _place_line(s, turn, slide, rows, count, x, sketch, turned):
    """Places a line from at most two conditions; `slide` -1 places a direction alone (from one)."""
    own = s.root[slide] - 1 if slide >= 0 else s.root[turn]
    theta = sketch[own]
    nx, ny = -math.sin(theta), math.cos(theta)
    if count == 0:
        _set_line(s, turn, slide, own, nx, ny, sketch[own + 1], x, sketch)
        return True
    k1, p1, q1, w1 = _line_condition(s, rows[0], own, x)
    if slide < 0 and k1 == 1:
        return False
    if count == 1 and k1 == 1:
        _set_line(s, turn, slide, own, nx, ny, nx * p1 + ny * q1 - w1, x, sketch)
        return True
    k2, p2, q2, w2 = 0, 0.0, 0.0, 0.0
    if count == 2:
        k2, p2, q2, w2 = _line_condition(s, rows[1], own, x)
        if k1 == 2:
            k1, p1, q1, w1, k2, p2, q2, w2 = k2, p2, q2, w2, k1, p1, q1, w1
    if k1 == 2:
        p2, q2 = p1, q1
    if k1 == 2 or k2 == 2:
        length = math.hypot(p2, q2)
        if length == 0.0 or (k1 == 2 and k2 == 2):
            return False
        if nx * p2 + ny * q2 < 0.0:
            length = -length
        nx, ny = p2 / length, q2 / length
        d = nx * p1 + ny * q1 - w1 if k1 == 1 else sketch[own + 1]
        _set_line(s, turn, slide, own, nx, ny, d, x, sketch)
        return True
    dx, dy = p1 - p2, q1 - q2
    length = math.hypot(dx, dy)
    if length == 0.0:
        return False
    along = (w1 - w2) / length
    h = _root_of((1.0 - along) * (1.0 + along), 1.0)
    if h < 0.0:
        return False
    _, s1, t1, _ = _line_condition(s, rows[0], own, sketch)
    _, s2, t2, _ = _line_condition(s, rows[1], own, sketch)
    ux, uy = dx / length, dy / length
    if (s1 - s2) * ny - (t1 - t2) * nx < 0.0:
        h = -h
    h *= turned
    nx, ny = along * ux - h * uy, along * uy + h * ux
    _set_line(s, turn, slide, own, nx, ny, nx * p1 + ny * q1 - w1, x, sketch)
    return True


@inlined
def place(s, v, partner, rows, x, sketch, gradient, turned):
    """Places vertex v, with its partner if any, from `rows` (-1 pads); False when there is no such
    place. `turned` -1 takes the branch on the other side than the sketch's, 1 the sketch's."""
    count = 0
    while count < 3 and rows[count] >= 0:
        count += 1
    kind = s.kind[v]
    if kind == POINT and partner < 0:
        return count <= 2 and _place_point(s, v, rows, count, x, sketch, turned)
    if kind == TURN:
        return count <= 2 and _place_line(s, v, partner, rows, count, x, sketch, turned)
    if kind == SLIDE or kind == SIZE:
        if count == 0:
            assign(s, v, sketch[s.root[v]], x)
            return True
        return count == 1 and _place_number(s, v, rows[0], x, gradient)
    return False

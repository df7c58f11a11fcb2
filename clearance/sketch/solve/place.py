"""Ruler and compass: one vertex (or a line, or a circle) placed in closed form from what already
stands.

A point comes from the loci of its conditions (`sketch.solve.loci`), a line from the points that it passes at known
distances; the sketch's side is kept. Where a condition is missing the sketch is moved least (the paper's
assumptions): the nearest point of a locus, a line's old direction.
"""

from __future__ import annotations

import math

from clearance.sketch.equations import ACROSS, LINE_CIRCLE, MIDDLE_ON
from clearance.sketch.graph.graph import POINT, SIZE, TURN
from clearance.sketch.graph.steps import PlanStep
from clearance.sketch.solve.loci import locus, meet, nearest_on, root_of
from clearance.sketch.solve.system import PlainSystem


def _place_point(s, v, rows, count, x, sketch, turned):
    i = s.root[v]
    px, py = sketch[i], sketch[i + 1]
    if count == 0:
        x[i], x[i + 1] = px, py
        return True
    first = locus(s, rows[0], i, x)
    if first.kind == 0:
        return False
    if count == 1:
        good, x[i], x[i + 1] = nearest_on(first, px, py)
        return good
    second = locus(s, rows[1], i, x)
    if second.kind == 0:
        return False
    drawn_first = locus(s, rows[0], i, sketch)
    drawn_second = locus(s, rows[1], i, sketch)
    good, mx, my = meet(first, second, drawn_first, drawn_second, px, py, turned)
    if good:
        x[i], x[i + 1] = mx, my
    return good


def _place_number(s, v, row, x):
    """Places an offset or a radius, in which every equation is linear; a radius must not be
    negative."""
    s.assign(v, 0.0, x)
    f0 = s.residual(row, x)
    s.assign(v, 1.0, x)
    slope = s.residual(row, x) - f0
    if abs(slope) < 1e-12:
        return False
    number = -f0 / slope
    s.assign(v, number, x)
    return s.kind[v] != SIZE or all(x[i] >= 0.0 for i in s.members[v])


def _line_condition(s, row, own, x):
    """(1, px, py, w) for n . p - d = w on the line at variables own, own + 1; (2, ux, uy, 0) for n
    || u."""
    code = s.code[row]
    if code == ACROSS:
        ux = x[s.var[row][2]] - x[s.var[row][0]]
        uy = x[s.var[row][3]] - x[s.var[row][1]]
        turn = s.shift[s.var[row][4]] - s.shift[own]
        c, si = math.cos(turn), math.sin(turn)
        return 2, c * ux + si * uy, c * uy - si * ux, 0.0
    px, py, w = x[s.var[row][0]], x[s.var[row][1]], s.value[row]
    theta, d = s.var[row][2], s.var[row][3]
    if code == MIDDLE_ON:
        px, py, w = 0.5 * (px + x[s.var[row][2]]), 0.5 * (py + x[s.var[row][3]]), 0.0
        theta, d = s.var[row][4], s.var[row][5]
    elif code == LINE_CIRCLE:
        w += s.coef[row][0] * x[s.var[row][4]]
    sign = 1.0 if math.cos(s.shift[theta] - s.shift[own]) > 0.0 else -1.0
    return 1, px, py, sign * (w + s.shift[d])


def _set_line(s, turn, slide, own, nx, ny, d, x, sketch):
    """Gives the line at `own` the normal (nx, ny) and offset d; its direction stays near the
    sketch's.

    Many arguments: the numbers of a line, where they stand, and the vectors of the sketch, which stand together
    nowhere else.
    """
    theta = math.atan2(-nx, ny)
    theta += 2.0 * math.pi * round((sketch[own] - theta) / (2.0 * math.pi))
    s.assign(turn, theta - s.shift[own], x)
    if slide >= 0:
        s.assign(slide, d, x)


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
    h = root_of((1.0 - along) * (1.0 + along), 1.0)
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


def place(
    s: PlainSystem, step: PlanStep, x: list[float], sketch: list[float], turned: float
) -> bool:
    """Places what a closed step places, in place on x; False when there is no such place.

    `turned` -1 takes the branch on the other side than the sketch's, 1 the sketch's.
    """
    v, partner, rows = step.vertex, step.partner, step.rows
    count, kind = len(rows), s.kind[v]
    if kind == POINT and partner < 0:
        return count <= 2 and _place_point(s, v, rows, count, x, sketch, turned)
    if kind == TURN:
        return count <= 2 and _place_line(s, v, partner, rows, count, x, sketch, turned)
    if count == 0 and kind != POINT:
        s.assign(v, sketch[s.root[v]], x)
        return True
    return count == 1 and kind != POINT and _place_number(s, v, rows[0], x)

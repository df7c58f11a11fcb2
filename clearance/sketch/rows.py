"""The equations that each constraint stands for, as rows for `clearance.sketch.equations`.

A function per form takes the sketch's numbers and the entities; whatever an equation leaves open by sign (the
side of a line, inside or outside, the turn of an angle) it reads from the sketch. Not for: which kinds
take which entities (`constraints`).
"""

from __future__ import annotations

import math
from typing import NamedTuple

from clearance.sketch import equations as equation
from clearance.sketch.entities import Arc, Line, Point

NOWHERE, GROUNDED, ORIENTED = 0, 1, 2
"""How a row refers to the ground: not, by position, by direction only."""


class Row(NamedTuple):
    """One equation; its value is `scale` times the dimension plus `offset`."""

    code: int
    var: tuple[int, ...]
    coef: tuple[float, ...] = ()
    scale: float = 0.0
    offset: float = 0.0
    ground: int = NOWHERE
    again: bool = False
    """Often said by another constraint as well: that two lines at a distance are parallel."""


def pair(p: Point) -> tuple[int, int]:
    return p.variable, p.variable + 1


def gap(x: list[float], p: Point, line: Line) -> float:
    """[m] signed distance of p from the line in the sketch."""
    theta, d = x[line.variable], x[line.variable + 1]
    return math.cos(theta) * x[p.variable + 1] - math.sin(theta) * x[p.variable] - d


def span(x: list[float], p: Point, q: Point) -> float:
    return math.hypot(x[p.variable] - x[q.variable], x[p.variable + 1] - x[q.variable + 1])


def sign(value: float) -> float:
    return -1.0 if value < 0.0 else 1.0


def turns(x: list[float], line: Line, other: Line) -> float:
    return x[other.variable] - x[line.variable]


def half_turn(x: list[float], line: Line, other: Line) -> float:
    return math.pi * round(turns(x, line, other) / math.pi)


def point_point(x, p, q):
    return [Row(equation.POINT_POINT, pair(p) + pair(q), scale=1.0)]


def point_line(x, p, line):
    place = (*pair(p), line.variable, line.variable + 1)
    return [Row(equation.POINT_LINE, place, scale=sign(gap(x, p, line)))]


def point_circle(x, p, c):
    side = sign(span(x, p, c.center) - x[c.variable])
    return [Row(equation.POINT_CIRCLE, (*pair(p), *pair(c.center), c.variable), scale=side)]


def line_line(x, a, b):
    turn = half_turn(x, a, b)
    same = sign(math.cos(turn))
    shift = x[b.variable + 1] - same * x[a.variable + 1]
    return [
        Row(equation.LINEAR, (b.variable, a.variable), (1.0, -1.0), offset=turn, again=True),
        Row(equation.LINEAR, (b.variable + 1, a.variable + 1), (1.0, -same), scale=sign(shift)),
    ]


def on_line(x, p, line):
    return [Row(equation.POINT_LINE, (*pair(p), line.variable, line.variable + 1))]


def on_circle(x, p, c):
    return [Row(equation.POINT_CIRCLE, (*pair(p), *pair(c.center), c.variable))]


def together(x, p, q):
    return [Row(equation.LINEAR, (p.variable + k, q.variable + k), (1.0, -1.0)) for k in (0, 1)]


def centered(x, c, d):
    return together(x, c.center, d.center)


def point_centered(x, p, c):
    return together(x, p, c.center)


def same_line(x, a, b):
    turn = half_turn(x, a, b)
    same = sign(math.cos(turn))
    return [
        Row(equation.LINEAR, (b.variable, a.variable), (1.0, -1.0), offset=turn),
        Row(equation.LINEAR, (b.variable + 1, a.variable + 1), (1.0, -same)),
    ]


def line_touches(x, line, c):
    side = sign(gap(x, c.center, line))
    place = (*pair(c.center), line.variable, line.variable + 1, c.variable)
    return [Row(equation.LINE_CIRCLE, place, (side,))]


def shared_end(c, d) -> Point | None:
    """The point in which two arcs end, if there is one: their centres lie on one side of it or on both."""
    if isinstance(c, Arc) and isinstance(d, Arc):
        return next((p for p in (c.start, c.end) if p in (d.start, d.end)), None)
    return None


def circles_touch(x, c, d, inside=None):
    r, q = x[c.variable], x[d.variable]
    apart = span(x, c.center, d.center)
    shared = shared_end(c, d)
    if inside is None and shared is not None:
        (px, py), *centers = (
            (x[i], x[i + 1]) for i in (shared.variable, c.center.variable, d.center.variable)
        )
        (ax, ay), (bx, by) = centers
        inside = (ax - px) * (bx - px) + (ay - py) * (by - py) > 0.0
    elif inside is None:
        inside = abs(apart - abs(r - q)) < abs(apart - (r + q))
    signs = (1.0, 1.0) if not inside else ((1.0, -1.0) if r >= q else (-1.0, 1.0))
    place = (*pair(c.center), *pair(d.center), c.variable, d.variable)
    return [Row(equation.CIRCLE_CIRCLE, place, signs)]


def angle(x, a, b):
    turn = turns(x, a, b)
    whole = 2.0 * math.pi * round(turn / (2.0 * math.pi))
    side = sign(turn - whole)
    return [Row(equation.LINEAR, (b.variable, a.variable), (1.0, -1.0), side, whole)]


def parallel(x, a, b):
    turn = half_turn(x, a, b)
    return [Row(equation.LINEAR, (b.variable, a.variable), (1.0, -1.0), offset=turn)]


def perpendicular(x, a, b):
    turn = math.pi * (round(turns(x, a, b) / math.pi - 0.5) + 0.5)
    return [Row(equation.LINEAR, (b.variable, a.variable), (1.0, -1.0), offset=turn)]


def level(x, line):
    turn = math.pi * round(x[line.variable] / math.pi)
    return [Row(equation.LINEAR, (line.variable,), (1.0,), offset=turn, ground=ORIENTED)]


def upright(x, line):
    turn = math.pi * (round(x[line.variable] / math.pi - 0.5) + 0.5)
    return [Row(equation.LINEAR, (line.variable,), (1.0,), offset=turn, ground=ORIENTED)]


def points_level(x, p, q):
    return [Row(equation.LINEAR, (p.variable + 1, q.variable + 1), (1.0, -1.0), ground=ORIENTED)]


def points_upright(x, p, q):
    return [Row(equation.LINEAR, (p.variable, q.variable), (1.0, -1.0), ground=ORIENTED)]


def radius(x, c):
    return [Row(equation.LINEAR, (c.variable,), (1.0,), 1.0)]


def diameter(x, c):
    return [Row(equation.LINEAR, (c.variable,), (1.0,), 0.5)]


def lengths(a, b):
    return pair(a.ends[0]) + pair(a.ends[1]) + pair(b.ends[0]) + pair(b.ends[1])


def equal_length(x, a, b):
    return [Row(equation.LENGTHS, lengths(a, b), offset=1.0)]


def length_ratio(x, a, b):
    return [Row(equation.LENGTHS, lengths(a, b), scale=1.0)]


def equal_radius(x, c, d):
    return [Row(equation.LINEAR, (c.variable, d.variable), (1.0, -1.0))]


def radius_ratio(x, c, d):
    return [Row(equation.RATIO, (c.variable, d.variable), scale=1.0)]


def midpoint(x, m, line):
    return middle(x, m, *line.ends)


def middle(x, m, p, q):
    return [
        Row(equation.LINEAR, (m.variable + k, p.variable + k, q.variable + k), (1.0, -0.5, -0.5))
        for k in (0, 1)
    ]


def symmetric(x, p, q, line):
    place = (*pair(p), *pair(q), line.variable, line.variable + 1)
    return [Row(equation.MIDDLE_ON, place), Row(equation.ACROSS, place[:5])]


def circles_symmetric(x, c, d, line):
    return symmetric(x, c.center, d.center, line) + equal_radius(x, c, d)


def fix_point(x, p):
    return [Row(equation.LINEAR, (v,), (1.0,), offset=x[v], ground=GROUNDED) for v in pair(p)]


def fix_line(x, line):
    at = line.variable
    return [Row(equation.LINEAR, (v,), (1.0,), offset=x[v], ground=GROUNDED) for v in (at, at + 1)]


def fix_circle(x, c):
    return [
        *fix_point(x, c.center),
        Row(equation.LINEAR, (c.variable,), (1.0,), offset=x[c.variable]),
    ]


def nothing(x, *entities):
    return []

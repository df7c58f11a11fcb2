"""The equations that each constraint stands for, as rows for `clearance.sketch.equations`.

A function per form takes the sketch's numbers and the entities. Signs that an equation leaves open (the side of a
line, inside or outside, the turn of an angle) it reads from the sketch. Not for: which kinds are for which
entities (`constraints`).
"""

from __future__ import annotations

import math
from typing import Any, NamedTuple

from clearance.sketch.entities import Arc, Circle, Line, Point
from clearance.sketch.equations import (
    Across,
    CircleCircle,
    Lengths,
    Linear,
    LineCircle,
    MiddleOn,
    PointCircle,
    PointLine,
    PointPoint,
    Ratio,
)

NOWHERE, GROUNDED, ORIENTED = 0, 1, 2
"""How a row refers to the ground: not, by position, by direction only."""


class Row(NamedTuple):
    """One equation; its value is `scale` times the dimension plus `offset`."""

    equation: Any
    """A kind of `equations`, with the places of its numbers."""
    coef: tuple[float, ...] = ()
    scale: float = 0.0
    offset: float = 0.0
    ground: int = NOWHERE
    again: bool = False
    """Often said by another constraint as well: that two lines at a distance are parallel."""


def pair(e: Point | Line) -> tuple[int, int]:
    return e.variable, e.variable + 1


def rim(c: Circle) -> tuple[int, int, int]:
    return *pair(c.center), c.variable


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
    return [Row(PointPoint(*pair(p), *pair(q)), scale=1.0)]


def point_line(x, p, line):
    return [Row(PointLine(*pair(p), *pair(line)), scale=sign(gap(x, p, line)))]


def point_circle(x, p, c):
    side = sign(span(x, p, c.center) - x[c.variable])
    return [Row(PointCircle(*pair(p), *rim(c)), scale=side)]


def line_line(x, a, b):
    turn = half_turn(x, a, b)
    same = sign(math.cos(turn))
    shift = x[b.variable + 1] - same * x[a.variable + 1]
    return [
        Row(Linear(b.variable, a.variable), (1.0, -1.0), offset=turn, again=True),
        Row(Linear(b.variable + 1, a.variable + 1), (1.0, -same), scale=sign(shift)),
    ]


def on_line(x, p, line):
    return [Row(PointLine(*pair(p), *pair(line)))]


def on_circle(x, p, c):
    return [Row(PointCircle(*pair(p), *rim(c)))]


def together(x, p, q):
    return [Row(Linear(p.variable + k, q.variable + k), (1.0, -1.0)) for k in (0, 1)]


def centered(x, c, d):
    return together(x, c.center, d.center)


def point_centered(x, p, c):
    return together(x, p, c.center)


def same_line(x, a, b):
    turn = half_turn(x, a, b)
    same = sign(math.cos(turn))
    return [
        Row(Linear(b.variable, a.variable), (1.0, -1.0), offset=turn),
        Row(Linear(b.variable + 1, a.variable + 1), (1.0, -same)),
    ]


def line_touches(x, line, c):
    side = sign(gap(x, c.center, line))
    return [Row(LineCircle(*pair(c.center), *pair(line), c.variable), (side,))]


def shared_end(c, d) -> Point | None:
    """The point in which two arcs end, if there is one: their centres lie on one side of it or on both."""
    if isinstance(c, Arc) and isinstance(d, Arc):
        return next((p for p in (c.start, c.end) if p in (d.start, d.end)), None)
    return None


def circles_touch(x, c, d, inside=None):
    r, q = x[c.variable], x[d.variable]
    between = span(x, c.center, d.center)
    shared = shared_end(c, d)
    if inside is None and shared is not None:
        (px, py), *centers = (
            (x[i], x[i + 1]) for i in (shared.variable, c.center.variable, d.center.variable)
        )
        (ax, ay), (bx, by) = centers
        inside = (ax - px) * (bx - px) + (ay - py) * (by - py) > 0.0
    elif inside is None:
        inside = abs(between - abs(r - q)) < abs(between - (r + q))
    signs = (1.0, 1.0) if not inside else ((1.0, -1.0) if r >= q else (-1.0, 1.0))
    place = CircleCircle(*pair(c.center), *pair(d.center), c.variable, d.variable)
    return [Row(place, signs)]


def angle(x, a, b):
    turn = turns(x, a, b)
    whole = 2.0 * math.pi * round(turn / (2.0 * math.pi))
    side = sign(turn - whole)
    return [Row(Linear(b.variable, a.variable), (1.0, -1.0), side, whole)]


def parallel(x, a, b):
    turn = half_turn(x, a, b)
    return [Row(Linear(b.variable, a.variable), (1.0, -1.0), offset=turn)]


def perpendicular(x, a, b):
    turn = math.pi * (round(turns(x, a, b) / math.pi - 0.5) + 0.5)
    return [Row(Linear(b.variable, a.variable), (1.0, -1.0), offset=turn)]


def level(x, line):
    turn = math.pi * round(x[line.variable] / math.pi)
    return [Row(Linear(line.variable), (1.0,), offset=turn, ground=ORIENTED)]


def upright(x, line):
    turn = math.pi * (round(x[line.variable] / math.pi - 0.5) + 0.5)
    return [Row(Linear(line.variable), (1.0,), offset=turn, ground=ORIENTED)]


def points_level(x, p, q):
    return [Row(Linear(p.variable + 1, q.variable + 1), (1.0, -1.0), ground=ORIENTED)]


def points_upright(x, p, q):
    return [Row(Linear(p.variable, q.variable), (1.0, -1.0), ground=ORIENTED)]


def radius(x, c):
    return [Row(Linear(c.variable), (1.0,), 1.0)]


def diameter(x, c):
    return [Row(Linear(c.variable), (1.0,), 0.5)]


def lengths(a, b):
    return Lengths(*(i for p in (*a.ends, *b.ends) for i in pair(p)))


def equal_length(x, a, b):
    return [Row(lengths(a, b), offset=1.0)]


def length_ratio(x, a, b):
    return [Row(lengths(a, b), scale=1.0)]


def equal_radius(x, c, d):
    return [Row(Linear(c.variable, d.variable), (1.0, -1.0))]


def radius_ratio(x, c, d):
    return [Row(Ratio(c.variable, d.variable), scale=1.0)]


def midpoint(x, m, line):
    return middle(x, m, *line.ends)


def middle(x, m, p, q):
    return [
        Row(Linear(m.variable + k, p.variable + k, q.variable + k), (1.0, -0.5, -0.5))
        for k in (0, 1)
    ]


def symmetric(x, p, q, line):
    place = MiddleOn(*pair(p), *pair(q), *pair(line))
    return [Row(place), Row(Across(*place[:5]))]


def circles_symmetric(x, c, d, line):
    return symmetric(x, c.center, d.center, line) + equal_radius(x, c, d)


def fix_point(x, p):
    return [Row(Linear(v), (1.0,), offset=x[v], ground=GROUNDED) for v in pair(p)]


def fix_line(x, line):
    at = line.variable
    return [Row(Linear(v), (1.0,), offset=x[v], ground=GROUNDED) for v in (at, at + 1)]


def fix_circle(x, c):
    return [
        *fix_point(x, c.center),
        Row(Linear(c.variable), (1.0,), offset=x[c.variable]),
    ]


def nothing(x, *entities):
    return []

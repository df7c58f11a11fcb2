"""The equations that each constraint stands for, as rows for `clearance.sketch.equations`.

A function per form takes the sketch's numbers and the entities. Signs that an equation leaves open (the side of a
line, inside or outside, the turn of an angle) it reads from the sketch.
"""

from __future__ import annotations

import math
from typing import Any, NamedTuple

from clearance.sketch.entities import Arc, Circle, Entity, Line, Point
from clearance.sketch.equations import (
    Across,
    FromCircle,
    FromLine,
    Lengths,
    Linear,
    MiddleOn,
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


def pair(e: Entity) -> tuple[int, int]:
    """The two numbers of a point or a line, or of a circle's centre."""
    first = e.center.variable if isinstance(e, Circle) else e.variable
    return first, first + 1


def rim(c: Circle) -> tuple[int, int, int]:
    return *pair(c), c.variable


def gap(x: list[float], p: Entity, line: Line) -> float:
    """[m] signed distance of p (or a circle's centre) from the line in the sketch."""
    theta, d = (x[i] for i in pair(line))
    px, py = (x[i] for i in pair(p))
    return math.cos(theta) * py - math.sin(theta) * px - d


def span(x: list[float], p: Entity, q: Entity) -> float:
    """[m] distance of two points or centres in the sketch."""
    (px, py), (qx, qy) = pair(p), pair(q)
    return math.hypot(x[px] - x[qx], x[py] - x[qy])


def times_as_long(x: list[float], line: Line, other: Line) -> float:
    """How many times as long as another a line is in the sketch; both have points (see `form_of`)."""
    assert line.ends and other.ends, "the forms say that they span lines"
    return span(x, *line.ends) / span(x, *other.ends)


def clear(x: list[float], p: Point, c: Circle) -> float:
    """[m] how far a point is outside a circle in the sketch."""
    return span(x, p, c) - x[c.variable]


def turns(x: list[float], line: Line, other: Line) -> float:
    return x[other.variable] - x[line.variable]


def beside(x: list[float], line: Line, other: Line) -> float:
    """[m] how far the other of two nearly parallel lines is to the left of the first in the sketch."""
    same = sign(math.cos(turns(x, line, other)))
    return x[other.variable + 1] - same * x[line.variable + 1]


def runs_along(x: list[float], line: Line) -> bool:
    """Whether a line's second point lies ahead of its first; true of a line without points."""
    if line.ends is None:
        return True
    (px, py), (qx, qy) = map(pair, line.ends)
    theta = x[line.variable]
    return math.cos(theta) * (x[qx] - x[px]) + math.sin(theta) * (x[qy] - x[py]) >= 0.0


def turned(x: list[float], line: Line, other: Line) -> float:
    """[rad] the turn from the direction of one line to the other's, up to half a turn either way."""
    reversals = sum(not runs_along(x, one) for one in (line, other))
    return math.remainder(turns(x, line, other) + reversals * math.pi, 2.0 * math.pi)


def sign(value: float) -> float:
    return -1.0 if value < 0.0 else 1.0


def half_turns(angle: float) -> float:
    """The nearest angle along the same line."""
    return math.pi * round(angle / math.pi)


def quarter_turns(angle: float) -> float:
    """The nearest angle at right angles."""
    return math.pi * (round(angle / math.pi - 0.5) + 0.5)


def equal(i: int, j: int, **value: Any) -> Row:
    """Two numbers are equal, or differ by a value."""
    return Row(Linear(i, j), (1.0, -1.0), **value)


def given(i: int, **value: Any) -> Row:
    """A number has a value."""
    return Row(Linear(i), (1.0,), **value)


def point_point(x, p, q):
    return [Row(PointPoint(*pair(p), *pair(q)), scale=1.0)]


def point_line(x, p, line):
    return [Row(FromLine(*pair(p), *pair(line)), scale=sign(gap(x, p, line)))]


def point_circle(x, p, c):
    return [Row(FromCircle(*pair(p), *rim(c)), (1.0,), scale=sign(clear(x, p, c)))]


def line_line(x, a, b):
    (turn,), same = parallel(x, a, b), sign(math.cos(turns(x, a, b)))
    offsets = Linear(b.variable + 1, a.variable + 1)
    side = sign(beside(x, a, b))
    return [turn._replace(again=True), Row(offsets, (1.0, -same), scale=side)]


def on_line(x, p, line):
    return [Row(FromLine(*pair(p), *pair(line)))]


def on_circle(x, p, c):
    return [Row(FromCircle(*pair(p), *rim(c)), (1.0,))]


def together(x, p, q):
    return [equal(i, j) for i, j in zip(pair(p), pair(q), strict=True)]


def same_line(x, a, b):
    turn, offset = line_line(x, a, b)
    return [turn._replace(again=False), offset._replace(scale=0.0)]


def line_touches(x, line, c):
    side = sign(gap(x, c, line))
    return [Row(FromLine(*pair(c), *pair(line), c.variable), (side,))]


def shared_end(c, d) -> Point | None:
    """The point in which two arcs end, if there is one: their centres lie on one side of it or on both."""
    if isinstance(c, Arc) and isinstance(d, Arc):
        return next((p for p in (c.start, c.end) if p in (d.start, d.end)), None)
    return None


def circles_touch(x, c, d, inside=None):
    r, q = x[c.variable], x[d.variable]
    between = span(x, c, d)
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
    place = FromCircle(*pair(d), *rim(c), d.variable)
    return [Row(place, signs)]


def angle(x, a, b):
    turn = turned(x, a, b)
    rest = half_turns(turns(x, a, b) - turn)
    return [equal(b.variable, a.variable, scale=sign(turn), offset=rest)]


def parallel(x, a, b):
    return [equal(b.variable, a.variable, offset=half_turns(turns(x, a, b)))]


def perpendicular(x, a, b):
    return [equal(b.variable, a.variable, offset=quarter_turns(turns(x, a, b)))]


def level(x, line):
    return [given(line.variable, offset=half_turns(x[line.variable]), ground=ORIENTED)]


def upright(x, line):
    return [given(line.variable, offset=quarter_turns(x[line.variable]), ground=ORIENTED)]


def points_level(x, p, q):
    return [equal(p.variable + 1, q.variable + 1, ground=ORIENTED)]


def points_upright(x, p, q):
    return [equal(p.variable, q.variable, ground=ORIENTED)]


def radius(x, c):
    return [given(c.variable, scale=1.0)]


def diameter(x, c):
    return [given(c.variable, scale=0.5)]


def equal_length(x, a, b):
    return [length_ratio(x, a, b)[0]._replace(scale=0.0, offset=1.0)]


def length_ratio(x, a, b):
    return [Row(Lengths(*(i for p in (*a.ends, *b.ends) for i in pair(p))), scale=1.0)]


def equal_radius(x, c, d):
    return [equal(c.variable, d.variable)]


def radius_ratio(x, c, d):
    return [Row(Ratio(c.variable, d.variable), scale=1.0)]


def midpoint(x, m, line):
    return middle(x, m, *line.ends)


def middle(x, m, p, q):
    places = zip(pair(m), pair(p), pair(q), strict=True)
    return [Row(Linear(*place), (1.0, -0.5, -0.5)) for place in places]


def symmetric(x, p, q, line):
    place = MiddleOn(*pair(p), *pair(q), *pair(line))
    return [Row(place), Row(Across(*place[:5]))]


def circles_symmetric(x, c, d, line):
    return symmetric(x, c, d, line) + equal_radius(x, c, d)


def fix(x, e):
    return [given(i, offset=x[i], ground=GROUNDED) for i in pair(e)]


def fix_circle(x, c):
    return [*fix(x, c), given(c.variable, offset=x[c.variable])]


def nothing(x, *entities):
    return []

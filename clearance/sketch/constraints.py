"""Constraint kinds: between which entities, with which valency, and the equations they stand for.

A kind turns entities into rows (see `clearance.kernels.sketch_equations`). Whatever an equation
leaves open by sign (the side of a line, inside or outside, the turn of an angle) is read from the
sketch when the constraint is made and never changes afterwards. Not for: solving.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Sequence
from dataclasses import dataclass
from typing import NamedTuple

from clearance.kernels import sketch_equations as equation
from clearance.sketch.entities import Circle, Entity, Line, Point
from clearance.sketch.faults import BadConstraint

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


@dataclass(eq=False)
class Constraint:
    """A named relation of a sketch.

    Attributes:
        name: unique in the sketch.
        kind: a key of `KINDS`.
        entities: what it relates.
        given: the dimension as given (a number or an expression), None where the kind has none.
        number: the dimension's value [m], [rad] or [-]; NaN without one.
        driven: measured only; it constrains nothing.
        built_in: part of how an entity was drawn (a line through its points).
        index: its place among the sketch's constraints.
        n_rows: how many equations it has.
    """

    name: str
    kind: str
    entities: tuple[Entity, ...]
    given: float | str | None
    number: float
    driven: bool
    built_in: bool
    index: int
    n_rows: int
    options: dict

    @property
    def valency(self) -> int:
        """How many degrees of freedom it takes."""
        return self.n_rows


def _pair(p: Point) -> tuple[int, int]:
    return p.variable, p.variable + 1


def _gap(x: list[float], p: Point, line: Line) -> float:
    """[m] signed distance of p from the line in the sketch."""
    theta, d = x[line.variable], x[line.variable + 1]
    return math.cos(theta) * x[p.variable + 1] - math.sin(theta) * x[p.variable] - d


def _span(x: list[float], p: Point, q: Point) -> float:
    return math.hypot(x[p.variable] - x[q.variable], x[p.variable + 1] - x[q.variable + 1])


def _sign(value: float) -> float:
    return -1.0 if value < 0.0 else 1.0


def _turns(x: list[float], line: Line, other: Line) -> float:
    return x[other.variable] - x[line.variable]


def _half_turn(x: list[float], line: Line, other: Line) -> float:
    return math.pi * round(_turns(x, line, other) / math.pi)


def _point_point(x, p, q):
    return [Row(equation.POINT_POINT, _pair(p) + _pair(q), scale=1.0)]


def _point_line(x, p, line):
    place = (*_pair(p), line.variable, line.variable + 1)
    return [Row(equation.POINT_LINE, place, scale=_sign(_gap(x, p, line)))]


def _point_circle(x, p, c):
    side = _sign(_span(x, p, c.center) - x[c.variable])
    return [Row(equation.POINT_CIRCLE, (*_pair(p), *_pair(c.center), c.variable), scale=side)]


def _line_line(x, a, b):
    turn = _half_turn(x, a, b)
    same = _sign(math.cos(turn))
    shift = x[b.variable + 1] - same * x[a.variable + 1]
    return [
        Row(equation.LINEAR, (b.variable, a.variable), (1.0, -1.0), offset=turn),
        Row(equation.LINEAR, (b.variable + 1, a.variable + 1), (1.0, -same), scale=_sign(shift)),
    ]


def _on_line(x, p, line):
    return [Row(equation.POINT_LINE, (*_pair(p), line.variable, line.variable + 1))]


def _on_circle(x, p, c):
    return [Row(equation.POINT_CIRCLE, (*_pair(p), *_pair(c.center), c.variable))]


def _together(x, p, q):
    return [Row(equation.LINEAR, (p.variable + k, q.variable + k), (1.0, -1.0)) for k in (0, 1)]


def _centered(x, c, d):
    return _together(x, c.center, d.center)


def _point_centered(x, p, c):
    return _together(x, p, c.center)


def _same_line(x, a, b):
    turn = _half_turn(x, a, b)
    same = _sign(math.cos(turn))
    return [
        Row(equation.LINEAR, (b.variable, a.variable), (1.0, -1.0), offset=turn),
        Row(equation.LINEAR, (b.variable + 1, a.variable + 1), (1.0, -same)),
    ]


def _line_touches(x, line, c):
    side = _sign(_gap(x, c.center, line))
    place = (*_pair(c.center), line.variable, line.variable + 1, c.variable)
    return [Row(equation.LINE_CIRCLE, place, (side,))]


def _circles_touch(x, c, d, inside=None):
    r, q = x[c.variable], x[d.variable]
    apart = _span(x, c.center, d.center)
    if inside is None:
        inside = abs(apart - abs(r - q)) < abs(apart - (r + q))
    signs = (1.0, 1.0) if not inside else ((1.0, -1.0) if r >= q else (-1.0, 1.0))
    place = (*_pair(c.center), *_pair(d.center), c.variable, d.variable)
    return [Row(equation.CIRCLE_CIRCLE, place, signs)]


def _angle(x, a, b):
    turn = _turns(x, a, b)
    whole = 2.0 * math.pi * round(turn / (2.0 * math.pi))
    side = _sign(turn - whole)
    return [Row(equation.LINEAR, (b.variable, a.variable), (1.0, -1.0), side, whole)]


def _parallel(x, a, b):
    turn = _half_turn(x, a, b)
    return [Row(equation.LINEAR, (b.variable, a.variable), (1.0, -1.0), offset=turn)]


def _perpendicular(x, a, b):
    turn = math.pi * (round(_turns(x, a, b) / math.pi - 0.5) + 0.5)
    return [Row(equation.LINEAR, (b.variable, a.variable), (1.0, -1.0), offset=turn)]


def _level(x, line):
    turn = math.pi * round(x[line.variable] / math.pi)
    return [Row(equation.LINEAR, (line.variable,), (1.0,), offset=turn, ground=ORIENTED)]


def _upright(x, line):
    turn = math.pi * (round(x[line.variable] / math.pi - 0.5) + 0.5)
    return [Row(equation.LINEAR, (line.variable,), (1.0,), offset=turn, ground=ORIENTED)]


def _points_level(x, p, q):
    return [Row(equation.LINEAR, (p.variable + 1, q.variable + 1), (1.0, -1.0), ground=ORIENTED)]


def _points_upright(x, p, q):
    return [Row(equation.LINEAR, (p.variable, q.variable), (1.0, -1.0), ground=ORIENTED)]


def _radius(x, c):
    return [Row(equation.LINEAR, (c.variable,), (1.0,), 1.0)]


def _diameter(x, c):
    return [Row(equation.LINEAR, (c.variable,), (1.0,), 0.5)]


def _lengths(a, b):
    return _pair(a.ends[0]) + _pair(a.ends[1]) + _pair(b.ends[0]) + _pair(b.ends[1])


def _equal_length(x, a, b):
    return [Row(equation.LENGTHS, _lengths(a, b), offset=1.0)]


def _length_ratio(x, a, b):
    return [Row(equation.LENGTHS, _lengths(a, b), scale=1.0)]


def _equal_radius(x, c, d):
    return [Row(equation.LINEAR, (c.variable, d.variable), (1.0, -1.0))]


def _radius_ratio(x, c, d):
    return [Row(equation.RATIO, (c.variable, d.variable), scale=1.0)]


def _midpoint(x, m, line):
    return _middle(x, m, *line.ends)


def _middle(x, m, p, q):
    return [
        Row(equation.LINEAR, (m.variable + k, p.variable + k, q.variable + k), (1.0, -0.5, -0.5))
        for k in (0, 1)
    ]


def _symmetric(x, p, q, line):
    place = (*_pair(p), *_pair(q), line.variable, line.variable + 1)
    return [Row(equation.MIDDLE_ON, place), Row(equation.ACROSS, place[:5])]


def _circles_symmetric(x, c, d, line):
    return _symmetric(x, c.center, d.center, line) + _equal_radius(x, c, d)


def _fix_point(x, p):
    return [Row(equation.LINEAR, (v,), (1.0,), offset=x[v], ground=GROUNDED) for v in _pair(p)]


def _fix_line(x, line):
    at = line.variable
    return [Row(equation.LINEAR, (v,), (1.0,), offset=x[v], ground=GROUNDED) for v in (at, at + 1)]


def _fix_circle(x, c):
    return [
        *_fix_point(x, c.center),
        Row(equation.LINEAR, (c.variable,), (1.0,), offset=x[c.variable]),
    ]


def _nothing(x, *entities):
    return []


class Form(NamedTuple):
    """One way to use a kind: the entities it takes, how it becomes rows, and its dimension's
    unit."""

    takes: tuple[type, ...]
    rows: Callable[..., list[Row]]
    unit: str = ""
    spans: bool = False
    """The lines must have two points."""


P, L, C = Point, Line, Circle
KINDS: dict[str, tuple[Form, ...]] = {
    "distance": (
        Form((P, P), _point_point, "length"),
        Form((P, L), _point_line, "length"),
        Form((P, C), _point_circle, "length"),
        Form((L, L), _line_line, "length"),
    ),
    "incident": (Form((P, L), _on_line), Form((P, C), _on_circle)),
    "coincident": (Form((P, P), _together), Form((L, L), _same_line)),
    "tangent": (Form((L, C), _line_touches), Form((C, C), _circles_touch)),
    "angle": (Form((L, L), _angle, "angle"),),
    "parallel": (Form((L, L), _parallel),),
    "perpendicular": (Form((L, L), _perpendicular),),
    "concentric": (Form((P, C), _point_centered), Form((C, C), _centered)),
    "horizontal": (Form((L,), _level), Form((P, P), _points_level)),
    "vertical": (Form((L,), _upright), Form((P, P), _points_upright)),
    "radius": (Form((C,), _radius, "length"),),
    "diameter": (Form((C,), _diameter, "length"),),
    "equal_length": (Form((L, L), _equal_length, spans=True),),
    "equal_radius": (Form((C, C), _equal_radius),),
    "ratio": (Form((L, L), _length_ratio, "ratio", True), Form((C, C), _radius_ratio, "ratio")),
    "midpoint": (Form((P, L), _midpoint, spans=True), Form((P, P, P), _middle)),
    "symmetric": (Form((P, P, L), _symmetric), Form((C, C, L), _circles_symmetric)),
    "same_side": (Form((P, P, L), _nothing),),
    "fix": (Form((P,), _fix_point), Form((L,), _fix_line), Form((C,), _fix_circle)),
}
"""Every kind of constraint with its forms; the valency is the number of rows."""


def form_of(kind: str, entities: Sequence[Entity]) -> tuple[Form, tuple[Entity, ...]]:
    """The form of `kind` that takes these entities, and the entities in its order.

    Raises:
        BadConstraint: no such kind, entities of the wrong kinds, or an entity with itself.
    """
    if kind not in KINDS:
        raise BadConstraint(f"unknown constraint {kind!r}", valid=f"one of {', '.join(KINDS)}")
    names = ", ".join(f"{e.what} {e.name}" for e in entities)
    if len({id(e) for e in entities}) < len(entities):
        raise BadConstraint(f"{kind} of {names}", valid="different entities")
    for form in KINDS[kind]:
        if len(form.takes) != len(entities):
            continue
        if len(entities) == 2 and form.takes[0] is not form.takes[1]:
            entities = sorted(entities, key=lambda e: not isinstance(e, form.takes[0]))
        if all(isinstance(e, t) for e, t in zip(entities, form.takes, strict=True)):
            _check_spans(kind, form, entities)
            return form, tuple(entities)
    valid = " or ".join("-".join(t.what for t in form.takes) for form in KINDS[kind])
    raise BadConstraint(f"{kind} between {names}", valid=f"{kind} takes {valid}")


def _check_spans(kind: str, form: Form, entities: Sequence[Entity]) -> None:
    for e in entities:
        if form.spans and isinstance(e, Line) and e.ends is None:
            raise BadConstraint(
                f"{kind} of the infinite line {e.name}", valid="a line through two points"
            )


def measured(constraint: Constraint, x: list[float]) -> float:
    """The dimension as it is in the sketch now ([m], [rad] or [-]); NaN for kinds without one."""
    kind, entities = constraint.kind, constraint.entities
    if kind in ("radius", "diameter"):
        return x[entities[0].variable] * (2.0 if kind == "diameter" else 1.0)
    if kind == "angle":
        turn = math.remainder(_turns(x, *entities), 2.0 * math.pi)
        return abs(turn)
    if kind == "ratio":
        a, b = entities
        if isinstance(a, Circle):
            return x[a.variable] / x[b.variable]
        return _span(x, *a.ends) / _span(x, *b.ends)
    if kind != "distance":
        return math.nan
    a, b = entities
    if isinstance(b, Point):
        return _span(x, a, b)
    if isinstance(b, Circle):
        return abs(_span(x, a, b.center) - x[b.variable])
    if isinstance(a, Point):
        return abs(_gap(x, a, b))
    same = _sign(math.cos(_turns(x, a, b)))
    return abs(x[b.variable + 1] - same * x[a.variable + 1])

"""Constraint kinds: between which entities, with which valency, and what each measures.

A kind turns entities into rows (`rows`) when the constraint is made; the signs read from the sketch then
never change afterwards. Not for: solving.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Sequence
from dataclasses import dataclass
from typing import NamedTuple

from clearance.sketch import rows
from clearance.sketch.entities import Circle, Entity, Line, Point
from clearance.sketch.faults import BadConstraint
from clearance.sketch.rows import Row


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
        """The degrees of freedom that it removes."""
        return self.n_rows


class Form(NamedTuple):
    """A form of a kind: the entities it is for, how it becomes rows, and its dimension's
    unit."""

    types: tuple[type[Entity], ...]
    rows: Callable[..., list[Row]]
    unit: str = ""
    spans: bool = False
    """The lines must have two points."""


P, L, C = Point, Line, Circle
KINDS: dict[str, tuple[Form, ...]] = {
    "distance": (
        Form((P, P), rows.point_point, "length"),
        Form((P, L), rows.point_line, "length"),
        Form((P, C), rows.point_circle, "length"),
        Form((L, L), rows.line_line, "length"),
    ),
    "incident": (Form((P, L), rows.on_line), Form((P, C), rows.on_circle)),
    "coincident": (Form((P, P), rows.together), Form((L, L), rows.same_line)),
    "tangent": (Form((L, C), rows.line_touches), Form((C, C), rows.circles_touch)),
    "angle": (Form((L, L), rows.angle, "angle"),),
    "parallel": (Form((L, L), rows.parallel),),
    "perpendicular": (Form((L, L), rows.perpendicular),),
    "concentric": (Form((P, C), rows.point_centered), Form((C, C), rows.centered)),
    "horizontal": (Form((L,), rows.level), Form((P, P), rows.points_level)),
    "vertical": (Form((L,), rows.upright), Form((P, P), rows.points_upright)),
    "radius": (Form((C,), rows.radius, "length"),),
    "diameter": (Form((C,), rows.diameter, "length"),),
    "equal_length": (Form((L, L), rows.equal_length, spans=True),),
    "equal_radius": (Form((C, C), rows.equal_radius),),
    "ratio": (
        Form((L, L), rows.length_ratio, "ratio", True),
        Form((C, C), rows.radius_ratio, "ratio"),
    ),
    "midpoint": (Form((P, L), rows.midpoint, spans=True), Form((P, P, P), rows.middle)),
    "symmetric": (Form((P, P, L), rows.symmetric), Form((C, C, L), rows.circles_symmetric)),
    "same_side": (Form((P, P, L), rows.nothing),),
    "fix": (Form((P,), rows.fix_point), Form((L,), rows.fix_line), Form((C,), rows.fix_circle)),
}
"""Every kind of constraint with its forms; the valency is the number of rows."""


def form_of(kind: str, entities: Sequence[Entity]) -> tuple[Form, tuple[Entity, ...]]:
    """The form of `kind` that is for these entities, and the entities in its order.

    Raises:
        BadConstraint: no such kind, entities of the wrong kinds, or an entity with itself.
    """
    if kind not in KINDS:
        raise BadConstraint(f"unknown constraint {kind!r}", valid=f"one of {', '.join(KINDS)}")
    names = ", ".join(f"{e.what} {e.name}" for e in entities)
    if len({id(e) for e in entities}) < len(entities):
        raise BadConstraint(f"{kind} of {names}", valid="different entities")
    for form in KINDS[kind]:
        if len(form.types) != len(entities):
            continue
        if len(entities) == 2 and form.types[0] is not form.types[1]:
            entities = sorted(entities, key=lambda e: not isinstance(e, form.types[0]))
        if all(isinstance(e, t) for e, t in zip(entities, form.types, strict=True)):
            _check_spans(kind, form, entities)
            return form, tuple(entities)
    valid = " or ".join("-".join(t.what for t in form.types) for form in KINDS[kind])
    raise BadConstraint(f"{kind} between {names}", valid=f"{kind} takes {valid}")


def _check_spans(kind: str, form: Form, entities: Sequence[Entity]) -> None:
    for e in entities:
        if form.spans and isinstance(e, Line) and e.ends is None:
            raise BadConstraint(
                f"{kind} of the infinite line {e.name}", valid="a line through two points"
            )


def measured(constraint: Constraint, x: list[float]) -> float:
    """The dimension as it is in the sketch now ([m], [rad] or [-]); NaN for kinds without one."""
    match constraint.kind, *constraint.entities:
        case "radius", Circle() as c:
            return x[c.variable]
        case "diameter", Circle() as c:
            return 2.0 * x[c.variable]
        case "angle", Line() as a, Line() as b:
            return abs(math.remainder(rows.turns(x, a, b), 2.0 * math.pi))
        case "ratio", Circle() as c, Circle() as d:
            return x[c.variable] / x[d.variable]
        case "ratio", Line() as a, Line() as b:
            return _length(x, a) / _length(x, b)
        case "distance", Point() as p, Point() as q:
            return rows.span(x, p, q)
        case "distance", Point() as p, Circle() as c:
            return abs(rows.span(x, p, c.center) - x[c.variable])
        case "distance", Point() as p, Line() as a:
            return abs(rows.gap(x, p, a))
        case "distance", Line() as a, Line() as b:
            same = rows.sign(math.cos(rows.turns(x, a, b)))
            return abs(x[b.variable + 1] - same * x[a.variable + 1])
    return math.nan


def _length(x: list[float], line: Line) -> float:
    assert line.ends is not None, "`form_of` refuses lines without points where a kind spans them"
    return rows.span(x, *line.ends)

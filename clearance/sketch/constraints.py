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
        driven: measured only; it constrains nothing.
        built_in: part of how an entity was drawn (a line through its points).
        index: its place among the sketch's constraints.
        given: the dimension as given (a number or an expression), None where the kind has none.
        number: the dimension's value [m], [rad] or [-]; NaN without one.
        valency: how many equations it has, and so how many degrees of freedom it takes.
    """

    name: str
    kind: str
    entities: tuple[Entity, ...]
    driven: bool
    built_in: bool
    index: int
    options: dict
    given: float | str | None = None
    number: float = math.nan
    valency: int = 0


class Form(NamedTuple):
    """One way to use a kind: the entities it takes, how it becomes rows, and its dimension's unit."""

    types: tuple[type[Entity], ...]
    rows: Callable[..., list[Row]]
    unit: str = ""
    measure: Callable[..., float] | None = None
    """The dimension as it is drawn, but for its sign; as the rows, by the sketch's numbers and the entities."""
    spans: bool = False
    """The lines must have two points."""


P, L, C = Point, Line, Circle
KINDS: dict[str, tuple[Form, ...]] = {
    "distance": (
        Form((P, P), rows.point_point, "length", rows.span),
        Form((P, L), rows.point_line, "length", rows.gap),
        Form((P, C), rows.point_circle, "length", rows.clear),
        Form((L, L), rows.line_line, "length", rows.beside),
    ),
    "incident": (Form((P, L), rows.on_line), Form((P, C), rows.on_circle)),
    "coincident": (Form((P, P), rows.together), Form((L, L), rows.same_line)),
    "tangent": (Form((L, C), rows.line_touches), Form((C, C), rows.circles_touch)),
    "angle": (Form((L, L), rows.angle, "angle", rows.turned),),
    "parallel": (Form((L, L), rows.parallel),),
    "perpendicular": (Form((L, L), rows.perpendicular),),
    "concentric": (Form((P, C), rows.together), Form((C, C), rows.together)),
    "horizontal": (Form((L,), rows.level), Form((P, P), rows.points_level)),
    "vertical": (Form((L,), rows.upright), Form((P, P), rows.points_upright)),
    "radius": (Form((C,), rows.radius, "length", lambda x, c: x[c.variable]),),
    "diameter": (Form((C,), rows.diameter, "length", lambda x, c: 2.0 * x[c.variable]),),
    "equal_length": (Form((L, L), rows.equal_length, spans=True),),
    "equal_radius": (Form((C, C), rows.equal_radius),),
    "ratio": (
        Form((L, L), rows.length_ratio, "ratio", rows.times_as_long, spans=True),
        Form((C, C), rows.radius_ratio, "ratio", lambda x, c, d: x[c.variable] / x[d.variable]),
    ),
    "midpoint": (Form((P, L), rows.midpoint, spans=True), Form((P, P, P), rows.middle)),
    "symmetric": (Form((P, P, L), rows.symmetric), Form((C, C, L), rows.circles_symmetric)),
    "same_side": (Form((P, P, L), rows.nothing),),
    "fix": (Form((P,), rows.fix), Form((L,), rows.fix), Form((C,), rows.fix_circle)),
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
    form, entities = form_of(constraint.kind, constraint.entities)
    return math.nan if form.measure is None else abs(form.measure(x, *entities))

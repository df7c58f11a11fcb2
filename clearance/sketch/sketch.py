"""The sketch as a user builds it: entities, constraints, parameters; checked on entry, solved on
demand.

All numbers live in one flat vector and all equations in flat lists, so that solving starts without
walking
over objects. Not for: how a sketch is solved (`solver`), nor its files (`sketch_file`).
"""

from __future__ import annotations

import math
from collections.abc import Iterable, Sequence
from pathlib import Path
from typing import TYPE_CHECKING

from clearance.errors import (
    BadDimension,
    BadShape,
    DuplicateName,
    NotFinite,
    UnknownKey,
    at,
    nearest_name,
)
from clearance.kernels.sketch_graph import DIRECTION, OFFSET, RADIUS, X, Y
from clearance.sketch.constraints import Constraint, form_of, measured
from clearance.sketch.entities import Arc, Circle, Entity, Line, Point, Polyline, Segment
from clearance.sketch.expression import evaluated, names_in
from clearance.sketch.faults import DegenerateSketch, UnknownEntity

if TYPE_CHECKING:
    from clearance.planar.curve import Curve
    from clearance.sketch.result import SketchResult


class Sketch:
    """A plane sketch of points, lines and circles, and what must be true of them.

    Entities and constraints are added by the methods below; `solve` moves the entities so that
    every
    constraint holds. Lengths [m], angles [rad].
    """

    def __init__(self) -> None:
        self.entities: dict[str, Entity] = {}
        self.constraints: dict[str, Constraint] = {}
        self.parameters: dict[str, float] = {}
        self.polylines: list[Polyline] = []
        self._numbers: list[float] = []
        self._roles: list[int] = []
        self._line_ends: list[tuple[int, int, int]] = []
        self._codes: list[int] = []
        self._vars: list[int] = []
        self._coefs: list[float] = []
        self._scales: list[float] = []
        self._offsets: list[float] = []
        self._values: list[float] = []
        self._grounds: list[int] = []
        self._owners: list[int] = []
        self._ordered: list[Constraint] = []
        self._users: dict[str, list[Constraint]] = {}
        self._counts: dict[str, int] = {}
        self._solver = None

    # --- entities ---

    def point(self, x: float, y: float, *, name: str | None = None) -> Point:
        """A new point at (x, y) [m]."""
        name = self._name(name, "point")
        x, y = _number(x, f"{name}.x"), _number(y, f"{name}.y")
        return self._add(Point(self, name, self._grow((x, X), (y, Y))))

    def line(
        self, a: Point | Sequence[float], b: Point | Sequence[float], *, name: str | None = None
    ) -> Line:
        """A new infinite line through two points of the sketch, or drawn through two pairs of
        numbers.

        Raises:
            DegenerateSketch: the two points coincide.
        """
        return self._line(Line, a, b, name)

    def segment(self, a: Point, b: Point, *, name: str | None = None) -> Segment:
        """A new segment between two points of the sketch (or pairs of numbers, which become
        points)."""
        a, b = (p if isinstance(p, Entity) else self.point(*_two(p, "segment")) for p in (a, b))
        return self._line(Segment, a, b, name)

    def circle(
        self, center: Point | Sequence[float], radius: float, *, name: str | None = None
    ) -> Circle:
        """A new circle about a point of the sketch, or about a new point at a pair of numbers."""
        name = self._name(name, "circle")
        radius = _number(radius, f"{name}.radius")
        if radius <= 0.0:
            raise DegenerateSketch(f"the radius of {name} is {radius}", valid="a radius above 0")
        return self._add(Circle(self, name, *self._round(center, radius, name)))

    def arc(
        self, center: Point | Sequence[float], start: Point, end: Point, *, name: str | None = None
    ) -> Arc:
        """A new arc about a centre, counter-clockwise from `start` to `end`, which lie on its
        circle."""
        name = self._name(name, "arc")
        for p in (start, end):
            self._own(p, Point)
        c = center.position if isinstance(center, Entity) else _two(center, name)
        radius = math.hypot(c[0] - start.position[0], c[1] - start.position[1])
        if radius == 0.0:
            raise DegenerateSketch(f"{name} starts at its centre", valid="a radius above 0")
        variable, middle = self._round(center, radius, name)
        arc = self._add(Arc(self, name, variable, middle, start, end))
        for which, p in (("start", start), ("end", end)):
            self._constrain("incident", (p, arc), name=f"{name}.{which}", built_in=True)
        return arc

    def polyline(
        self, points: Iterable[Point | Sequence[float]], *, closed: bool = False
    ) -> Polyline:
        """New segments through points of the sketch (or pairs of numbers, which become points)."""
        ends = [p if isinstance(p, Entity) else self.point(*_two(p, "polyline")) for p in points]
        if len(ends) < 2:
            raise BadShape(f"a polyline of {len(ends)} points", valid="at least 2")
        pairs = list(zip(ends, ends[1:] + ends[:1], strict=True))
        out = Polyline(ends, [self.segment(*p) for p in (pairs if closed else pairs[:-1])], closed)
        self.polylines.append(out)
        return out

    # --- constraints ---

    def add(
        self,
        kind: str,
        *entities: Entity | str,
        value: float | str | None = None,
        name: str | None = None,
        driven: bool = False,
        inside: bool | None = None,
    ) -> Constraint:
        """A new constraint of any kind (a key of `clearance.sketch.constraints.KINDS`).

        Args:
            entities: entities of this sketch, or their names.
            value: the dimension, a number or an expression of parameters and dimensions.
            driven: measure only.
            inside: for two tangent circles, one within the other; by default as drawn.
        """
        found = tuple(self._find(e) for e in entities)
        options = {} if inside is None else {"inside": bool(inside)}
        return self._constrain(kind, found, value, name, driven, False, options)

    def fix(self, entity: Entity, *, name: str | None = None) -> Constraint:
        """Holds an entity where it is drawn."""
        return self.add("fix", entity, name=name)

    def distance(self, a, b, value=None, *, name=None, driven=False) -> Constraint:
        """Distance [m] of two points, a point and a line or circle, or two lines (made
        parallel)."""
        return self.add("distance", a, b, value=value, name=name, driven=driven)

    def incident(self, a, b, *, name=None) -> Constraint:
        """A point lies on a line or circle."""
        return self.add("incident", a, b, name=name)

    def coincident(self, a, b, *, name=None) -> Constraint:
        """Two points, or two lines, are one."""
        return self.add("coincident", a, b, name=name)

    def tangent(self, a, b, *, inside: bool | None = None, name=None) -> Constraint:
        """A line touches a circle, or two circles touch (by default as drawn: inside or
        outside)."""
        return self.add("tangent", a, b, inside=inside, name=name)

    def angle(self, a, b, value=None, *, name=None, driven=False) -> Constraint:
        """Angle [rad], 0 to pi, between the directions of two lines; the turn is as drawn."""
        return self.add("angle", a, b, value=value, name=name, driven=driven)

    def parallel(self, a, b, *, name=None) -> Constraint:
        """Two lines are parallel."""
        return self.add("parallel", a, b, name=name)

    def perpendicular(self, a, b, *, name=None) -> Constraint:
        """Two lines are perpendicular."""
        return self.add("perpendicular", a, b, name=name)

    def concentric(self, a, b, *, name=None) -> Constraint:
        """Two circles have one centre, or a point is a circle's centre."""
        return self.add("concentric", a, b, name=name)

    def horizontal(self, *entities, name=None) -> Constraint:
        """A line, or two points, lie along x."""
        return self.add("horizontal", *entities, name=name)

    def vertical(self, *entities, name=None) -> Constraint:
        """A line, or two points, lie along y."""
        return self.add("vertical", *entities, name=name)

    def radius(self, circle, value=None, *, name=None, driven=False) -> Constraint:
        """Radius [m] of a circle."""
        return self.add("radius", circle, value=value, name=name, driven=driven)

    def diameter(self, circle, value=None, *, name=None, driven=False) -> Constraint:
        """Diameter [m] of a circle."""
        return self.add("diameter", circle, value=value, name=name, driven=driven)

    def equal_length(self, a, b, *, name=None) -> Constraint:
        """Two lines with points are equally long."""
        return self.add("equal_length", a, b, name=name)

    def equal_radius(self, a, b, *, name=None) -> Constraint:
        """Two circles have one radius."""
        return self.add("equal_radius", a, b, name=name)

    def ratio(self, a, b, value=None, *, name=None, driven=False) -> Constraint:
        """Length (or radius) of a over that of b."""
        return self.add("ratio", a, b, value=value, name=name, driven=driven)

    def midpoint(self, m, *ends, name=None) -> Constraint:
        """A point is the middle of a line with points, or of two points."""
        return self.add("midpoint", m, *ends, name=name)

    def symmetric(self, a, b, line, *, name=None) -> Constraint:
        """Two points, or two circles, are mirror images in a line."""
        return self.add("symmetric", a, b, line, name=name)

    def same_side(self, a, b, line, *, name=None) -> Constraint:
        """Two points lie on one side of a line."""
        return self.add("same_side", a, b, line, name=name)

    # --- dimensions ---

    def parameter(self, name: str, value: float) -> None:
        """A new named number for expressions."""
        if not name.isidentifier():
            raise UnknownKey(f"a parameter named {name!r}", valid="letters, digits and _")
        self._free(name)
        self.parameters[name] = _number(value, name)

    def set(self, name: str, value: float | str) -> None:
        """Changes a parameter or a dimension, and every dimension that is an expression of it.

        Raises:
            UnknownEntity: no parameter or dimension has this name.
        """
        if name in self.parameters:
            self.parameters[name] = _number(value, name)
        elif name in self.constraints and self.constraints[name].given is not None:
            constraint = self.constraints[name]
            number = self._dimension(constraint, value)
            self._forget(constraint)
            constraint.given, constraint.number = value, number
            self._remember(constraint)
        else:
            known = [*self.parameters, *(c.name for c in self._ordered if c.given is not None)]
            raise UnknownEntity(f"no dimension named {name!r}", valid=nearest_name(name, known))
        self._propagate(name)

    def value(self, name: str) -> float:
        """The value of a parameter or dimension; a driven one is measured now."""
        if name in self.parameters:
            return self.parameters[name]
        constraint = self.constraint(name)
        return measured(constraint, self._numbers) if constraint.driven else constraint.number

    def constraint(self, name: str) -> Constraint:
        """The constraint of that name."""
        if name not in self.constraints:
            raise UnknownEntity(
                f"no constraint named {name!r}", valid=nearest_name(name, self.constraints)
            )
        return self.constraints[name]

    def entity(self, name: str) -> Entity:
        """The entity of that name."""
        if name not in self.entities:
            raise UnknownEntity(
                f"no entity named {name!r}", valid=nearest_name(name, self.entities)
            )
        return self.entities[name]

    # --- solving ---

    def solve(self) -> SketchResult:
        """Moves the entities least so that every constraint holds; see `SketchResult`.

        An inconsistent sketch is left as it is.

        Raises:
            DegenerateSketch: the solution would leave a line or circle without extent.
        """
        return self._result(*self._engine().solve())

    def drag(self, point: Point, position: Sequence[float]) -> SketchResult:
        """Brings a point as near to `position` as the constraints allow; all else moves least."""
        self._own(point, Point)
        return self._result(*self._engine().drag(point, _two(position, "drag")))

    def curves(self) -> Curve:
        """The drawn parts (segments, arcs, circles) as one curve; chains where ends meet."""
        from clearance.sketch.outline import curve_of

        return curve_of(self)

    def save(self, path: str | Path) -> None:
        """Writes the sketch as YAML."""
        from clearance.sketch.sketch_file import write

        write(self, Path(path))

    @classmethod
    def load(cls, path: str | Path) -> Sketch:
        """Reads a sketch from YAML."""
        from clearance.sketch.sketch_file import read

        return read(Path(path), cls)

    def numbers(self, first: int, count: int) -> list[float]:
        """Part of the flat vector of all entities' numbers; for the entities."""
        return self._numbers[first : first + count]

    # --- inside ---

    def _result(self, problem, before, outcome) -> SketchResult:
        from clearance.sketch.result import SketchResult

        return SketchResult(self, problem, before, outcome)

    def _engine(self):
        from clearance.sketch.solver import Solver

        if self._solver is None:
            self._solver = Solver(self)
        return self._solver

    def _name(self, given: str | None, what: str) -> str:
        if given is None:
            while True:
                self._counts[what] = self._counts.get(what, 0) + 1
                name = f"{what}{self._counts[what]}"
                if name not in self.entities and name not in self.constraints:
                    return name
        if not isinstance(given, str) or not given:
            raise UnknownEntity(f"a name {given!r}", valid="a text")
        self._free(given)
        return given

    def _free(self, name: str) -> None:
        if name in self.entities or name in self.constraints or name in self.parameters:
            raise DuplicateName(f"the name {name!r} is taken", valid="a name used once")

    def _grow(self, *pairs: tuple[float, int]) -> int:
        first = len(self._numbers)
        for number, role in pairs:
            self._numbers.append(number)
            self._roles.append(role)
        return first

    def _add(self, entity):
        self.entities[entity.name] = entity
        self._solver = None
        return entity

    def _own(self, entity: Entity, kind: type) -> None:
        if not isinstance(entity, kind):
            what = entity.what if isinstance(entity, Entity) else repr(entity)
            raise UnknownEntity(
                f"{what} where a {kind.what} is needed", valid=f"a {kind.what} of this sketch"
            )
        if entity.sketch is not self or self.entities.get(entity.name) is not entity:
            raise UnknownEntity(
                f"{entity.name!r} is of another sketch", valid="an entity of this one"
            )

    def _find(self, entity: Entity | str) -> Entity:
        if isinstance(entity, str):
            return self.entity(entity)
        self._own(entity, Entity)
        return entity

    def _line(self, kind: type, a, b, name: str | None):
        name = self._name(name, kind.what)
        points = isinstance(a, Entity) or isinstance(b, Entity)
        if points:
            for p in (a, b):
                self._own(p, Point)
        (px, py), (qx, qy) = ((p.position if points else _two(p, name)) for p in (a, b))
        if px == qx and py == qy:
            raise DegenerateSketch(
                f"the two points of {name} coincide", valid="two different points"
            )
        theta = math.atan2(qy - py, qx - px)
        offset = math.cos(theta) * 0.5 * (py + qy) - math.sin(theta) * 0.5 * (px + qx)
        variable = self._grow((theta, DIRECTION), (offset, OFFSET))
        line = self._add(kind(self, name, variable, (a, b) if points else None))
        ends = (a.variable, b.variable) if points else (-1, -1)
        self._line_ends.append((variable, *ends))
        if points:
            for which, p in (("start", a), ("end", b)):
                self._constrain("incident", (p, line), name=f"{name}.{which}", built_in=True)
        return line

    def _round(self, center, radius: float, name: str) -> tuple[int, Point]:
        if isinstance(center, Entity):
            self._own(center, Point)
        else:
            center = self.point(*_two(center, name), name=f"{name}.center")
        return self._grow((radius, RADIUS)), center

    def _constrain(
        self, kind, entities, value=None, name=None, driven=False, built_in=False, options=None
    ):
        form, entities = form_of(kind, entities)
        name = self._name(name, kind)
        constraint = Constraint(
            name,
            kind,
            entities,
            None,
            math.nan,
            driven,
            built_in,
            len(self._codes),
            0,
            options or {},
        )
        if form.unit:
            given = measured(constraint, self._numbers) if value is None or driven else value
            constraint.number = self._dimension(constraint, given)
            constraint.given = given
        elif value is not None:
            raise BadDimension(
                f"{kind} {name} with the value {value}", valid=f"{kind} takes no value"
            )
        if not driven:
            self._append(constraint, form.rows(self._numbers, *entities, **constraint.options))
        self._remember(constraint)
        self.constraints[name] = constraint
        self._ordered.append(constraint)
        self._solver = None
        return constraint

    def _append(self, constraint: Constraint, rows) -> None:
        constraint.n_rows = len(rows)
        number = constraint.number if constraint.given is not None else 0.0
        for row in rows:
            self._codes.append(row.code)
            self._vars.extend(row.var + (-1,) * (8 - len(row.var)))
            self._coefs.extend(row.coef + (0.0,) * (4 - len(row.coef)))
            self._scales.append(row.scale)
            self._offsets.append(row.offset)
            self._values.append(row.offset + row.scale * number)
            self._grounds.append(row.ground)
            self._owners.append(len(self._ordered))

    def _dimension(self, constraint: Constraint, given: float | str) -> float:
        """The value of a dimension, checked for its kind."""
        with at(f"{constraint.kind} {constraint.name}"):
            if isinstance(given, str):
                number = evaluated(given, self._scope(names_in(given)))
            else:
                number = _number(given, "value")
            points = all(isinstance(e, Point) for e in constraint.entities)
            if constraint.kind == "angle":
                if not 0.0 <= number <= math.pi:
                    raise BadDimension(f"an angle of {number} rad", valid="0 to pi")
            elif number < 0.0 or (number == 0.0 and (constraint.kind != "distance" or points)):
                valid = "above 0" if constraint.kind != "distance" or points else "0 or above"
                if constraint.kind == "distance" and points:
                    valid += " (coincident joins two points)"
                raise BadDimension(f"a {constraint.kind} of {number}", valid=valid)
        return number

    def _scope(self, names: Iterable[str]) -> dict[str, float]:
        scope = dict(self.parameters)
        for name in names:
            if name in self.constraints and self.constraints[name].given is not None:
                scope[name] = self.value(name)
        return scope

    def _remember(self, constraint: Constraint) -> None:
        if isinstance(constraint.given, str):
            for name in names_in(constraint.given):
                self._users.setdefault(name, []).append(constraint)

    def _forget(self, constraint: Constraint) -> None:
        if isinstance(constraint.given, str):
            for name in names_in(constraint.given):
                self._users[name].remove(constraint)

    def _propagate(self, name: str, depth: int = 0) -> None:
        """Writes a changed dimension into its rows and follows the expressions that use it."""
        if depth > 100:
            raise BadDimension(f"{name} depends on itself", valid="expressions without a circle")
        if name in self.constraints:
            constraint = self.constraints[name]
            if isinstance(constraint.given, str):
                constraint.number = self._dimension(constraint, constraint.given)
            if self._solver is not None:
                self._solver.changed(constraint)
        for user in self._users.get(name, []):
            self._propagate(user.name, depth + 1)


def _number(value: float, where: str) -> float:
    try:
        number = float(value)
    except (TypeError, ValueError):
        raise NotFinite(
            f"{value!r} is not a number", where=where, valid="a finite number"
        ) from None
    if not math.isfinite(number):
        raise NotFinite(f"the value is {number}", where=where, valid="a finite number")
    return number


def _two(position: Sequence[float], where: str) -> tuple[float, float]:
    try:
        x, y = position
    except (TypeError, ValueError):
        raise BadShape(
            f"{position!r} is not a position", where=where, valid="two numbers"
        ) from None
    return _number(x, where), _number(y, where)

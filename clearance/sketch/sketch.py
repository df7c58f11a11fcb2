"""The sketch as a user builds it: entities, constraints, parameters; checked on entry, solved on demand.

Its names are kept by `register`, its dimensions by `relations`; here is what is drawn, and each kind of constraint
as a method of its own, so that an editor and a type checker see it.
"""

from __future__ import annotations

import math
from collections.abc import Iterable, Sequence, Set
from pathlib import Path
from typing import TYPE_CHECKING, TypeVar

import numpy as np

from clearance.errors import BadShape
from clearance.sketch.constraints import Constraint
from clearance.sketch.effort import SECONDS, TimeLimit
from clearance.sketch.entities import Arc, Circle, Entity, Line, Point, Polyline, Segment
from clearance.sketch.faults import DegenerateSketch
from clearance.sketch.graph.graph import DIRECTION, OFFSET, RADIUS, X, Y
from clearance.sketch.register import number, two
from clearance.sketch.relations import Relations
from clearance.sketch.result import SketchResult
from clearance.sketch.solver import Solver

if TYPE_CHECKING:
    from clearance.planar.curve import Curve

Given = Entity | str
"""An entity of the sketch, or its name."""
Value = float | str | None
"""A number, an expression of parameters and dimensions, or None for what is drawn."""
Place = Point | Sequence[float]
"""A point of the sketch, or two numbers [m]."""
L = TypeVar("L", bound=Line)
Name = str | None
"""A name that is used once, or None for the next one that is free."""


class Sketch(Relations):
    """A plane sketch of points, lines and circles, and what must be true of them.

    The methods add entities and constraints and set dimensions; `solve` moves the entities so that every
    constraint holds. Lengths [m], angles [rad].

    Attributes:
        entities, constraints, parameters: by name.
        polylines: in the order in which they were added.
        most_seconds: [s] after which a solve stops, unless it has a limit of its own.
    """

    def __init__(self) -> None:
        super().__init__()
        self._solver: Solver | None = None
        self.polylines: list[Polyline] = []
        self.most_seconds: float = SECONDS

    def point(self, x: float, y: float, *, name: Name = None) -> Point:
        """A new point at (x, y) [m]."""
        name = self._new_name(name, "point")
        x, y = self._lists.local(number(x, f"{name}.x"), number(y, f"{name}.y"))
        variable = self._lists.append_numbers((x, X), (y, Y))
        return self._enter(Point(self, name, variable))

    def line(self, a: Point | Sequence[float], b: Place, *, name: Name = None) -> Line:
        """A new infinite line through two points of the sketch, or drawn through two pairs of
        numbers.

        Raises:
            DegenerateSketch: the two points coincide.
        """
        return self._drawn_line(Line, a, b, name)

    def segment(self, a: Point | Sequence[float], b: Place, *, name: Name = None) -> Segment:
        """A new segment between two points of the sketch (or pairs of numbers, which become points)."""
        a, b = (self._as_point(p, "segment") for p in (a, b))
        return self._drawn_line(Segment, a, b, name)

    def circle(self, center: Place, radius: float, *, name: Name = None) -> Circle:
        """A new circle about a point of the sketch, or about a new point at a pair of numbers."""
        name = self._new_name(name, "circle")
        radius = number(radius, f"{name}.radius")
        if radius <= 0.0:
            raise DegenerateSketch(f"the radius of {name} is {radius}", valid="a radius above 0")
        middle = self._center(center, name)
        variable = self._lists.append_numbers((radius, RADIUS))
        return self._enter(Circle(self, name, variable, middle))

    def arc(self, center: Place, start: Point, end: Point, *, name: Name = None) -> Arc:
        """A new arc about a centre, counter-clockwise from `start` to `end`, which lie on its circle."""
        name = self._new_name(name, "arc")
        for p in (start, end, *([center] if isinstance(center, Entity) else [])):
            self._of_kind(p, Point)
        radius = math.dist(self._local(center, name), self._local(start, name))
        if radius == 0.0:
            raise DegenerateSketch(f"{name} starts at its centre", valid="a radius above 0")
        middle = self._center(center, name)
        variable = self._lists.append_numbers((radius, RADIUS))
        arc = self._enter(Arc(self, name, variable, middle, start, end))
        self._tie(arc, start=start, end=end)
        return arc

    def polyline(self, points: Iterable[Place], *, closed: bool = False) -> Polyline:
        """New segments through points of the sketch (or pairs of numbers, which become points)."""
        ends = [self._as_point(p, "polyline") for p in points]
        if len(ends) < 2:
            raise BadShape(f"a polyline of {len(ends)} points", valid="at least 2")
        pairs = list(zip(ends, ends[1:] + ends[:1], strict=True))
        segments = [self.segment(*p) for p in (pairs if closed else pairs[:-1])]
        self.polylines.append(Polyline(ends, segments, closed))
        return self.polylines[-1]

    def add(
        self,
        kind: str,
        *entities: Given,
        value: Value = None,
        name: Name = None,
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
        own = tuple(self._own(e) for e in entities)
        return self._relate(kind, own, value=value, name=name, driven=driven, inside=inside)

    def fix(self, entity: Given, *, name: Name = None) -> Constraint:
        """Fixes an entity where it is drawn."""
        return self.add("fix", entity, name=name)

    def distance(
        self, a: Given, b: Given, value: Value = None, *, name: Name = None, driven: bool = False
    ) -> Constraint:
        """Distance [m] of two points, a point and a line or circle, or two lines (made parallel)."""
        return self.add("distance", a, b, value=value, name=name, driven=driven)

    def incident(self, a: Given, b: Given, *, name: Name = None) -> Constraint:
        """A point lies on a line or circle."""
        return self.add("incident", a, b, name=name)

    def coincident(self, a: Given, b: Given, *, name: Name = None) -> Constraint:
        """Two points, or two lines, are one."""
        return self.add("coincident", a, b, name=name)

    def tangent(
        self, a: Given, b: Given, *, inside: bool | None = None, name: Name = None
    ) -> Constraint:
        """A line touches a circle, or two circles touch. Solving keeps the side that was drawn."""
        return self.add("tangent", a, b, inside=inside, name=name)

    def angle(
        self, a: Given, b: Given, value: Value = None, *, name: Name = None, driven: bool = False
    ) -> Constraint:
        """Angle [rad], 0 to pi, between the directions of two lines; the turn is as drawn."""
        return self.add("angle", a, b, value=value, name=name, driven=driven)

    def parallel(self, a: Given, b: Given, *, name: Name = None) -> Constraint:
        """Two lines are parallel."""
        return self.add("parallel", a, b, name=name)

    def perpendicular(self, a: Given, b: Given, *, name: Name = None) -> Constraint:
        """Two lines are perpendicular."""
        return self.add("perpendicular", a, b, name=name)

    def concentric(self, a: Given, b: Given, *, name: Name = None) -> Constraint:
        """Two circles have one centre, or a point is a circle's centre."""
        return self.add("concentric", a, b, name=name)

    def horizontal(self, *entities: Given, name: Name = None) -> Constraint:
        """A line, or two points, lie along x."""
        return self.add("horizontal", *entities, name=name)

    def vertical(self, *entities: Given, name: Name = None) -> Constraint:
        """A line, or two points, lie along y."""
        return self.add("vertical", *entities, name=name)

    def radius(
        self, circle: Given, value: Value = None, *, name: Name = None, driven: bool = False
    ) -> Constraint:
        """Radius [m] of a circle."""
        return self.add("radius", circle, value=value, name=name, driven=driven)

    def diameter(
        self, circle: Given, value: Value = None, *, name: Name = None, driven: bool = False
    ) -> Constraint:
        """Diameter [m] of a circle."""
        return self.add("diameter", circle, value=value, name=name, driven=driven)

    def equal_length(self, a: Given, b: Given, *, name: Name = None) -> Constraint:
        """Two lines with points are equally long."""
        return self.add("equal_length", a, b, name=name)

    def equal_radius(self, a: Given, b: Given, *, name: Name = None) -> Constraint:
        """Two circles have one radius."""
        return self.add("equal_radius", a, b, name=name)

    def ratio(
        self, a: Given, b: Given, value: Value = None, *, name: Name = None, driven: bool = False
    ) -> Constraint:
        """Length (or radius) of a over that of b."""
        return self.add("ratio", a, b, value=value, name=name, driven=driven)

    def midpoint(self, m: Given, *ends: Given, name: Name = None) -> Constraint:
        """A point is the middle of a line with points, or of two points."""
        return self.add("midpoint", m, *ends, name=name)

    def symmetric(self, a: Given, b: Given, line: Given, *, name: Name = None) -> Constraint:
        """Two points, or two circles, are mirror images in a line."""
        return self.add("symmetric", a, b, line, name=name)

    def same_side(self, a: Given, b: Given, line: Given, *, name: Name = None) -> Constraint:
        """Two points lie on one side of a line."""
        return self.add("same_side", a, b, line, name=name)

    def solve(self, *, seconds: float | None = None) -> SketchResult:
        """Moves the entities least so that every constraint holds; see `SketchResult`.

        An inconsistent sketch stays as it is, and so does one that is not solved in time.

        Args:
            seconds: [s] of processor time after which searches stop, checked between their steps;
                `most_seconds` if not given. What is solved in time does not depend on it.

        Raises:
            DegenerateSketch: the solution would leave a line or circle without extent. BadDimension: no number of
                seconds.
        """
        limit = TimeLimit(self.most_seconds if seconds is None else seconds)
        return self._result(*self._engine().solve(limit))

    def drag(self, point: Point, position: Sequence[float]) -> SketchResult:
        """Brings a point as near to `position` as the constraints allow; all else moves least."""
        self._of_kind(point, Point)
        limit = TimeLimit(self.most_seconds)
        return self._result(*self._engine().drag(point, two(position, "drag"), limit))

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

    @property
    def origin(self) -> np.ndarray:
        """(2,) [m] what the numbers are counted from: the first place that was drawn."""
        return self._lists.origin

    def numbers(self, first: int, count: int) -> list[float]:
        """Part of the flat vector of all entities' numbers; for the entities."""
        return self._lists.numbers[first : first + count]

    def sides(self, chosen: Set[int] | None = None) -> list[tuple[int, int, int]]:
        """The variables of every `same_side` (of the chosen constraints by index): two points, a line."""
        return self._lists.sides(chosen)

    def _drawn_line(self, kind: type[L], a: Place, b: Place, name: Name) -> L:
        """A new line or segment."""
        name = self._new_name(name, kind.what)
        ends = None
        if isinstance(a, Entity) or isinstance(b, Entity):
            ends = self._of_kind(a, Point), self._of_kind(b, Point)
        p, q = (self._local(place, name) for place in ends or (a, b))
        line = self._enter(kind(self, name, self._line_numbers(p, q, name), ends))
        variables = (-1, -1) if ends is None else (ends[0].variable, ends[1].variable)
        self._lists.line_ends.extend((line.variable, *variables))
        if ends is not None:
            self._tie(line, start=ends[0], end=ends[1])
        return line

    def _line_numbers(self, p: Sequence[float], q: Sequence[float], name: str) -> int:
        """The first variable of a new line through two places: its direction, then its offset."""
        (px, py), (qx, qy) = p, q
        if px == qx and py == qy:
            raise DegenerateSketch(
                f"the two points of {name} coincide", valid="two different points"
            )
        theta = math.atan2(qy - py, qx - px)
        offset = math.cos(theta) * 0.5 * (py + qy) - math.sin(theta) * 0.5 * (px + qx)
        return self._lists.append_numbers((theta, DIRECTION), (offset, OFFSET))

    def _as_point(self, place: Place, where: str) -> Point:
        """The point itself, or a new point at two numbers."""
        return place if isinstance(place, Entity) else self.point(*two(place, where))

    def _center(self, center: Place, name: str) -> Point:
        """The centre of a circle: a point of the sketch, or a new one named after the circle."""
        if isinstance(center, Entity):
            return self._of_kind(center, Point)
        return self.point(*two(center, name), name=f"{name}.center")

    def _local(self, place: Place, name: str) -> Sequence[float]:
        """The coordinates of a point or of two numbers, counted from the sketch's origin."""
        if isinstance(place, Entity):
            return self.numbers(place.variable, 2)
        return self._lists.local(*two(place, name))

    def _tie(self, entity: Line | Arc, **points: Point) -> None:
        """Puts the points on the entity, by constraints named after it."""
        for which, p in points.items():
            name = f"{entity.name}.{which}"
            self._relate("incident", (p, entity), name=name, built_in=True)

    def _result(self, *found) -> SketchResult:
        return SketchResult(self, *found)

    def _engine(self) -> Solver:
        if self._solver is None or not self._solver.knows_all():
            self._solver = Solver(self)
        return self._solver

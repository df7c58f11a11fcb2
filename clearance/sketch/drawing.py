"""The entities of a sketch as they are drawn: their numbers, and the incidences that tie them to points."""

from __future__ import annotations

import math
from collections.abc import Iterable, Sequence
from typing import TypeVar

from clearance.errors import BadShape
from clearance.sketch.entities import Arc, Circle, Entity, Line, Point, Polyline, Segment
from clearance.sketch.faults import DegenerateSketch
from clearance.sketch.graph.graph import DIRECTION, OFFSET, RADIUS, X, Y
from clearance.sketch.lists import FlatLists
from clearance.sketch.register import Register, number, two
from clearance.sketch.relations import Relations

Place = Point | Sequence[float]
"""A point of the sketch, or two numbers [m]."""
L = TypeVar("L", bound=Line)


class Drawing:
    """Adds entities to a sketch's register and lists."""

    def __init__(self, register: Register, lists: FlatLists, relations: Relations) -> None:
        self._register = register
        self._lists = lists
        self._relations = relations
        self._sketch = register.sketch

    def point(self, x: float, y: float, name: str | None = None) -> Point:
        """See `Sketch.point`."""
        name = self._register.new_name(name, "point")
        x, y = self._lists.local(number(x, f"{name}.x"), number(y, f"{name}.y"))
        variable = self._lists.append_numbers((x, X), (y, Y))
        return self._register.add(Point(self._sketch, name, variable))

    def line(self, kind: type[L], a: Place, b: Place, name: str | None) -> L:
        """A new line or segment; see `Sketch.line`."""
        name = self._register.new_name(name, kind.what)
        ends = self._points(a, b)
        places = (a, b) if ends is None else ends
        p, q = (self._local(place, name) for place in places)
        line = self._register.add(kind(self._sketch, name, self._line_numbers(p, q, name), ends))
        variables = (-1, -1) if ends is None else (ends[0].variable, ends[1].variable)
        self._lists.line_ends.extend((line.variable, *variables))
        if ends is not None:
            self._tie(line, start=ends[0], end=ends[1])
        return line

    def segment(self, a: Place, b: Place, name: str | None = None) -> Segment:
        """See `Sketch.segment`."""
        a, b = (self._as_point(p, "segment") for p in (a, b))
        return self.line(Segment, a, b, name)

    def circle(self, center: Place, radius: float, name: str | None = None) -> Circle:
        """See `Sketch.circle`."""
        name = self._register.new_name(name, "circle")
        radius = number(radius, f"{name}.radius")
        if radius <= 0.0:
            raise DegenerateSketch(f"the radius of {name} is {radius}", valid="a radius above 0")
        middle = self._center(center, name)
        variable = self._lists.append_numbers((radius, RADIUS))
        return self._register.add(Circle(self._sketch, name, variable, middle))

    def arc(self, center: Place, start: Point, end: Point, name: str | None = None) -> Arc:
        """See `Sketch.arc`."""
        name = self._register.new_name(name, "arc")
        for p in (start, end, *([center] if isinstance(center, Entity) else [])):
            self._register.of_kind(p, Point)
        radius = math.dist(self._local(center, name), self._local(start, name))
        if radius == 0.0:
            raise DegenerateSketch(f"{name} starts at its centre", valid="a radius above 0")
        middle = self._center(center, name)
        variable = self._lists.append_numbers((radius, RADIUS))
        arc = self._register.add(Arc(self._sketch, name, variable, middle, start, end))
        self._tie(arc, start=start, end=end)
        return arc

    def polyline(self, points: Iterable[Place], closed: bool) -> Polyline:
        """See `Sketch.polyline`."""
        ends = [self._as_point(p, "polyline") for p in points]
        if len(ends) < 2:
            raise BadShape(f"a polyline of {len(ends)} points", valid="at least 2")
        pairs = list(zip(ends, ends[1:] + ends[:1], strict=True))
        return Polyline(ends, [self.segment(*p) for p in (pairs if closed else pairs[:-1])], closed)

    def _as_point(self, place: Place, where: str) -> Point:
        """The point itself, or a new point at two numbers."""
        return place if isinstance(place, Entity) else self.point(*two(place, where))

    def _center(self, center: Place, name: str) -> Point:
        """The centre of a circle: a point of the sketch, or a new one named after the circle."""
        if isinstance(center, Entity):
            return self._register.of_kind(center, Point)
        return self.point(*two(center, name), name=f"{name}.center")

    def _points(self, a: Place, b: Place) -> tuple[Point, Point] | None:
        """The two points of a line; None where it is drawn through two pairs of numbers."""
        if not (isinstance(a, Entity) or isinstance(b, Entity)):
            return None
        return self._register.of_kind(a, Point), self._register.of_kind(b, Point)

    def _local(self, place: Place, name: str) -> Sequence[float]:
        """The coordinates of a point or of two numbers, counted from the sketch's origin."""
        if isinstance(place, Entity):
            return self._lists.numbers[place.variable : place.variable + 2]
        return self._lists.local(*two(place, name))

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

    def _tie(self, entity: Line | Arc, **points: Point) -> None:
        """Puts the points on the entity, by constraints named after it."""
        for which, p in points.items():
            name = f"{entity.name}.{which}"
            self._relations.add("incident", (p, entity), name=name, built_in=True)

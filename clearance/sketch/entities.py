"""The things a sketch is made of: points, infinite lines and circles, and segments, arcs, polylines
on them.

An entity is a handle: its numbers live in the sketch's one flat vector and change when the sketch
is solved. Lengths [m], directions as unit vectors; a line runs from its first point to its second.
"""

from __future__ import annotations

import math

import numpy as np


class Entity:
    """The base of all entities: their sketch, a name, unique in it, and the place of their numbers there."""

    what = "entity"

    def __init__(self, sketch, name: str, variable: int) -> None:
        self.sketch = sketch
        self.name = name
        self.variable = variable

    def __repr__(self) -> str:
        return f"<{self.what} {self.name}>"


class Point(Entity):
    """A point: 2 degrees of freedom."""

    what = "point"

    @property
    def position(self) -> np.ndarray:
        """(2,) coordinates [m]."""
        return self.sketch.origin + self.sketch.numbers(self.variable, 2)


class Line(Entity):
    """An infinite line: 2 degrees of freedom; `ends` are the two points it was drawn through, if
    any."""

    what = "line"

    def __init__(self, sketch, name: str, variable: int, ends: tuple[Point, Point] | None) -> None:
        super().__init__(sketch, name, variable)
        self.ends = ends

    @property
    def direction(self) -> np.ndarray:
        """(2,) unit vector from the first towards the second point."""
        theta = self.sketch.numbers(self.variable, 1)[0]
        return np.array([math.cos(theta), math.sin(theta)])

    @property
    def offset(self) -> float:
        """[m] signed distance of the line from the origin along its normal (-sin, cos)."""
        d = self.direction
        moment = d[0] * self.sketch.origin[1] - d[1] * self.sketch.origin[0]
        return float(self.sketch.numbers(self.variable, 2)[1] + moment)

    @property
    def foot(self) -> np.ndarray:
        """(2,) [m] a point of the line, near the sketch."""
        offset, d = self.sketch.numbers(self.variable, 2)[1], self.direction
        return self.sketch.origin + offset * np.array([-d[1], d[0]])

    @property
    def length(self) -> float:
        """[m] distance of its two points; NaN without points."""
        if self.ends is None:
            return math.nan
        a, b = (self.sketch.numbers(p.variable, 2) for p in self.ends)
        return math.dist(a, b)


class Segment(Line):
    """The part of a line between two points."""

    what = "segment"
    ends: tuple[Point, Point]


class Circle(Entity):
    """A circle: its centre is a point of the sketch (2 degrees of freedom), its radius one more."""

    what = "circle"

    def __init__(self, sketch, name: str, variable: int, center: Point) -> None:
        super().__init__(sketch, name, variable)
        self.center = center

    @property
    def radius(self) -> float:
        """[m]"""
        return float(self.sketch.numbers(self.variable, 1)[0])


class Arc(Circle):
    """The part of a circle from `start` to `end`, counter-clockwise."""

    what = "arc"

    def __init__(
        self, sketch, name: str, variable: int, center: Point, start: Point, end: Point
    ) -> None:
        super().__init__(sketch, name, variable, center)
        self.start = start
        self.end = end


class Polyline:
    """Segments end to end through `points`; `closed` returns to the first."""

    def __init__(self, points: list[Point], segments: list[Segment], closed: bool) -> None:
        self.points = points
        self.segments = segments
        self.closed = closed

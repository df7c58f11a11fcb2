"""The sketch as a user builds it: entities, constraints, parameters; checked on entry, solved on demand.

Not for: how a sketch is solved (`execution`), nor its files (`sketch_file`).
"""

from __future__ import annotations

import math
from collections.abc import Iterable, Sequence
from pathlib import Path
from typing import TYPE_CHECKING

from clearance.errors import BadShape
from clearance.kernels.sketch.graph.graph import DIRECTION, OFFSET, RADIUS, X, Y
from clearance.sketch.checked import number, two
from clearance.sketch.entities import Arc, Circle, Entity, Line, Point, Polyline, Segment
from clearance.sketch.faults import DegenerateSketch
from clearance.sketch.relations import Relations

if TYPE_CHECKING:
    from clearance.planar.curve import Curve
    from clearance.sketch.result import SketchResult


class Sketch(Relations):
    """A plane sketch of points, lines and circles, and what must be true of them.

    Entities are added by the methods below, constraints by those of `Relations`, dimensions are set by
    those of `Dimensions`; `solve` moves the entities so that every constraint holds. Lengths [m],
    angles [rad].
    """

    def __init__(self) -> None:
        super().__init__()
        self.polylines: list[Polyline] = []

    def point(self, x: float, y: float, *, name: str | None = None) -> Point:
        """A new point at (x, y) [m]."""
        name = self._name(name, "point")
        x, y = self._local(number(x, f"{name}.x"), number(y, f"{name}.y"))
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
        a, b = (p if isinstance(p, Entity) else self.point(*two(p, "segment")) for p in (a, b))
        return self._line(Segment, a, b, name)

    def circle(
        self, center: Point | Sequence[float], radius: float, *, name: str | None = None
    ) -> Circle:
        """A new circle about a point of the sketch, or about a new point at a pair of numbers."""
        name = self._name(name, "circle")
        radius = number(radius, f"{name}.radius")
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
        c = self._place(center) if isinstance(center, Entity) else self._local(*two(center, name))
        radius = math.dist(c, self._place(start))
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
        ends = [p if isinstance(p, Entity) else self.point(*two(p, "polyline")) for p in points]
        if len(ends) < 2:
            raise BadShape(f"a polyline of {len(ends)} points", valid="at least 2")
        pairs = list(zip(ends, ends[1:] + ends[:1], strict=True))
        out = Polyline(ends, [self.segment(*p) for p in (pairs if closed else pairs[:-1])], closed)
        self.polylines.append(out)
        return out

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
        return self._result(*self._engine().drag(point, two(position, "drag")))

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

    def _place(self, point: Point) -> list[float]:
        """A point's coordinates as counted from the origin."""
        return self._numbers[point.variable : point.variable + 2]

    def _result(self, problem, before, outcome) -> SketchResult:
        from clearance.sketch.result import SketchResult

        return SketchResult(self, problem, before, outcome)

    def _engine(self):
        from clearance.sketch.solver import Solver

        if self._solver is None:
            self._solver = Solver(self)
        return self._solver

    def _line(self, kind: type, a, b, name: str | None):
        name = self._name(name, kind.what)
        points = isinstance(a, Entity) or isinstance(b, Entity)
        if points:
            for p in (a, b):
                self._own(p, Point)
        places = [self._place(p) if points else self._local(*two(p, name)) for p in (a, b)]
        (px, py), (qx, qy) = places
        if px == qx and py == qy:
            raise DegenerateSketch(
                f"the two points of {name} coincide", valid="two different points"
            )
        theta = math.atan2(qy - py, qx - px)
        offset = math.cos(theta) * 0.5 * (py + qy) - math.sin(theta) * 0.5 * (px + qx)
        variable = self._grow((theta, DIRECTION), (offset, OFFSET))
        line = self._add(kind(self, name, variable, (a, b) if points else None))
        ends = (a.variable, b.variable) if points else (-1, -1)
        self._line_ends.extend((variable, *ends))
        if points:
            for which, p in (("start", a), ("end", b)):
                self._constrain("incident", (p, line), name=f"{name}.{which}", built_in=True)
        return line

    def _round(self, center, radius: float, name: str) -> tuple[int, Point]:
        if isinstance(center, Entity):
            self._own(center, Point)
        else:
            center = self.point(*two(center, name), name=f"{name}.center")
        return self._grow((radius, RADIUS)), center

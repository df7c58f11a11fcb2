"""A sketch as a shape of numbers: its free dimensions, and where it stands if nothing holds it.

Free are the driven dimensions of the sketch (or those named); the constraints hold at every shape, since each is
solved. Not for: choosing the numbers (`fit`).
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass
from functools import cached_property

import numpy as np

from clearance.errors import BadInput, BadShape, ClearanceError, nearest_name
from clearance.planar.curve import Curve
from clearance.profiles.contour import Contour, joined
from clearance.profiles.fit_rows import Slope
from clearance.profiles.outline_file import require_closed, require_solved
from clearance.profiles.pieces import Pieces
from clearance.sketch import Sketch
from clearance.sketch.entities import Arc, Circle, Segment
from clearance.sketch.outline import angles_of, chains, ends_of

LONGEST_ARC = 1.2
"""[rad] Arcs are cut into equal parts of at most this as drawn; fitting may double it before a bulge is lost."""


class NoFreeDimension(BadInput):
    """A sketch to be fitted that has no dimension to change."""


@dataclass(frozen=True, eq=False)
class Placed:
    """A shape: what the sketch draws, moved to where it stands.

    Attributes:
        numbers: (n,) the free dimensions, then x, y [m] and turn [rad] where they are free.
        contours: closed; always the same pieces.
    """

    numbers: np.ndarray
    contours: tuple[Contour, ...]

    @cached_property
    def pieces(self) -> Pieces:
        """For the search."""
        return Pieces(self.contours)

    @cached_property
    def curve(self) -> Curve:
        """For certified distances."""
        return joined(self.contours)

    @cached_property
    def area(self) -> float:
        """[m^2] that the contours enclose, holes taken off where they run the other way."""
        return abs(sum(contour.area for contour in self.contours))


class SketchShape:
    """A copy of a sketch in which the free dimensions are given.

    Raises:
        NoFreeDimension, BadInput (an unknown name), BadShape (contradictory; freedoms without a dimension).
    """

    def __init__(self, sketch: Sketch, free: Sequence[str] | None) -> None:
        require_solved(sketch)
        driven = [c.name for c in sketch.constraints.values() if c.driven]
        self.free = list(driven if free is None else free)
        self._check_names(sketch)
        self.sketch = copied(sketch, driving=set(self.free))
        kinds = {c.kind for c in sketch.constraints.values() if not c.built_in}
        self.slides = "fix" not in kinds
        self.turns = self.slides and not kinds & {"horizontal", "vertical"}
        result = self.sketch.solve()
        if not result.solved:
            raise BadShape(
                f"the constraints {', '.join(result.conflicts[:6])} contradict each other"
            )
        if result.freedom > 0:
            raise BadShape(
                f"{result.freedom} freedoms of the sketch have no dimension",
                valid="every shape is said by dimensions: add driven ones",
            )
        self.kinds = [self._kind(name) for name in self.free]
        drawn = self.sketch.curves()
        require_closed(drawn, "sketch")
        self._chains = self._drawn_chains()
        self._anchor = self._stand(self._contours())
        first = [float(self.sketch.value(name)) for name in self.free]
        self.start = np.array(first + ([0.0, 0.0] if self.slides else []) + [0.0] * self.turns)
        self.size = drawn.size
        lengths = [1.0 if kind == "angle" else self.size for kind in self.kinds]
        self.scale = np.array(lengths + [self.size] * (2 * self.slides) + [1.0] * self.turns)

    @property
    def held(self) -> list[str]:
        """Names of the dimensions that keep their value: numbers, not expressions."""
        given = [
            c.name
            for c in self.sketch.constraints.values()
            if not c.built_in
            and not c.driven
            and isinstance(c.given, float | int)
            and c.name not in self.free
        ]
        return [name for name in self.sketch.parameters if name not in self.free] + given

    def at(self, numbers: np.ndarray) -> Placed | None:
        """The shape of these numbers; None where the sketch cannot be drawn so."""
        try:
            for name, number in zip(self.free, numbers, strict=False):
                self.sketch.set(name, float(number))
            if not self.sketch.solve().solved:
                return None
            contours = self._contours()
        except ClearanceError:
            return None
        motion = self._motion(numbers[len(self.free) :], *self._stand(contours))
        moved = (c.vertices @ motion[:, :2].T + motion[:, 2] for c in contours)
        return Placed(
            numbers.copy(),
            tuple(Contour(v, c.bulges) for v, c in zip(moved, contours, strict=True)),
        )

    def changed(self, name: str, change: float, numbers: np.ndarray) -> Placed | None:
        """The shape with a held dimension changed; it is put back."""
        before = self.sketch.value(name)
        try:
            self.sketch.set(name, before + change)
            return self.at(numbers)
        except ClearanceError:
            return None
        finally:
            self.sketch.set(name, before)

    def slopes(self, here: Placed) -> list[Slope]:
        """For each number the shape a little further, or a little before where that cannot be drawn."""
        found = []
        for i, number in enumerate(here.numbers):
            step = 1e-6 * self.scale[i]
            if i < len(self.free):
                step = min(step, 1e-3 * abs(number)) or step
            found.append(
                self._slope(here, i, step)
                or self._slope(here, i, -step)
                or Slope(here.pieces, here.pieces, 0.0)
            )
        return found

    def _slope(self, here: Placed, i: int, step: float) -> Slope | None:
        numbers = here.numbers.copy()
        numbers[i] += step
        there = self.at(numbers)
        if there is None:
            return None
        width = float(numbers[i] - here.numbers[i])
        return Slope(here.pieces, there.pieces, width, (there.area - here.area) / width)

    def placed_sketch(self, numbers: np.ndarray, original: Sketch) -> Sketch:
        """The sketch itself at these numbers, free dimensions driven as they were."""
        self.at(numbers)
        motion = self._motion(numbers[len(self.free) :], *self._stand(self._contours()))
        driven = {c.name for c in original.constraints.values() if c.driven}
        return copied(self.sketch, motion=motion, released=driven)

    def _check_names(self, sketch: Sketch) -> None:
        known = [
            *sketch.parameters,
            *(c.name for c in sketch.constraints.values() if c.given is not None),
        ]
        for name in self.free:
            if name not in known:
                raise BadInput(
                    f"no dimension named {name!r}", where="free", valid=nearest_name(name, known)
                )
        if not self.free:
            raise NoFreeDimension(
                "the sketch has no free dimension",
                valid="mark some `driven: true`, or name them with --free",
            )

    def _kind(self, name: str) -> str:
        if name in self.sketch.parameters:
            return "parameter"
        return self.sketch.constraint(name).kind

    def _drawn_chains(self) -> list[list[tuple]]:
        """Closed chains of (entity, runs backwards, number of equal parts); circles alone."""
        entities = list(self.sketch.entities.values())
        parts = [e for e in entities if isinstance(e, Segment | Arc)]
        found = [
            [(e, back, self._parts(e)) for e, back in chain] for chain in chains(self.sketch, parts)
        ]
        return found + [[(e, False, 6)] for e in entities if type(e) is Circle]

    def _parts(self, entity) -> int:
        if isinstance(entity, Segment):
            return 1
        start, end = angles_of(entity)
        return max(1, math.ceil((end - start) / LONGEST_ARC))

    def _contours(self) -> tuple[Contour, ...]:
        """What the sketch draws now."""
        found = []
        for chain in self._chains:
            vertices, bulges = [], []
            for entity, back, n in chain:
                _draw(entity, back, n, vertices, bulges)
            found.append(Contour(np.array(vertices), np.array(bulges)))
        return tuple(found)

    def _stand(self, contours: tuple[Contour, ...]) -> tuple[np.ndarray, float]:
        """Where the drawing stands: its first vertex, and the direction to the next."""
        first, second = contours[0].vertices[:2]
        along = second - first
        return first, math.atan2(along[1], along[0])

    def _motion(self, place: np.ndarray, at: np.ndarray, turn: float) -> np.ndarray:
        """(2, 3) what brings a curve that stands at `at` with `turn` to its place.

        The anchor is the curve's first point in the sketch as drawn: solving may have moved it.
        """
        if not self.slides:
            return np.eye(2, 3)
        angle = (self._anchor[1] + float(place[2]) - turn) if self.turns else 0.0
        cosine, sine = math.cos(angle), math.sin(angle)
        matrix = np.array([[cosine, -sine], [sine, cosine]])
        shift = self._anchor[0] + place[:2] - matrix @ at
        return np.column_stack([matrix, shift])


def _draw(entity, back: bool, n: int, vertices: list, bulges: list) -> None:
    """Appends the start of each of `n` equal parts of an entity, and their bulge."""
    if isinstance(entity, Segment):
        vertices.append(ends_of(entity)[1 if back else 0].position)
        bulges.append(0.0)
        return
    start, end = angles_of(entity) if isinstance(entity, Arc) else (0.0, 2.0 * math.pi)
    bulge = math.tan(0.25 * (end - start) / n)
    center, radius = entity.center.position, entity.radius
    for k in range(n):
        angle = end - (end - start) * k / n if back else start + (end - start) * k / n
        place = center + radius * np.array([math.cos(angle), math.sin(angle)])
        if k == 0 and isinstance(entity, Arc):
            place = ends_of(entity)[1 if back else 0].position
        vertices.append(place)
        bulges.append(-bulge if back else bulge)


def copied(
    sketch: Sketch,
    *,
    driving: frozenset | set = frozenset(),
    released: frozenset | set = frozenset(),
    motion: np.ndarray | None = None,
) -> Sketch:
    """The same sketch again, some driven dimensions made driving or driving ones driven, all moved.

    Args:
        driving, released: names of constraints.
        motion: (2, 3) a rigid motion of the plane; only for sketches that nothing fixes.
    """
    motion = np.eye(2, 3) if motion is None else motion
    made = Sketch()
    for name, value in sketch.parameters.items():
        made.parameter(name, value)
    for entity in sketch.entities.values():
        _copy_entity(made, entity, motion)
    for c in sketch.constraints.values():
        if c.built_in:
            continue
        driven = (c.driven and c.name not in driving) or c.name in released
        value = c.given
        if value is not None and not isinstance(value, str):
            value = float(sketch.value(c.name))
        again = made.add(
            c.kind,
            *(entity.name for entity in c.entities),
            value=value,
            name=c.name,
            driven=driven,
            **c.options,
        )
        if driven:
            again.given = float(again.number)  # plain numbers, for files
    return made


def _copy_entity(made: Sketch, entity, motion: np.ndarray) -> None:
    def moved(point) -> list[float]:
        return (motion[:, :2] @ point + motion[:, 2]).tolist()

    name = entity.name
    if entity.what == "point":
        made.point(*moved(entity.position), name=name)
    elif entity.what == "circle":
        made.circle(made.entity(entity.center.name), entity.radius, name=name)
    elif entity.what == "arc":
        ends = (made.entity(p.name) for p in (entity.center, entity.start, entity.end))
        made.arc(*ends, name=name)
    else:
        if entity.ends is not None:
            ends = [made.entity(p.name) for p in entity.ends]
        else:
            foot = entity.offset * np.array([-entity.direction[1], entity.direction[0]])
            ends = [moved(foot - 0.5 * entity.direction), moved(foot + 0.5 * entity.direction)]
        (made.segment if entity.what == "segment" else made.line)(*ends, name=name)

"""A sketch as a shape of numbers: its free dimensions, and its place unless it is fixed.

Free are the driven dimensions of the sketch (or those named); the constraints hold at every shape, since each is
solved. Not for: choosing the numbers (`fit`).
"""

from __future__ import annotations

import math
from collections.abc import Sequence, Set
from dataclasses import dataclass, field
from functools import cached_property

import numpy as np

from clearance.errors import BadInput, BadShape, ClearanceError, nearest_name
from clearance.profiles.contour import Contour
from clearance.profiles.fit_rows import FitSlope, RigidSlope
from clearance.profiles.gap import ClosedContours
from clearance.profiles.outline_file import require_closed, require_solved
from clearance.sketch import Sketch
from clearance.sketch.entities import Arc, Circle, Segment
from clearance.sketch.outline import angles_of, chains, ends_of
from clearance.sketch.sketch_file import sketch_of, tree_of

LONGEST_ARC = 1.2
"""[rad] Arcs are cut into equal parts of at most this as drawn; fitting may double it before a bulge is lost."""

Chain = list[tuple]
"""(entity, runs backwards, number of equal parts) each."""


@dataclass(frozen=True, eq=False)
class PlacedShape(ClosedContours):
    """What a sketch draws, moved to where it stands; always the same pieces.

    Attributes:
        numbers: (n,) the free dimensions, then x, y [m] and turn [rad] where they are free.
    """

    numbers: np.ndarray = field(kw_only=True)

    @cached_property
    def area(self) -> float:
        """[m^2] that the contours enclose, less holes, which run in reverse."""
        return abs(sum(contour.area for contour in self.contours))


class NoFreeDimension(BadInput):
    """A sketch to be fitted that has no dimension to change."""


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
            raise BadShape(result.fault)
        if result.freedom > 0:
            raise BadShape(
                f"{result.freedom} freedoms of the sketch have no dimension",
                valid="every shape is said by dimensions: add driven ones",
            )
        self.kinds = [self._kind(name) for name in self.free]
        drawn = self.sketch.curves()
        require_closed(drawn, "sketch")
        self._chains = drawn_chains(self.sketch)
        self._anchor = self._stand(contours_of_chains(self._chains))
        first = [float(self.sketch.value(name)) for name in self.free]
        self.start = np.array(first + ([0.0, 0.0] if self.slides else []) + [0.0] * self.turns)
        self.size = drawn.size
        lengths = [1.0 if kind == "angle" else self.size for kind in self.kinds]
        self.scale = np.array(lengths + [self.size] * (2 * self.slides) + [1.0] * self.turns)
        angular = [kind == "angle" for kind in self.kinds]
        self.angular = np.array(angular + [False] * (2 * self.slides) + [True] * self.turns)

    @property
    def fixed(self) -> list[str]:
        """Names of the dimensions with a fixed value: numbers, not expressions."""
        given = [
            c.name
            for c in self.sketch.constraints.values()
            if not c.built_in
            and not c.driven
            and isinstance(c.given, float | int)
            and c.name not in self.free
        ]
        return [name for name in self.sketch.parameters if name not in self.free] + given

    def at(self, numbers: np.ndarray) -> PlacedShape | None:
        """The shape of these numbers; None where the sketch cannot be drawn so."""
        try:
            for name, number in zip(self.free, numbers, strict=False):
                self.sketch.set(name, float(number))
            if not self.sketch.solve().solved:
                return None
            contours = contours_of_chains(self._chains)
        except ClearanceError:
            return None
        motion = self._motion(numbers[len(self.free) :], *self._stand(contours))
        moved = (c.vertices @ motion[:, :2].T + motion[:, 2] for c in contours)
        placed = tuple(Contour(v, c.bulges) for v, c in zip(moved, contours, strict=True))
        return PlacedShape(placed, numbers=numbers.copy())

    def changed(self, name: str, change: float, numbers: np.ndarray) -> PlacedShape | None:
        """The shape with a fixed dimension changed; it is put back."""
        before = self.sketch.value(name)
        try:
            self.sketch.set(name, before + change)
            return self.at(numbers)
        except ClearanceError:
            return None
        finally:
            self.sketch.set(name, before)

    def slopes(self, here: PlacedShape) -> list[FitSlope | RigidSlope]:
        """How the shape changes with each number: the shape a little further, or before where that cannot be."""
        found: list[FitSlope | RigidSlope] = []
        for i in range(len(self.free)):
            step = 1e-6 * self.scale[i]
            step = min(step, 1e-3 * abs(here.numbers[i])) or step
            found.append(
                self._slope(here, i, step)
                or self._slope(here, i, -step)
                or FitSlope(here.pieces, here.pieces, 0.0)
            )
        pivot = here.contours[0].vertices[0]
        if self.slides:
            found += [RigidSlope(axis, pivot) for axis in np.eye(2)]
        if self.turns:
            found.append(RigidSlope(np.zeros(2), pivot, 1.0))
        return found

    def _slope(self, here: PlacedShape, i: int, step: float) -> FitSlope | None:
        numbers = here.numbers.copy()
        numbers[i] += step
        there = self.at(numbers)
        if there is None:
            return None
        width = float(numbers[i] - here.numbers[i])
        return FitSlope(here.pieces, there.pieces, width, (there.area - here.area) / width)

    def placed_sketch(self, numbers: np.ndarray, original: Sketch) -> Sketch:
        """The sketch itself at these numbers, free dimensions driven as they were."""
        self.at(numbers)
        motion = self._motion(
            numbers[len(self.free) :], *self._stand(contours_of_chains(self._chains))
        )
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

    def _stand(self, contours: tuple[Contour, ...]) -> tuple[np.ndarray, float]:
        """The place of the drawing: its first vertex, and the direction to the next."""
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


def copied(
    sketch: Sketch,
    *,
    driving: Set[str] = frozenset(),
    released: Set[str] = frozenset(),
    motion: np.ndarray | None = None,
) -> Sketch:
    """The same sketch again, some driven dimensions made driving or driving ones driven, all moved.

    Args:
        driving, released: names of constraints.
        motion: (2, 3) a rigid motion of the plane; only for sketches that nothing fixes.
    """
    turn, shift = np.split(np.eye(2, 3) if motion is None else motion, [2], axis=1)

    def moved(place: list[float]) -> list[float]:
        return (turn @ place + shift[:, 0]).tolist()

    tree = tree_of(sketch)
    tree["points"] = {name: moved(place) for name, place in tree.get("points", {}).items()}
    for name, ends in tree.get("lines", {}).items():
        if not isinstance(ends[0], str):
            tree["lines"][name] = [moved(end) for end in ends]
    for entry in tree.get("constraints", []):
        kept = entry.get("driven", False) and entry["name"] not in driving
        entry["driven"] = kept or entry["name"] in released
    made = sketch_of(tree, Sketch)
    made.most_seconds = sketch.most_seconds
    return made


def drawn_chains(sketch: Sketch) -> list[Chain]:
    """The closed chains of a sketch; circles alone."""
    entities = list(sketch.entities.values())
    parts = [e for e in entities if isinstance(e, Segment | Arc)]
    found = [[(e, back, _parts(e)) for e, back in chain] for chain in chains(sketch, parts)]
    return found + [[(e, False, 6)] for e in entities if type(e) is Circle]


def contours_of_chains(found: list[Chain]) -> tuple[Contour, ...]:
    """The drawing of the chains now."""
    contours = []
    for chain in found:
        vertices: list[np.ndarray] = []
        bulges: list[float] = []
        for entity, back, n in chain:
            _draw(entity, back, n, vertices, bulges)
        contours.append(Contour(np.array(vertices), np.array(bulges)))
    return tuple(contours)


def _parts(entity) -> int:
    if isinstance(entity, Segment):
        return 1
    start, end = angles_of(entity)
    return max(1, math.ceil((end - start) / LONGEST_ARC))


def _draw(entity, back: bool, n: int, vertices: list[np.ndarray], bulges: list[float]) -> None:
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

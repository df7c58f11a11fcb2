"""A sketch as a shape of numbers: its free dimensions, and where it stands if nothing holds it.

Free are the driven dimensions of the sketch (or those named); the constraints hold at every shape, since each is
solved. Not for: choosing the numbers (`fit`).
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from clearance.errors import BadInput, BadShape, ClearanceError, nearest_name
from clearance.planar.curve import Curve
from clearance.profiles.outline_file import require_solved
from clearance.sketch import Sketch

NODES, WEIGHTS = np.polynomial.legendre.leggauss(8)


class NoFreeDimension(BadInput):
    """A sketch to be fitted that has no dimension to change."""


@dataclass(frozen=True, eq=False)
class Placed:
    """A shape: the sketch's curve moved to where it stands.

    Attributes:
        numbers: (n,) the free dimensions, then x, y [m] and turn [rad] where they are free.
    """

    numbers: np.ndarray
    curve: Curve
    area: float


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
        self._anchor = self._stand(self.sketch.curves())
        first = [float(self.sketch.value(name)) for name in self.free]
        self.start = np.array(first + ([0.0, 0.0] if self.slides else []) + [0.0] * self.turns)
        self.size = self.sketch.curves().size
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
            curve = self._moved(self.sketch.curves(), numbers[len(self.free) :])
        except ClearanceError:
            return None
        return Placed(numbers.copy(), curve, area_of(curve))

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

    def slopes(self, here: Placed) -> list[tuple[Placed, Placed, float]]:
        """For each number the shapes a little below and above, and how far apart their numbers are.

        A shape that cannot be drawn is replaced by `here`; where neither can, the width is 0.
        """
        found = []
        for i, number in enumerate(here.numbers):
            step = 1e-5 * self.scale[i]
            if i < len(self.free):
                step = min(step, 1e-3 * abs(number)) or step
            ahead, behind = here.numbers.copy(), here.numbers.copy()
            ahead[i] += step
            behind[i] -= step
            pair = (self.at(behind) or here, self.at(ahead) or here)
            found.append((*pair, float(pair[1].numbers[i] - pair[0].numbers[i])))
        return found

    def placed_sketch(self, numbers: np.ndarray, original: Sketch) -> Sketch:
        """The sketch itself at these numbers, free dimensions driven as they were."""
        self.at(numbers)
        center, turn = self._stand(self.sketch.curves())
        motion = self._motion(numbers[len(self.free) :], center, turn)
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

    def _stand(self, curve: Curve) -> tuple[np.ndarray, float]:
        """Where a drawn curve stands: its first point, and the direction of its start."""
        start = curve.limits[0, 0]
        along = curve.derivative(np.array([start]))[0]
        return curve.point(np.array([start]))[0], math.atan2(along[1], along[0])

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

    def _moved(self, curve: Curve, place: np.ndarray) -> Curve:
        if not self.slides:
            return curve
        return curve.transformed(self._motion(place, *self._stand(curve)))


def area_of(curve: Curve) -> float:
    """The area that closed contours of lines and arcs enclose, signed by sense; to about 1e-14 relative."""
    low, high = curve.limits.T
    at = (0.5 * (low + high))[:, None] + (0.5 * (high - low))[:, None] * NODES
    point, speed = curve.point(at), curve.derivative(at)
    middle = curve.box.mean(axis=0)
    cross = (point[..., 0] - middle[0]) * speed[..., 1] - (point[..., 1] - middle[1]) * speed[
        ..., 0
    ]
    return float(0.5 * np.sum((cross @ WEIGHTS) * 0.5 * (high - low)))


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

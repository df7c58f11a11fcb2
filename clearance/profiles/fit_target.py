"""The relation of a fitted sketch to an outline: near, around or clear of it; rows to search by, and the proof.

Also what all searches share: places on the shape and the bounds of a step.
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from clearance.planar.hausdorff import hausdorff
from clearance.planar.minimum import Minimum
from clearance.profiles.fit_rows import (
    FitRows,
    Gaps,
    at_corner,
    gaps_of_outline,
    gaps_of_shape,
    joined_gaps,
    sides_of,
)
from clearance.profiles.fit_shape import PlacedShape, SketchShape
from clearance.profiles.gap import ClosedContours, proven_gap
from clearance.profiles.outline_file import DrawnOutline
from clearance.profiles.pieces import ContourPieces
from clearance.profiles.region import contains

MOST_GIVEN = 3000
"""Points of the outline that give rows."""

MOST_ROWS = 700
"""Rows of a linear program: those nearest to mattering."""

SAMPLES = 16
"""Places on each piece of the shape."""

ALONG = 0.2
"""[-] Sine of the angle to a piece below which a direction is along it."""

STEPS = 30
"""Linear programs that one search may solve."""

SHRINK = 0.05
"""[-] The least share of a length that remains after one step."""

FLOOR = 1e-6
"""[-] Lengths are not made shorter than this, relative to the sketch: it could not be drawn at 0."""

Places = tuple[np.ndarray, np.ndarray]
"""Pieces and shares of places on a shape."""


@dataclass(frozen=True, eq=False)
class FitCandidate:
    """A shape at the end of a search.

    Attributes:
        score: Hausdorff distance [m], or area [m^2] with a sign; least is best.
        clearance: [m] proven lower bound of the gap; None for nearest.
        rows, marginals: of the last linear program; samples, given, chosen: which rows they are.
    """

    placed: PlacedShape
    score: float
    clearance: float | None
    rows: FitRows
    marginals: np.ndarray
    samples: Places
    given: np.ndarray
    chosen: np.ndarray


class FitTarget:
    """An outline, and what a shape should be to it.

    Attributes:
        within: the shape stays inside the outline (a drawn enclosure) instead of clear of it.
    """

    def __init__(
        self,
        outline: DrawnOutline,
        shape: SketchShape,
        drawn: PlacedShape,
        mode: str,
        margin: float,
    ) -> None:
        self.outline, self.mode, self.margin = outline, mode, margin
        self.closed = ClosedContours.of_curve(outline.curve)
        if mode != "nearest":
            drawn.require_apart("sketch")
            if outline.profile is None:
                self.closed.require_apart(outline.name)
        self.pieces = self.closed.pieces
        self.sides = sides_of(self.pieces, self.closed.region)
        per_piece = int(np.clip(1500 // len(self.pieces.bulge), 2, 64))
        points = self.pieces.point(*self.pieces.spread(per_piece))
        self.given = points[:: max(1, len(points) // MOST_GIVEN)]
        self.shape_sides = sides_of(drawn.pieces, drawn.region)
        free_form = mode == "inside" and outline.profile is None
        self.within = free_form and bool(contains(self.closed.region, drawn.pieces.start[:1]).all())

    def distances(self, here: ContourPieces, samples: Places, given: np.ndarray) -> Gaps:
        """Distances of the shape's places and of the outline's points, positive inside the other."""
        return joined_gaps(*self._pair(here, samples, given))

    def gaps(self, here: ContourPieces, samples: Places, given: np.ndarray) -> Gaps:
        """The same, positive where the shape is on its right side: to be at least the margin.

        A place between corners does not count where its foot is a corner along its own edge: that corner's own
        foot is nearer. To first order such a place could not pass the corner, and the edge could not shrink.
        """
        own, theirs = self._signed(here, samples, given)
        far = 1e3 * (here.size + self.pieces.size)
        piece, share, _ = self.pieces.feet(given)
        own = own.without(own.at_corner & slides_past(own, here, *samples), far)
        theirs = theirs.without(
            theirs.at_corner & slides_past(theirs, self.pieces, piece, share), far
        )
        return joined_gaps(own, theirs)

    def gaps_of_given(self, here: ContourPieces, samples: Places, given: np.ndarray) -> np.ndarray:
        """The distances of the outline's points alone, all of them."""
        return self._signed(here, samples, given)[1].distance

    def _signed(self, here: ContourPieces, samples: Places, given: np.ndarray) -> tuple[Gaps, Gaps]:
        own, theirs = self._pair(here, samples, given)
        one = 1.0 if self.within else -1.0
        two = 1.0 if self.mode == "outside" else -1.0
        return own.signed(one), theirs.signed(two)

    def _pair(self, here: ContourPieces, samples: Places, given: np.ndarray) -> tuple[Gaps, Gaps]:
        return (
            gaps_of_shape(self.pieces, self.sides, here, samples),
            gaps_of_outline(here, self.shape_sides, given),
        )

    def score(self, here: PlacedShape) -> float:
        """[m^2] what outside and inside make least."""
        return here.area if self.mode == "outside" else -here.area

    def clearance(self, here: PlacedShape) -> tuple[float, Minimum]:
        """Proven lower bound of the gap, -1 where the shape is on the wrong side, and the witnesses."""
        return proven_gap(here, self.closed, around=self.mode == "outside", within=self.within)

    def better(self, one: FitCandidate, two: FitCandidate) -> bool:
        """True if `one` beats `two` by more than rounding; distance decides between equal areas."""
        if abs(one.score - two.score) > 1e-9 * max(abs(two.score), 1e-300):
            return one.score < two.score
        if self.mode == "nearest":
            return one.score < two.score
        far = [hausdorff(f.placed.curve, self.outline.curve).distance for f in (one, two)]
        return far[0] < far[1] * (1.0 - 1e-9)


def slides_past(
    gaps: Gaps, curve: ContourPieces, piece: np.ndarray, share: np.ndarray
) -> np.ndarray:
    """(k,) whether the places of a curve lie between corners, and their feet along their pieces."""
    across = np.abs((gaps.normal * curve.left(piece, share)).sum(axis=1))
    return ~at_corner(share) & (across < ALONG)


class FitSearch:
    """A shape, its target, and the places on it that give rows."""

    def __init__(self, shape: SketchShape, target: FitTarget, drawn: PlacedShape) -> None:
        self.shape, self.target = shape, target
        self.samples = drawn.pieces.spread(SAMPLES)
        self.tiny = 1e-12 * shape.size

    def shape_at(self, numbers: np.ndarray) -> PlacedShape | None:
        """The shape of these numbers; None where it cannot be drawn so, or crosses itself."""
        here = self.shape.at(numbers)
        return None if here is None or here.crosses_itself else here

    def bounds(self, here: PlacedShape, reach: float | np.ndarray) -> tuple[np.ndarray, np.ndarray]:
        """(n,) each: least and greatest step, in units of the shape's scale, within `reach`."""
        shape, numbers = self.shape, here.numbers
        low, high = range_of_numbers(shape.kinds, numbers, shape.size)
        low, high = (low - numbers) / shape.scale, (high - numbers) / shape.scale
        return np.maximum(low, -reach), np.minimum(high, reach)

    def with_places(self, here: PlacedShape, points: np.ndarray, samples: Places) -> Places:
        """The samples and the places of more points of the shape."""
        piece, share, _ = here.pieces.feet(points)
        return np.append(samples[0], piece), np.append(samples[1], share)


def range_of_numbers(
    kinds: Sequence[str], numbers: np.ndarray, size: float
) -> tuple[np.ndarray, np.ndarray]:
    """The least and the greatest value of each number after one step.

    Lengths and angles, of these `kinds`, stay above 0, angles below half a turn.
    """
    low, high = np.full(len(numbers), -np.inf), np.full(len(numbers), np.inf)
    for i, kind in enumerate(kinds):
        if kind != "parameter":
            floor = FLOOR if kind in ("angle", "ratio") else FLOOR * size
            low[i] = min(numbers[i], max(SHRINK * numbers[i], floor))
        if kind == "angle":
            high[i] = math.pi - SHRINK * (math.pi - numbers[i])
    return low, high

"""What a fitted sketch should be to an outline: near, around or clear of it; rows to search by, and the proof.

Not for: the search (`fit_search`).
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from clearance.planar.hausdorff import hausdorff
from clearance.planar.minimum import Minimum, minimum_distance
from clearance.profiles.fit_rows import (
    Rows,
    Slope,
    joined_rows,
    rows_of_outline,
    rows_of_shape,
    sides_of,
)
from clearance.profiles.fit_shape import Placed, SketchShape
from clearance.profiles.outline_file import Drawn
from clearance.profiles.pieces import FINE, Pieces, contours_of
from clearance.profiles.region import Region, boundary_distance, holds, region_of

CHORD = 1e-7
"""[-] How far chords may stray from arcs where sides are told, relative to the size."""

MOST_GIVEN = 3000
"""Points of the outline that are looked at."""

Places = tuple[np.ndarray, np.ndarray]
"""Pieces and shares of places on a shape."""


@dataclass(frozen=True, eq=False)
class Found:
    """A shape at the end of a search.

    Attributes:
        score: Hausdorff distance [m], or area [m^2] with a sign; least is best.
        clearance: [m] proven lower bound of the gap; None for nearest.
        rows, marginals: of the last linear program; samples, given, chosen: which rows they are.
    """

    placed: Placed
    score: float
    clearance: float | None
    rows: Rows
    marginals: np.ndarray
    samples: Places
    given: np.ndarray
    chosen: np.ndarray


class Target:
    """An outline, and what a shape should be to it.

    Attributes:
        room: the shape stays within the outline's inside (a drawn room) instead of clear of it.
    """

    def __init__(
        self, outline: Drawn, shape: SketchShape, drawn: Placed, mode: str, margin: float
    ) -> None:
        self.outline, self.mode, self.margin = outline, mode, margin
        contours = contours_of(outline.curve, FINE * outline.curve.size)
        self.contours, self.pieces = contours, Pieces(contours)
        self.region = region_of([c.flattened(CHORD * self.pieces.size) for c in contours])
        self.sides = sides_of(self.pieces, self.region)
        per_piece = int(np.clip(1500 // len(self.pieces.bulge), 2, 64))
        points = self.pieces.point(*self.pieces.spread(per_piece))
        self.given = points[:: max(1, len(points) // MOST_GIVEN)]
        self.shape_sides = sides_of(drawn.pieces, region_of_shape(drawn))
        free_form = mode == "inside" and outline.profile is None
        self.room = free_form and bool(holds(self.region, drawn.pieces.start[:1]).all())

    def rows(
        self, here: Pieces, slopes: list[Slope], samples: Places, given: np.ndarray
    ) -> tuple[Rows, Rows]:
        """Rows of the shape's places and of the outline's points, positive inside the other."""
        return (
            rows_of_shape(here, slopes, self.pieces, self.sides, samples),
            rows_of_outline(here, slopes, self.shape_sides, given),
        )

    def gaps(self, pair: tuple[Rows, Rows]) -> Rows:
        """One set of rows whose distance must be at least the margin."""
        one = 1.0 if self.room else -1.0
        two = 1.0 if self.mode == "outside" else -1.0
        turned = (
            Rows(sign * rows.distance, sign * rows.slope, rows.point)
            for sign, rows in zip((one, two), pair, strict=True)
        )
        return joined_rows(*turned)

    def score(self, here: Placed) -> float:
        """[m^2] what outside and inside make least."""
        return here.area if self.mode == "outside" else -here.area

    def clearance(self, here: Placed) -> tuple[float, Minimum]:
        """Proven lower bound of the gap, -1 where the shape is on the wrong side, and the witnesses.

        Where the curves are apart by more than nothing, each contour is wholly on one side of the other curve,
        so that one point of it decides.
        """
        least = minimum_distance(here.curve, self.outline.curve)
        lower = least.distance - least.error_bound
        if least.error_bound > 1e-9 * here.pieces.size:  # arcs that run alongside arcs: on chords
            lower = max(lower, self._gap_of_chords(here))
        theirs = holds(region_of_shape(here), self._starts)
        ours = holds(self.region, np.array([c.vertices[0] for c in here.contours]))
        right = theirs.all() if self.mode == "outside" else not theirs.any()
        right = right and (ours.all() if self.room else not ours.any())
        return (lower if right else -1.0), least

    def _gap_of_chords(self, here: Placed) -> float:
        """[m] the least distance of chords within known heights of the arcs, less the heights."""
        height = 1e-8 * here.pieces.size
        if any(np.diff(self.outline.curve.pieces.first) > 3):
            return 0.0  # free-form pieces have no chords of known height here
        theirs = region_of([c.flattened(height) for c in self.contours])
        ours = [contour.flattened(height) for contour in here.contours]
        return boundary_distance(theirs, ours) - 2.01 * height

    def better(self, one: Found, two: Found) -> bool:
        """True if `one` beats `two` by more than rounding; equal areas are told apart by distance."""
        if abs(one.score - two.score) > 1e-9 * max(abs(two.score), 1e-300):
            return one.score < two.score
        if self.mode == "nearest":
            return one.score < two.score
        far = [hausdorff(f.placed.curve, self.outline.curve).distance for f in (one, two)]
        return far[0] < far[1] * (1.0 - 1e-9)

    @property
    def _starts(self) -> np.ndarray:
        """(k, 2) the first point of each contour of the outline."""
        curve = self.outline.curve
        firsts = np.flatnonzero(np.diff(curve.contour, prepend=-1))
        return curve.point(curve.limits[firsts, 0])


def region_of_shape(here: Placed) -> Region:
    """What a shape encloses, arcs as chords within CHORD of its size; for sides, not for bounds."""
    return region_of([contour.flattened(CHORD * here.pieces.size) for contour in here.contours])

"""The proven gap between a sketch and an outline, and whether each is on its right side of the other."""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property

import numpy as np

from clearance.errors import BadShape
from clearance.planar.curve import Curve
from clearance.planar.minimum import Minimum, minimum_distance
from clearance.profiles.contour import Contour, joined
from clearance.profiles.pieces import FINE, ContourPieces, contours_of
from clearance.profiles.region import Region, contains, crosses_itself, overlap_of, region_of

CHORD = 1e-7
"""[-] How far chords may stray from arcs where sides are decided, relative to the size."""


@dataclass(frozen=True, eq=False)
class ClosedContours:
    """Closed contours in the forms that searches need.

    Attributes:
        contours: lines and arcs. exact: the curve that they are made of, if it was another one.
    """

    contours: tuple[Contour, ...]
    exact: Curve | None = None

    @classmethod
    def of_curve(cls, curve: Curve) -> ClosedContours:
        """Any curve of closed contours."""
        return cls(contours_of(curve, FINE * curve.size), curve)

    @cached_property
    def curve(self) -> Curve:
        """For certified distances."""
        return joined(self.contours) if self.exact is None else self.exact

    @cached_property
    def pieces(self) -> ContourPieces:
        """For searches."""
        return ContourPieces(self.contours)

    @cached_property
    def region(self) -> Region:
        """The enclosed region, by parity, arcs as chords within CHORD; for sides, not for bounds."""
        return region_of(self._rings)

    @cached_property
    def _rings(self) -> list[np.ndarray]:
        return [contour.flattened(CHORD * self.curve.size) for contour in self.contours]

    def require_apart(self, name: str) -> None:
        """Nothing, if each contour lies outside each other one, or within it as a hole or in a hole.

        Raises:
            BadShape: two that overlap, or one that laps over itself: parity would count the overlap as outside.
        """
        found = overlap_of(self._rings, 2.0 * CHORD * self.curve.size)
        if found is not None:
            x, y = found.point
            fault = f"contours {found.first + 1} and {found.second + 1} overlap"
            if found.first == found.second:
                fault = f"contour {found.first + 1} laps over itself"
            raise BadShape(
                f"{fault}, as at ({x:.4g}, {y:.4g}), which leaves open what is inside",
                where=name,
                valid="contours beside one another, or one within another as a hole",
            )

    @cached_property
    def crosses_itself(self) -> bool:
        """True if one of the contours crosses itself, or laps over itself: its signed area is no area then."""
        return any(crosses_itself(ring, 2.0 * CHORD * self.curve.size) for ring in self._rings)

    @property
    def starts(self) -> np.ndarray:
        """(k, 2) the first point of each contour."""
        return np.array([contour.vertices[0] for contour in self.contours])


def proven_gap(
    sketch: ClosedContours, outline: ClosedContours, *, around: bool, within: bool = False
) -> tuple[float, Minimum]:
    """Lower bound of the gap, -1 where one is on the wrong side of the other, and the witnesses.

    Where the distance of the curves is above 0, each contour is wholly on one side of the other curve, so
    that one point of it decides.

    Args:
        around: the outline is to lie inside the sketch; else outside it.
        within: the sketch is to lie inside the outline; else outside it.
    """
    least = minimum_distance(sketch.curve, outline.curve)
    lower = least.distance - least.error_bound
    theirs = contains(sketch.region, outline.starts)
    ours = contains(outline.region, sketch.starts)
    right = (theirs.all() if around else not theirs.any()) and (
        ours.all() if within else not ours.any()
    )
    return (lower if right else -1.0), least

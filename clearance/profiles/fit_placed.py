"""One shape that a sketch draws, where it stands, and how far its numbers may go in one step."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass
from functools import cached_property

import numpy as np

from clearance.planar.curve import Curve
from clearance.profiles.contour import Contour, joined
from clearance.profiles.pieces import ContourPieces

SHRINK = 0.05
"""[-] The least share of a length that remains after one step."""

FLOOR = 1e-6
"""[-] Lengths are not made shorter than this, relative to the sketch: it could not be drawn at 0."""


@dataclass(frozen=True, eq=False)
class PlacedShape:
    """A shape: what the sketch draws, moved to where it stands.

    Attributes:
        numbers: (n,) the free dimensions, then x, y [m] and turn [rad] where they are free.
        contours: closed; always the same pieces.
    """

    numbers: np.ndarray
    contours: tuple[Contour, ...]

    @cached_property
    def pieces(self) -> ContourPieces:
        """For the search."""
        return ContourPieces(self.contours)

    @cached_property
    def curve(self) -> Curve:
        """For certified distances."""
        return joined(self.contours)

    @cached_property
    def area(self) -> float:
        """[m^2] that the contours enclose, less holes, which run in reverse."""
        return abs(sum(contour.area for contour in self.contours))


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

"""The common part of all searches for a fitted sketch: its places, its step bounds, and its rows."""

from __future__ import annotations

import numpy as np

from clearance.profiles.fit_placed import PlacedShape, range_of_numbers
from clearance.profiles.fit_shape import SketchShape
from clearance.profiles.fit_target import FitTarget, Places

MOST_ROWS = 700
"""Rows of a linear program: those nearest to mattering."""

SAMPLES = 16
"""Places on each piece of the shape."""

STEPS = 30
"""Linear programs that one search may solve."""


class FitSearch:
    """A shape, its target, and the places on it that give rows."""

    def __init__(self, shape: SketchShape, target: FitTarget, drawn: PlacedShape) -> None:
        self.shape, self.target = shape, target
        self.samples = drawn.pieces.spread(SAMPLES)
        self.tiny = 1e-12 * shape.size

    def bounds(self, here: PlacedShape, reach: float) -> tuple[np.ndarray, np.ndarray]:
        """(n,) each: least and greatest step, in units of the shape's scale, within `reach`."""
        shape, numbers = self.shape, here.numbers
        low, high = range_of_numbers(shape.kinds, numbers, shape.size)
        low, high = (low - numbers) / shape.scale, (high - numbers) / shape.scale
        return np.maximum(low, -reach), np.minimum(high, reach)

    def with_places(self, here: PlacedShape, points: np.ndarray, samples: Places) -> Places:
        """The samples and the places of more points of the shape."""
        piece, share, _ = here.pieces.feet(points)
        return np.append(samples[0], piece), np.append(samples[1], share)

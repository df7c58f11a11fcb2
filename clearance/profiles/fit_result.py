"""The answer of a fit. Not for: finding it (`fit`)."""

from __future__ import annotations

from dataclasses import dataclass, field

import numpy as np

from clearance.planar.curve import Curve
from clearance.planar.hausdorff import Hausdorff
from clearance.sketch import Sketch


@dataclass(frozen=True, eq=False)
class Fit:
    """A sketch fitted to an outline.

    Attributes:
        mode: "nearest", "outside" or "inside".
        sketch: solved; the free dimensions have their fitted values.
        dimensions: the free dimensions [m] or [rad].
        shift: (2,) [m] and turn [rad]: how the sketch was placed, unless it was fixed.
        distance: the Hausdorff distance to the outline, certified, with its witnesses.
        area: [m^2] of the sketch.
        margin: [m] that was given.
        clearance: [m] proven lower bound of the gap between sketch and outline (outside, inside); the sketch
            then contains the outline, or stays clear of it. None for nearest.
        active: fixed dimensions that stop it from being better, strongest first: how much the objective (distance
            [m], area [m^2]) changes for each unit of the dimension.
        sensitivity: for each free dimension how the distance (nearest) or the clearance changes when it grows
            and when it shrinks, per unit.
        ends: (2, 2) [m] where it is attained what counts: the Hausdorff distance (nearest) or the least gap, on
            the outline and on the sketch.
        touching: (k, 2) points at which the fit touches.
        n_starts: how many starts were tried.
    """

    mode: str
    sketch: Sketch
    dimensions: dict[str, float]
    shift: np.ndarray
    turn: float
    distance: Hausdorff
    area: float
    margin: float
    clearance: float | None
    active: dict[str, float]
    sensitivity: dict[str, tuple[float, float]]
    ends: np.ndarray
    touching: np.ndarray
    n_starts: int
    curve: Curve = field(repr=False)

    @property
    def title(self) -> str:
        """One line for a picture: the mode and the dimensions in mm where they are lengths."""
        kinds = {
            name: self.sketch.constraints[name].kind
            for name in self.dimensions
            if name in self.sketch.constraints
        }
        parts = ", ".join(
            f"{name} {value:.4g} rad"
            if kinds.get(name) == "angle"
            else f"{name} {1000 * value:.2f} mm"
            for name, value in self.dimensions.items()
        )
        return f"{self.mode}: {parts}"

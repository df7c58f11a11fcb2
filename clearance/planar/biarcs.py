"""Circular arcs fitted to a curve with a proven error: what the distance map is drawn from, for everyone."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from clearance.kernels.curve.arc import CX, EPS, RADIUS, S0, SENSE, X0, X1, distances_to_arcs
from clearance.kernels.curve.arc_fit import fit_leaves
from clearance.planar.curve import Curve
from clearance.planar.entries import BadCurve, checked_number
from clearance.tolerance import FINEST_BIARC


@dataclass(frozen=True)
class Biarcs:
    """Arcs that follow a curve, in curve order; each less than half a turn.

    Attributes:
        start, end: (n, 2) end points.
        center: (n, 2) centres; nan where the arc is a straight segment.
        radius: (n,) radii; infinite for segments.
        counter_clockwise: (n,) sense of turning.
        parameters: (n, 2) the curve's parameter interval that each arc stands for.
        error: (n,) proven bound of the Hausdorff distance between the arc and its part of the curve.
    """

    start: np.ndarray
    end: np.ndarray
    center: np.ndarray
    radius: np.ndarray
    counter_clockwise: np.ndarray
    parameters: np.ndarray
    error: np.ndarray
    rows: np.ndarray
    origin: np.ndarray

    def __len__(self) -> int:
        return len(self.radius)

    def distance(self, point: np.ndarray) -> float:
        """The distance from `point` (2,) to the nearest arc."""
        x, y = np.asarray(point, float) - self.origin
        return distances_to_arcs(self.rows, x, y)[0]


def biarcs(curve: Curve, tolerance: float) -> Biarcs:
    """Arcs within `tolerance` of `curve`, their joints on the curve and tangent within each biarc.

    Exactness: `error` is proven, by Bernstein coefficients; a part is halved until it is at most `tolerance`.
    Raises: BadCurve (a tolerance that is not positive or below what floats resolve), NotFinite.
    Source: Šír, Feichtinger, Jüttler (2006), section 3.
    """
    tolerance = checked_number(tolerance, "tolerance")
    least = FINEST_BIARC * curve.size
    if not tolerance >= least:
        raise BadCurve(
            f"a tolerance of {tolerance:g}", where="tolerance", valid=f"at least {least:.1g}"
        )
    rows, owner = fit_leaves(curve.pieces, tolerance, 52)
    flat = rows[:, RADIUS] == 0.0
    low, high = curve.limits[owner].T[:, :, None]
    center = np.where(flat[:, None], np.nan, rows[:, CX : CX + 2] + curve.origin)
    return Biarcs(
        start=rows[:, X0 : X0 + 2] + curve.origin,
        end=rows[:, X1 : X1 + 2] + curve.origin,
        center=center,
        radius=np.where(flat, np.inf, rows[:, RADIUS]),
        counter_clockwise=rows[:, SENSE] > 0.0,
        parameters=low + rows[:, S0 : S0 + 2] * (high - low),
        error=rows[:, EPS].copy(),
        rows=rows,
        origin=curve.origin,
    )

"""The constraints of a fit: where it touches, how each free dimension moves it, and which fixed ones stop it.

The multipliers are those of the last linear program. Not for: the search (`fit_bounded`, `fit_nearest`).
"""

from __future__ import annotations

import numpy as np

from clearance.profiles.fit_rows import FitRows, FitSlope, rows_of
from clearance.profiles.fit_shape import SketchShape
from clearance.profiles.fit_target import FitCandidate, FitTarget

MOST_TOUCHING = 32
"""Touching points that are reported."""


def tight_rows(
    shape: SketchShape, target: FitTarget, best: FitCandidate
) -> tuple[FitRows, np.ndarray]:
    """The rows that attain the distance (nearest) or the gap, and the sign that makes each grow."""
    rows = best.rows
    nearest = target.mode == "nearest"
    level = np.abs(rows.distance) if nearest else rows.distance
    far = level.max() if nearest else level.min()
    tight = np.abs(level - far) <= 1e-6 * max(0.01 * shape.size, abs(far))
    sign = np.where(rows.distance[tight] < 0.0, -1.0, 1.0) if nearest else np.ones(tight.sum())
    return FitRows(*(column[tight] for column in rows)), sign


def sensitivities(
    shape: SketchShape, target: FitTarget, best: FitCandidate
) -> dict[str, tuple[float, float]]:
    """For each free dimension how the distance, or the gap, changes when it grows and when it shrinks."""
    rows, sign = tight_rows(shape, target, best)
    rates = sign[:, None] * rows.slope
    most = np.max if target.mode == "nearest" else np.min
    up, down = most(rates, axis=0), most(-rates, axis=0)
    return {name: (float(up[i]), float(down[i])) for i, name in enumerate(shape.free)}


def touching(shape: SketchShape, target: FitTarget, best: FitCandidate) -> np.ndarray:
    """(k, 2) different points that attain the distance or the gap."""
    points = tight_rows(shape, target, best)[0].point
    _, first = np.unique(np.round(points / (1e-7 * shape.size)), axis=0, return_index=True)
    return points[np.sort(first)][:MOST_TOUCHING]


def rates_of_fixed(shape: SketchShape, target: FitTarget, best: FitCandidate) -> dict[str, float]:
    """The change of the objective with each fixed dimension that matters, the strongest first."""
    names, slopes, change = _slopes_of_fixed(shape, target, best)
    if not names:
        return {}
    here, weight, k = best.placed.pieces, best.marginals, len(best.chosen)
    measured = target.distances if target.mode == "nearest" else target.gaps
    slope = rows_of(measured(here, best.samples, best.given).at(best.chosen), here, slopes).slope
    if target.mode == "nearest":
        rates, unit = weight[k:] @ slope - weight[:k] @ slope, 1.0
    else:  # the program counts gaps in units of size and areas in units of its square
        rates, unit = np.array(change) + (weight @ slope) * shape.size, shape.size
    found = {name: float(rate) for name, rate in zip(names, rates, strict=True)}
    found = {name: rate for name, rate in found.items() if abs(rate) > 1e-4 * unit}
    return dict(sorted(found.items(), key=lambda item: -abs(item[1])))


def _slopes_of_fixed(shape: SketchShape, target: FitTarget, best: FitCandidate):
    """Names, neighbouring shapes and change of the score of the fixed dimensions that can change."""
    names, slopes, change = [], [], []
    step = 1e-6 * shape.size
    for name in shape.fixed:
        behind = shape.changed(name, -step, best.placed.numbers)
        ahead = shape.changed(name, step, best.placed.numbers)
        if ahead is not None and behind is not None:
            names.append(name)
            slopes.append(FitSlope(behind.pieces, ahead.pieces, 2.0 * step))
            change.append((target.score(ahead) - target.score(behind)) / (2.0 * step))
    return names, slopes, change

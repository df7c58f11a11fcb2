"""The linear programs of a fit, solved over few of their rows at a time until none of the others is broken."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from clearance.profiles.fit_rows import FitRows

FIRST = 48
"""Rows that a program begins with: those nearest to mattering."""

BROKEN = 1e-9
"""[-] How far an omitted row may be broken; the solver's own tolerance is 1e-7."""


class ProgramStep(NamedTuple):
    """Attributes: step (n,); value of the objective there; marginals of the rows, 0 or less."""

    step: np.ndarray
    value: float
    marginals: np.ndarray


def least_greatest(
    rows: FitRows, scale: np.ndarray, low: np.ndarray, high: np.ndarray
) -> ProgramStep:
    """The step that makes the greatest |distance| least to first order.

    Args:
        scale: (n,) units of the numbers. low, high: (n,) bounds of the step in these units.

    Marginals are (2 k,): of distance <= t, then of -distance <= t.
    """
    scaled = rows.slope * scale
    n, one = scaled.shape[1], -np.ones((len(scaled), 1))
    unit = max(float(np.abs(rows.distance).max()), 1e-300)
    found = _least(
        np.append(np.zeros(n), 1.0),
        np.vstack([np.hstack([scaled, one]), np.hstack([-scaled, one])]),
        np.concatenate([-rows.distance, rows.distance]) / unit,
        [*zip(low / unit, high / unit, strict=True), (0.0, None)],
    )
    if found is None:
        return ProgramStep(np.zeros(n), unit, np.zeros(2 * len(scaled)))
    x, marginals = found
    return ProgramStep(x[:n] * unit * scale, float(x[n]) * unit, marginals)


class AreaGoal(NamedTuple):
    """The objective of a step: the area, and the missing part of a gap.

    Attributes:
        change: (n,) of the area by the numbers. wanted: the least gap. price: of each unit that is missing.
    """

    change: np.ndarray
    wanted: float
    price: float


def least_area(
    rows: FitRows,
    goal: AreaGoal,
    size: float,
    reach: float,
    scale: np.ndarray,
    low: np.ndarray,
    high: np.ndarray,
) -> ProgramStep:
    """The step that makes area and price times the missing gap least to first order; value: the gain.

    Args:
        size: of the shape, for units.
        reach: the greatest step, for units: late small steps are not lost in the solver's tolerances.
        scale, low, high: as for `least_greatest`.
    """
    change, wanted, price = goal
    scaled = rows.slope * scale
    n = scaled.shape[1]
    found = _least(
        np.append(change * scale, price * size) / size**2,
        np.hstack([-scaled / size, -np.ones((len(scaled), 1))]),
        (rows.distance - wanted) / (size * reach),
        [*zip(low / reach, high / reach, strict=True), (0.0, None)],
    )
    if found is None:
        return ProgramStep(np.zeros(n), 0.0, np.zeros(len(scaled)))
    x, marginals = found
    missing = max(0.0, wanted - float(rows.distance.min()))
    gained = float((change * scale) @ x[:n] + price * size * x[n]) * reach
    return ProgramStep(x[:n] * reach * scale, price * missing - gained, marginals)


def _least(cost: np.ndarray, matrix: np.ndarray, right: np.ndarray, bounds: list):
    """The x of least `cost` with matrix x <= right, and the marginals; None where there is no such x."""
    from scipy.optimize import linprog

    order = np.argsort(right, kind="stable")
    active = np.sort(order[:FIRST])
    while True:
        solved = linprog(cost, matrix[active], right[active], bounds=bounds, method="highs")
        if solved.x is None:
            return None
        broken = matrix @ solved.x - right
        broken[active] = 0.0
        worst = np.argsort(-broken, kind="stable")[:FIRST]
        worst = worst[broken[worst] > BROKEN]
        if not len(worst):
            break
        active = np.sort(np.append(active, worst))
    marginals = np.zeros(len(right))
    marginals[active] = solved.ineqlin.marginals
    return solved.x, marginals

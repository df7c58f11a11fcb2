"""What tolerances leave over time, thinned for the page's curve. Not for: the section (`tolerance_section`)."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from clearance.simulate.budget_columns import least_between, least_expected, least_proven
from clearance.simulate.record import Record

MOST_PARTS = 2000
"""Stretches that a screen can resolve."""


@dataclass(frozen=True, eq=False)
class BudgetCurve:
    """The least of each stretch of steps, of all rules.

    Attributes:
        times: (k,) [s]. proven: (k,) [m], of the motion where that is certified. expected: (k,) [m]; NaN where it
            is not worked out.
    """

    times: np.ndarray
    proven: np.ndarray
    expected: np.ndarray


def budget_curve(record: Record) -> BudgetCurve | None:
    """The curve; None without tolerances."""
    if not record.budget:
        return None
    times = record.motions[0].times
    between = least_between(record.budget)
    proven = least_proven(record.budget)
    proven = proven if between is None else np.minimum(proven, between)
    n_parts = min(len(times), MOST_PARTS)
    starts = np.arange(n_parts) * len(times) // n_parts
    ends = np.append(starts[1:], len(times)) - 1
    return BudgetCurve(
        0.5 * (times[starts] + times[ends]),
        np.minimum.reduceat(proven, starts),
        np.fmin.reduceat(least_expected(record.budget), starts),
    )

"""The clearances that tolerances leave of all rules, step by step, as columns. Not for: the proof (`answer`)."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from clearance.record.budget import RuleBudget
from clearance.record.table import Table


def least_proven(budget: Sequence[RuleBudget]) -> np.ndarray:
    """(n,) [m] the clearance proven at each step, the least of all rules."""
    return np.min([one.proven for one in budget], axis=0)


def least_between(budget: Sequence[RuleBudget]) -> np.ndarray | None:
    """(n,) [m] the clearance proven from each step to the next, the least of all rules; None if not proven."""
    known = [one.between for one in budget if one.between is not None]
    return np.min(known, axis=0) if len(known) == len(budget) else None


def least_expected(budget: Sequence[RuleBudget]) -> np.ndarray:
    """(n,) [m] the clearance expected from each step to the next, the least of all rules; NaN where unknown."""
    between = [one.expected_between for one in budget if one.expected_between is not None]
    return np.fmin.reduce([*(one.expected for one in budget), *between])


def columns_of(budgets: Sequence[RuleBudget]) -> tuple[np.ndarray, np.ndarray]:
    """(n,) [m] proven and expected at each step, of the rule with the least margin to its limit."""
    margins = np.array([one.proven - one.limits.fail for one in budgets])
    which, steps = np.argmin(margins, axis=0), np.arange(margins.shape[1])
    proven = np.array([one.proven for one in budgets])[which, steps]
    return proven, np.array([one.expected for one in budgets])[which, steps]


def with_proven_between(table: Table, budget: Sequence[RuleBudget] | None, first: int = 0) -> Table:
    """Rows of the steps with `proven_between` [m], NaN where nothing is measured; the rows themselves where no
    motion is certified with tolerances.

    Args:
        first: the step of the first row.
    """
    between = least_between(budget) if budget else None
    if between is None:
        return table
    own = between[first : first + table.n_rows]
    return table.with_columns({"proven_between": np.where(np.isfinite(own), own, np.nan)})

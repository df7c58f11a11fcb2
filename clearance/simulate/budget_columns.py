"""What tolerances leave, as columns of the steps. Not for: working it out (`clearance.budget`)."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
import pyarrow as pa

from clearance.simulate.budget_answer import RuleBudget


def least_proven(budget: Sequence[RuleBudget]) -> np.ndarray:
    """(n,) [m] what is proven of each step, of all rules."""
    return np.min([one.proven for one in budget], axis=0)


def least_between(budget: Sequence[RuleBudget]) -> np.ndarray | None:
    """(n,) [m] what is proven of the motion from each step to the next, of all rules; None where nothing is."""
    known = [one.between for one in budget if one.between is not None]
    return np.min(known, axis=0) if len(known) == len(budget) else None


def least_expected(budget: Sequence[RuleBudget]) -> np.ndarray:
    """(n,) [m] what is expected at each step, of all rules; NaN where it is not worked out."""
    return np.fmin.reduce([one.expected for one in budget])


def with_budget_columns(
    table: pa.Table, budget: Sequence[RuleBudget] | None, first: int = 0
) -> pa.Table:
    """Rows of the steps with `proven`, `expected` and, where the motion is certified, `proven_between` [m]; null
    where nothing is measured or worked out. The rows themselves where there are no tolerances.

    Args:
        first: the step of the first row.
    """
    if not budget:
        return table
    rows = slice(first, first + table.num_rows)
    columns = {"proven": least_proven(budget), "expected": least_expected(budget)}
    between = least_between(budget)
    if between is not None:
        columns["proven_between"] = between
    for name, values in columns.items():
        own = values[rows]
        table = table.append_column(name, pa.array(own, pa.float64(), mask=~np.isfinite(own)))
    return table

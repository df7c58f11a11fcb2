"""Budgets made by hand for the record of `records`: what tolerances would leave of its swing."""

from __future__ import annotations

import dataclasses

import numpy as np

from clearance.record.budget import ErrorSource, RuleBudget
from clearance.record.record import Record
from clearance.world.budget import Budget

SOURCES = (
    ErrorSource("arm_0", "position", "lift", ((0.001, "rad"),), 0.0012, 0.0004, (0.0021,)),
    ErrorSource("arm_0", "base", "", ((0.002, "m"), (0.001, "rad")), 0.0008, 0.0003, (0.0035, None)),
    ErrorSource("post", "surface", "", ((0.0005, "m"),), 0.0005, 0.0001, (0.00123456,)),
)  # fmt: skip
"""What takes most first: 2.5 mm together."""


def with_budget(
    made: Record, taken: float = 0.0025, *, between: bool = False, ok: bool = False, **changes
) -> Record:
    """The record with tolerances that take so much [m] of each step's clearance, and a third of it as expected.

    Args:
        between: the motion is certified. ok: a limit that is not proven may pass.
        changes: replace fields of the `RuleBudget`s.
    """
    budget = Budget(unproven_ok=ok, sources=("preset typical: read somewhere",))
    case = dataclasses.replace(made.case, tolerance=budget)
    budgets = tuple(_of_rule(made, rule, taken, between, changes) for rule in made.rules)
    left = {name: getattr(budgets[0], name) for name in ("proven", "expected")}
    steps = made.rows.with_columns(
        {name: np.where(np.isfinite(values), values, np.nan) for name, values in left.items()}
    )
    return dataclasses.replace(made, case=case, budget=budgets, table=steps)


def _of_rule(made, rule, taken, between, changes) -> RuleBudget:
    nominal = rule.measurement.clearance
    proven = nominal - taken
    budget = RuleBudget(
        rule.name,
        rule.limits,
        proven,
        nominal - taken / 3,
        proven - 0.0001 if between else None,
    )
    return dataclasses.replace(budget, **changes)

"""What tolerances leave, a sentence a rule. Not for: which errors take most (`report.topics.tolerances`)."""

from __future__ import annotations

import numpy as np

from clearance.record.budget import RuleBudget
from clearance.record.record import Record
from clearance.record.wording import mm, of_rule
from clearance.world.budget import Budget


def budget_lines(record: Record) -> tuple[str, ...]:
    """A sentence for each rule on what is proven and what is expected; none without tolerances."""
    budget = record.case.tolerance
    if budget is None or record.budget is None:
        return ()
    return tuple(_line(record, budget, one) for one in record.budget)


def tolerance_lines(record: Record) -> tuple[str, ...]:
    """These, and which grasps are taken as exact."""
    exact = [f"{one.part} by {one.by}" for one in record.case.carries if one.exact_grasp]
    told = budget_lines(record)
    return (*told, f"Grasps taken as exact: {', '.join(exact)}.") if told and exact else told


def _line(record: Record, budget: Budget, one: RuleBudget) -> str:
    proven, expected = one.least, least_expected(one)
    basis = "the samples only" if one.between is None else "the motion"
    waived = " (waived pairs among them)" if record.case.waivers else ""
    left = f"at least {mm(proven)} mm are left{waived}"
    if proven <= 0.0:
        left = "contact is not ruled out"  # a number below 0 says no depth
    told = f"With every error at its worst at once {left}{of_rule(one.rule)}; proven for {basis}."
    if expected is not None:
        spread = f"{budget.coverage:g} sigma, estimate{'' if one.between is not None else ' at the samples'}"
        told += f" Expected ({spread}): {mm(expected)} mm."
    return told


def least_expected(one: RuleBudget) -> float | None:
    """[m] The least expected clearance, of the motion where that is certified. None where it is not worked out.

    Never told below what is proven: three deviations of a single uniform error are more than its worst.
    """
    found = np.append(one.expected, [] if one.expected_between is None else one.expected_between)
    known = found[np.isfinite(found)]
    return max(float(known.min()), one.least) if len(known) else None

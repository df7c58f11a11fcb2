"""The clearances that the tolerances of a case leave, for each rule: the `budget` of its record."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace
from typing import NamedTuple

import numpy as np

from clearance.budget.expected import expected_between, expected_of_steps
from clearance.budget.proven import PairsWithErrors, SectionBudget, proven_between, proven_of_steps
from clearance.budget.worst import WorstMoments
from clearance.errors import BadTolerance
from clearance.record.budget import RuleBudget
from clearance.simulate.measure.resources import Resources
from clearance.simulate.measure.sections import SectionAnswer, SectionPlan, rule_limits
from clearance.world.budget import Budget
from clearance.world.case import Case, Limits
from clearance.world.rules import Waiver


class MeasuredBudget(NamedTuple):
    """What tolerances leave to the pairs of a rule, and what finds the moments at which that is least."""

    remaining: RuleBudget
    worst: WorstMoments


def budget_answers(
    case: Case,
    plan: SectionPlan,
    answers: Sequence[SectionAnswer],
    resources: Resources,
    waiver: Waiver | None = None,
) -> tuple[MeasuredBudget, ...]:
    """The clearances that a case's tolerances leave, for each rule with pairs, in their order.

    Args:
        answers: of the plan's sections. With certificates, the motion between the steps is proven as well.
        waiver: that of all pairs of the plan, if they have one: its level is then the fail limit.

    Raises:
        BadInput: tolerances that this case does not allow, as those of clocks where parts change hands.
    """
    budget = case.tolerance
    if budget is None:
        raise ValueError("a case without tolerances")
    require_budget(case, budget, plan)
    sections = [_of_section(budget, answer, resources) for answer in answers]
    n_steps = max(section.section.steps.stop for section in sections)
    names = case.limits.rule_names
    found = []
    for rule in plan.rules:
        own = [one for one in sections if one.section.rule == rule]
        limits = rule_limits(case, rule, [one.section for one in own])
        if waiver is not None:
            limits = replace(limits, fail=waiver.at_least)
        found.append(_of_rule(_Judged(names[rule], limits, waiver), n_steps, own))
    return tuple(found)


class _Judged(NamedTuple):
    """What judges the pairs of some sections."""

    rule: str
    limits: Limits
    waiver: Waiver | None


def require_budget(case: Case, budget: Budget, plan: SectionPlan) -> None:
    """Checks that the case allows the budget.

    Raises:
        BadInput: clocks that are not tied, or errors of clocks in a run in which something changes hands.
    """
    if case.clock.slack > 0.0:
        raise BadTolerance(
            "a tolerance budget is given, and the case's clocks are not tied",
            where="tolerance",
            valid="`clock: common`, and how far clocks may be off in tolerance.timing",
        )
    late = [name for name, own in budget.robots.items() if own.timing > 0.0]
    late += [name for name, own in budget.obstacles.items() if own.timing > 0.0]
    _require_no_loops(case, late)
    phases = {section.phase.first: section.phase for section in plan.sections}
    parts = [part for phase in phases.values() for part in phase.case.obstacles]
    if len(phases) == 1:  # parts gripped as the run begins
        gripping = {one.owner for part in parts for one in part.past}
        late = [name for name in late if name in gripping]
    if late:
        raise BadTolerance(
            f"the clock of {late[0]!r} may be off, and parts change hands, come or go during the run",
            where="tolerance.timing",
            valid="no timing, or a case for each part of the run",
        )


def _require_no_loops(case: Case, late: Sequence[str]) -> None:
    """Checks that no motion with an error of its clock continues beyond both ends of the run."""
    timings = {one.robot.name: one.timing for one in case.robots}
    timings |= {one.name: one.moves.timing for one in case.obstacles if one.moves is not None}
    for name in late:
        if name in timings and timings[name].after == "loop":
            raise BadTolerance(
                f"the clock of {name!r} may be off, and it loops: beyond the ends of the run it would go on",
                where="tolerance.timing",
                valid="a table of its own for the whole run and what is before and after (after: hold)",
            )


def _of_section(budget: Budget, answer: SectionAnswer, resources: Resources) -> SectionBudget:
    what, found = answer.section.in_motion, answer.found
    pairs = PairsWithErrors(what, budget, resources.n_threads)
    steps = proven_of_steps(pairs, found)
    between = expected_there = None
    expected = expected_of_steps(what.case, budget, what.motions, what.pairs, found)
    if answer.certificate is not None:
        between = proven_between(pairs, steps, answer.certificate.gap)
        expected_there = expected_between(found, answer.certificate, expected)
    pairs.idle.clear()  # hundreds of sections follow each other
    expected = np.where(found.touches(slice(None)), 0.0, expected)  # nothing is left of contact
    expected = np.maximum(expected, steps.proven)  # no estimate says less than a proof
    return SectionBudget(answer, pairs, steps, between, expected, expected_there)


def _of_rule(by: _Judged, n_steps: int, sections: Sequence[SectionBudget]) -> MeasuredBudget:
    proven, expected = np.full(n_steps, np.inf), np.full(n_steps, np.nan)
    between = None if any(s.between is None for s in sections) else np.full(n_steps, np.inf)
    there = np.full(n_steps, np.nan)
    for one in sections:
        rows = one.section.steps
        padding = one.section.padding
        np.minimum(proven[rows], one.steps.proven - padding, out=proven[rows])
        np.fmin(expected[rows], one.expected - padding, out=expected[rows])
        if between is not None and one.between is not None and one.expected_between is not None:
            own = one.between.proven - padding
            last = one.section.phase.last == n_steps - 1
            covered = slice(rows.start, rows.stop if last else rows.stop - 1)
            np.minimum(between[covered], own if last else own[:-1], out=between[covered])
            np.fmin(there[rows], one.expected_between - padding, out=there[rows])
    budget = RuleBudget(by.rule, by.limits, proven, expected, between, there, by.waiver)
    return MeasuredBudget(budget, WorstMoments(by.rule, by.limits, sections))

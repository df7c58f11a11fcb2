"""What tolerances make of rules that are kept as measured: a limit that is not proven with all errors.

A rule that is broken as measured has findings of its own, and none of these. Pairs that are waived are held
against their waiver's level, all others against their rule's. What is left is a
sentence a rule. Not for: working out what tolerances leave (`clearance.budget`).
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import replace

import numpy as np

from clearance.findings.finding import (
    NOT_PROVEN,
    TOLERANCES,
    WAIVED_TOLERANCES,
    Finding,
    FindingName,
)
from clearance.findings.judgement import Judgement
from clearance.findings.of_rule import code_of, fields_at
from clearance.record.budget import RuleBudget
from clearance.record.record import Record
from clearance.record.session import Session
from clearance.record.status import STATUSES, Status
from clearance.record.wording import at_least_mm, mm, of_rule
from clearance.world.budget import Budget
from clearance.world.case import Limits
from clearance.world.plausible_recordings import not_measured, not_proven
from clearance.world.rules import Waiver

NOT_WORKED_OUT = "the remaining clearance with tolerances was not computed"


def judged_budgets(session: Session, judgement: Judgement) -> tuple[RuleBudget, ...]:
    """What the tolerances leave of the pairs of each rule that are not waived, then of those of each waiver that
    the run needs and keeps to, against its level.
    """
    if session.record.budget is None:
        return ()
    if judgement.is_rest is None:
        return session.record.budget
    waived = (
        one
        for use in judgement.covering
        if use.is_of is not None
        for one in session.budget_of_pairs(use.is_of, use.waiver)
    )
    return (*session.budget_of_pairs(judgement.is_rest), *waived)


def of_budget(
    session: Session, judgement: Judgement, budgets: Sequence[RuleBudget]
) -> tuple[Finding, ...]:
    """A finding for each rule that is kept as measured, and is not proven to be with the tolerances; with waivers,
    one for each of them too whose level is not.

    Args:
        budgets: those of `judged_budgets`.
    """
    if session.record.case.tolerance is None:
        return ()
    return (*_of_rules(session, judgement, budgets), *_of_waivers(session, budgets))


def _of_rules(
    session: Session, judgement: Judgement, budgets: Sequence[RuleBudget]
) -> Iterator[Finding]:
    record = session.record
    broken = {
        one.name for one in judgement.judging if code_of(one) >= STATUSES.index(Status.VIOLATED)
    }
    known = {one.rule: one for one in budgets if one.waiver is None}
    for rule in judgement.rest:
        if rule.name in broken:
            continue
        if rule.name not in known:
            yield replace(_named(record, rule.name, rule.limits), text=NOT_WORKED_OUT)
        elif not known[rule.name].keeps:
            yield _not_kept(session, _named(record, rule.name, rule.limits), known[rule.name])


def _of_waivers(session: Session, budgets: Sequence[RuleBudget]) -> Iterator[Finding]:
    for one in budgets:
        if one.waiver is not None and not one.keeps:
            yield _not_kept(session, _of_waiver(session.record, one.waiver, one), one)


def _of_waiver(record: Record, waiver: Waiver, one: RuleBudget) -> Finding:
    """A finding of the pairs of a waiver, under the patterns that it is of."""
    a, b = waiver.between
    named = _named(record, one.rule, one.limits)
    name = FindingName(record.case.name, WAIVED_TOLERANCES, one.rule, (a, b))
    text = f"{waiver} allows {waiver.at_least * 1000:g} mm or more"
    return replace(named, id=name.id, kind=WAIVED_TOLERANCES, body_a=a, body_b=b, text=text)


def _named(record: Record, rule: str, limits: Limits) -> Finding:
    """A finding of a rule of which nothing else is known."""
    tolerance = record.case.tolerance
    accepted = tolerance is not None and tolerance.unproven_ok
    name = FindingName(record.case.name, TOLERANCES, rule, ())
    return name.finding(status=NOT_PROVEN, fail=limits.fail, warn=limits.warn, accepted=accepted)


def _not_kept(session: Session, named: Finding, budget: RuleBudget) -> Finding:
    """A finding with what is proven, and the moment that the errors bring nearest."""
    named = replace(named, proven=budget.least)
    worst = session.least_left(budget)
    if not worst:
        return named
    moment = worst[0].moment
    found = replace(
        named,
        body_a=named.body_a or moment.link,
        body_b=named.body_b or moment.obstacle,
        **fields_at(session.record, moment),
    )
    return found.with_moves(session.record.moves)


def budget_lines(record: Record) -> tuple[str, ...]:
    """A sentence for each rule on what is proven and what is expected; none without tolerances."""
    budget = record.case.tolerance
    if budget is None or record.budget is None:
        return ()
    return tuple(_line(record, budget, one) for one in record.budget)


def tolerance_lines(record: Record) -> tuple[str, ...]:
    """These, and which grasps are taken as exact."""
    exact = [f"{one.part} by {one.by}" for one in record.case.carries if one.exact_grasp]
    lines = budget_lines(record)
    return (*lines, f"Grasps taken as exact: {', '.join(exact)}.") if lines and exact else lines


def _line(record: Record, budget: Budget, one: RuleBudget) -> str:
    proven, expected = one.least, least_expected(one)
    basis = "the samples only" if one.between is None else _motion_text(record)
    waived = " (waived pairs among them)" if record.case.waivers else ""
    remaining = f"{at_least_mm(proven)} remain{waived}"
    if proven <= 0.0:
        remaining = "contact is not ruled out"  # a number below 0 says no depth
    line = f"With all errors at their worst at once {remaining}{of_rule(one.rule)}; proven for {basis}."
    if expected is not None:
        spread = f"{budget.coverage:g} sigma, estimate{'' if one.between is not None else ' at the samples'}"
        line += f" Expected ({spread}): {mm(expected)} mm."
    return line


def _motion_text(record: Record) -> str:
    """The motion, less what of it is not proven or not measured."""
    if not_proven(record.case):
        return "the motion, less its unproven stretches"
    return "the motion that is measured" if not_measured(record.case) else "the motion"


def least_expected(one: RuleBudget) -> float | None:
    """[m] The least expected clearance, of the motion where that is certified. None where it is not worked out.

    Never told below what is proven: three deviations of a single uniform error are more than its worst.
    """
    found = np.append(one.expected, [] if one.expected_between is None else one.expected_between)
    known = found[np.isfinite(found)]
    return max(float(known.min()), one.least) if len(known) else None

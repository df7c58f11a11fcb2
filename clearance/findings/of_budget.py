"""What tolerances make of rules that are kept as measured: a limit that is not proven with all errors.

A rule that is broken as measured has findings of its own, and none of these. Waivers are of what is measured: no
finding of these is waived, and pairs that are waived count as all others. Not for: working out what the
tolerances leave (`clearance.budget`).
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import replace

from clearance.findings.finding import NOT_PROVEN, TOLERANCES, Finding, FindingName
from clearance.findings.of_rule import joints_of
from clearance.findings.standing import code_of
from clearance.simulate.budget_answer import RuleBudget
from clearance.simulate.record import Record
from clearance.simulate.rule_answer import RuleAnswer
from clearance.simulate.status import STATUSES, Status
from clearance.world.case import Limits

NOT_WORKED_OUT = "what the tolerances leave was not worked out"

OF_WHAT_OCCURS = "its waiver is of what is measured, not of what errors can bring"


def of_budget(record: Record, judging: Sequence[RuleAnswer]) -> tuple[Finding, ...]:
    """A finding for each rule that is kept as measured, and is not proven to be with the tolerances.

    Args:
        judging: what decides of each rule, less what is waived.
    """
    return tuple(_of_rules(record, judging))


def _of_rules(record: Record, judging: Sequence[RuleAnswer]) -> Iterator[Finding]:
    if record.case.tolerance is None:
        return
    broken = {one.name for one in judging if code_of(one) >= STATUSES.index(Status.VIOLATED)}
    known = {one.rule: one for one in record.budget or ()}
    for rule in record.rules:
        if rule.name in broken:
            continue
        if rule.name not in known:
            yield replace(_named(record, rule.name, rule.limits), text=NOT_WORKED_OUT)
        elif not known[rule.name].keeps:
            yield _not_kept(record, known[rule.name])


def _named(record: Record, rule: str, limits: Limits) -> Finding:
    """A finding of a rule of which nothing else is known."""
    tolerance = record.case.tolerance
    return Finding(
        id=FindingName(record.case.name, TOLERANCES, rule, ()).id,
        kind=TOLERANCES,
        rule=rule,
        body_a="",
        body_b="",
        occurrence=0,
        status=NOT_PROVEN,
        clearance=None,
        proven=None,
        fail=limits.fail,
        warn=limits.warn,
        accepted=tolerance is not None and tolerance.unproven_ok,
    )


def _not_kept(record: Record, budget: RuleBudget) -> Finding:
    named = replace(_named(record, budget.rule, budget.limits), proven=budget.least)
    if not budget.worst:
        return named
    moment = budget.worst[0].moment
    waived = bool(record.case.waivers) and moment.clearance < budget.limits.fail
    return replace(
        named,
        body_a=moment.link,
        body_b=moment.obstacle,
        clearance=float(moment.clearance),
        time=float(moment.time),
        time_b=moment.time_b,
        step=int(moment.step),
        between=moment.between,
        point_a=_point(moment.point_link),
        point_b=_point(moment.point_obstacle),
        joints=joints_of(record, moment),
        text=OF_WHAT_OCCURS if waived else "",
    )


def _point(point: tuple[float, float, float]) -> tuple[float, float, float]:
    x, y, z = (float(value) for value in point)
    return x, y, z

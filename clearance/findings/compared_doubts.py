"""What stands beside the findings of two runs, held against each other: what is in doubt or not known any more.

A run that finds nothing has not passed by that: its input may be suspect, or less may have been looked at than
before. Not for: findings (`comparison`), nor what a doubt is (`doubts`).
"""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass

from clearance.findings.doubts import NOT_CHECKED, WARNING, Doubt
from clearance.findings.findings_file import FindingList
from clearance.findings.measurement_conditions import MeasurementConditions

MOST_NAMED = 3
"""Pairs that are named of those that are not measured any more."""


@dataclass(frozen=True)
class ComparedDoubt:
    """A doubt of one or both of two runs.

    Attributes:
        before, now: whether each has it.
    """

    doubt: Doubt
    before: bool
    now: bool

    @property
    def alarms(self) -> bool:
        """True if it is new and no mere note: nobody has accepted it, and it was not known before."""
        alarming = self.doubt.fails or self.doubt.kind in (NOT_CHECKED, WARNING)
        return self.now and not self.before and alarming


def doubts_compared(before: FindingList, now: FindingList) -> tuple[ComparedDoubt, ...]:
    """The doubts of both, compared by their words: those that alarm first, then those of now, then the others."""
    known = {one: None for one in (*now.doubts, *before.doubts)}
    rows = [ComparedDoubt(one, one in before.doubts, one in now.doubts) for one in known]
    return tuple(sorted(rows, key=lambda row: (not row.alarms, not row.now)))


def known_less(before: FindingList, now: FindingList) -> tuple[str, ...]:
    """What is not known of now as it was before, one line each: the proof, its method, clocks, pairs, findings."""
    old, new = before.measured, now.measured
    return tuple([*_proven_less(old, new), *_measured_less(old, new), *_listed_less(before, now)])


def _proven_less(old: MeasurementConditions, new: MeasurementConditions) -> Iterator[str]:
    if (old.basis, new.basis) == ("motion", "samples"):
        yield "the motion was proven, and only the samples are looked at"
    if old.basis != "pose" == new.basis:
        yield "a motion was checked, and now only a single pose is"
    if (old.method, new.method) == ("exact", "paper"):
        yield "the method was exact, and is paper, without guarantee"
    if _slack(new) < _slack(old):
        yield f"clock slack was {slack_text(old)}, and is {slack_text(new)}: other clocks are not covered"


def _measured_less(old: MeasurementConditions, new: MeasurementConditions) -> Iterator[str]:
    """Pairs that were measured and are left out, for some time at least."""
    known = {tuple(sorted(pair)) for block in old.unmeasured for pair in block}
    lost = [
        f"{a} - {b}"
        for block in new.unmeasured
        for a, b in block
        if tuple(sorted((a, b))) not in known
        and (old.has_body(a) if b == "*" else old.has_pair(a, b))
    ]
    if lost:
        more = f" and {len(lost) - MOST_NAMED} more" if len(lost) > MOST_NAMED else ""
        yield f"not measured as before: {', '.join(lost[:MOST_NAMED])}{more}"


def _listed_less(before: FindingList, now: FindingList) -> Iterator[str]:
    """That findings may be missing, where they were not; a run that passes is missing none that fails it."""
    if not any(finding.fails for finding in now.findings):
        return
    if now.incomplete and not before.incomplete:
        yield f"findings may be missing: {now.incomplete}"
    if now.not_listed > before.not_listed:
        yield f"{now.not_listed:,} findings are not listed"


def _slack(conditions: MeasurementConditions) -> float:
    """[s]"""
    return float("inf") if conditions.clock_slack == "not tied" else float(conditions.clock_slack)


def slack_text(conditions: MeasurementConditions) -> str:
    """How far clocks may be apart."""
    slack = conditions.clock_slack
    return slack if isinstance(slack, str) else f"{slack:g} s"

"""A run held against a baseline: what is new, worse, unchanged, better, gone or not comparable.

Findings are matched by kind, rule, bodies and occurrence. A run that finds nothing has not passed by that: its
input may be suspect, or less may have been looked at than before. So what stands beside findings is compared too.
Not for: files (`findings_file`), nor how it is shown (`report.comparison`).
"""

from __future__ import annotations

from collections import Counter
from collections.abc import Iterator
from dataclasses import dataclass
from enum import StrEnum
from functools import cached_property
from typing import Any

from clearance.findings.doubts import NOT_CHECKED, WARNING, Doubt
from clearance.findings.finding import OF_TOLERANCES, ORDER, PROFILE, TOLERANCES, UNPROVEN, Finding
from clearance.findings.findings_file import FindingList
from clearance.findings.known_less import known_less, shorter_or_smaller, slack_text
from clearance.findings.measurement_conditions import MeasurementConditions
from clearance.record.status import Status
from clearance.record.wording import depth_text

TOLERANCE = 1e-4
"""[m] A clearance that differs by no more is unchanged: how far a proven bound is from what occurs, by default."""

_ALIKE = frozenset({"steps", "pairs", "limit"})
"""What can be asked for without a change of what is found."""


class FindingChange(StrEnum):
    """What became of a finding, in the order in which they are told."""

    NEW = "new"
    WORSE = "worse"
    NOT_COMPARABLE = "not comparable"
    UNCHANGED = "unchanged"
    BETTER = "better"
    GONE = "gone"


@dataclass(frozen=True)
class ComparedFinding:
    """A finding of one or both of two runs.

    Attributes:
        before, now: None where that run has none.
        why: why the two are not comparable, how deep both are, or what let the rule be broken before and does not
            now.
    """

    change: FindingChange
    before: Finding | None
    now: Finding | None
    why: str = ""

    @property
    def finding(self) -> Finding:
        """That of now, or of before where it is gone."""
        found = self.now or self.before
        assert found is not None
        return found

    @property
    def alarms(self) -> bool:
        """True if a rule is broken, without waiver, as it was not before for all that is known."""
        alarming = (FindingChange.NEW, FindingChange.WORSE, FindingChange.NOT_COMPARABLE)
        return self.now is not None and self.now.fails and self.change in alarming


@dataclass(frozen=True)
class ComparedDoubt:
    """A doubt of one or both of two runs.

    Attributes:
        before, now: None where that run has none.
    """

    before: Doubt | None
    now: Doubt | None

    @property
    def doubt(self) -> Doubt:
        """That of now, or of before where it is gone."""
        found = self.now or self.before
        assert found is not None
        return found

    @property
    def change(self) -> str:
        """What became of it: new, gone, as before, or changed in names of files or figures."""
        if self.before is None or self.now is None:
            return "new" if self.before is None else "gone"
        return "as before" if self.before == self.now else "changed"

    @property
    def alarms(self) -> bool:
        """True if it is new and no mere note: nobody has accepted it, and it was not known before."""
        alarming = self.doubt.fails or self.doubt.kind in (NOT_CHECKED, WARNING)
        return self.change == "new" and alarming


@dataclass(frozen=True)
class Comparison:
    """Two runs held against each other.

    Attributes:
        before, now: the cases' names. rows: new ones first, of each change the worst first.
        whole: why nothing is comparable, where that is so.
        doubts: what stands beside the findings of either run, what alarms first.
        less: what is not known any more that was known before, one line each.
        shorter: how the motion is shorter than before, or obstacles smaller, one line each; that fails nothing.
        excused: findings that are waived now and were not, or to a lower level; that alone fails nothing either.
    """

    before: str
    now: str
    rows: tuple[ComparedFinding, ...]
    whole: str = ""
    doubts: tuple[ComparedDoubt, ...] = ()
    less: tuple[str, ...] = ()
    shorter: tuple[str, ...] = ()
    excused: tuple[Finding, ...] = ()

    @cached_property
    def counts(self) -> dict[str, int]:
        """How many rows of each change there are, without those of which there are none."""
        found = Counter(row.change for row in self.rows)
        return {str(change): found[change] for change in FindingChange if found[change]}

    @property
    def passed(self) -> bool:
        """True if nothing alarms, and as much is known as before."""
        alarms = any(row.alarms for row in self.rows) or any(one.alarms for one in self.doubts)
        return not (alarms or self.less)


@dataclass(frozen=True)
class ComparedCase:
    """A case of one or both of two batches.

    Attributes:
        comparison: of its findings; None where one of the two has no answer of it.
        why: then, what became of it, one line.
        alarms: then, whether it fails as it was not known to do, or is not known any more.
    """

    name: str
    comparison: Comparison | None = None
    why: str = ""
    alarms: bool = False

    @property
    def passed(self) -> bool:
        """True if nothing of it alarms."""
        return self.comparison.passed if self.comparison is not None else not self.alarms


@dataclass(frozen=True, eq=False)
class BatchComparison:
    """Two batches held against each other.

    Attributes:
        cases: in the order of now, then those that only before has.
        waiver_faults: what is wrong now with waivers that cases share, and was not before, one line each.
    """

    cases: tuple[ComparedCase, ...]
    waiver_faults: tuple[str, ...] = ()

    @cached_property
    def counts(self) -> dict[str, int]:
        """How many findings there are of each change, of all cases."""
        found: Counter[str] = Counter()
        for one in self.cases:
            found.update(one.comparison.counts if one.comparison is not None else {})
        return {str(change): found[change] for change in FindingChange if found[change]}

    @property
    def failing(self) -> tuple[ComparedCase, ...]:
        """The cases that alarm, or of which less is known."""
        return tuple(one for one in self.cases if not one.passed)

    @property
    def passed(self) -> bool:
        """True if nothing alarms, and as much is known as before."""
        return not (self.failing or self.waiver_faults)


def compared(before: FindingList, now: FindingList, tolerance: float = TOLERANCE) -> Comparison:
    """The findings of now held against those of before.

    Args:
        tolerance: [m] a clearance that differs by no more is unchanged.
    """
    whole = _measured_otherwise(before.measured, now.measured)
    rows = list(_Comparer(before, now, tolerance, whole).rows())
    order = list(FindingChange)
    rows.sort(key=lambda row: (order.index(row.change), row.finding.standing))
    doubts, less = doubts_compared(before, now), known_less(before, now)
    shorter = tuple(shorter_or_smaller(before, now))
    excused = tuple(row.now for row in rows if row.now is not None and _is_excused(row))
    return Comparison(before.case, now.case, tuple(rows), whole, doubts, less, shorter, excused)


def _measured_otherwise(before: MeasurementConditions, now: MeasurementConditions) -> str:
    """Why nothing of two runs is comparable; empty where something is."""
    for what in ("method", "motion", "basis", "certify_gap"):
        one, other = (_condition_text(what, getattr(found, what)) for found in (before, now))
        if one != other:
            return f"{what.replace('_', ' ')} was {one}, and is {other}"
    if before.clock_slack != now.clock_slack:
        return f"clock slack was {slack_text(before)}, and is {slack_text(now)}"
    if before.need != now.need and not {before.need, now.need} <= _ALIKE:
        return f"need was {before.need}, and is {now.need}"
    return ""


def _condition_text(what: str, value: Any) -> str:
    """A condition; a length in millimetres."""
    return f"{value * 1000:g} mm" if what == "certify_gap" and value is not None else str(value)


_Key = tuple[str, str, tuple[str, ...], int]


@dataclass(frozen=True, eq=False)
class _Comparer:
    before: FindingList
    now: FindingList
    tolerance: float
    whole: str

    def rows(self) -> Iterator[ComparedFinding]:
        old, new = (_by_key(found) for found in (self.before, self.now))
        for key in dict.fromkeys([*new, *old]):
            row = self._row(old.get(key), new.get(key))
            if row is not None:
                yield row

    def _row(self, before: Finding | None, now: Finding | None) -> ComparedFinding | None:
        one = now or before
        assert one is not None
        why = self.whole or self._changed_inputs(one)
        if before is None or now is None:
            if one.status == Status.CLEAR:
                return None  # kept, and in the other run another pair of the rule was nearer
            why = why or self._not_known(one, self.before if before is None else self.now)
            change = FindingChange.NEW if before is None else FindingChange.GONE
        else:
            why = why or _no_number(before, now)
            change = self._change(before, now)
            excuse = "" if why else _lost_excuse(before, now)
            if excuse:
                return ComparedFinding(FindingChange.WORSE, before, now, excuse)
            if not why and before.status == now.status == Status.CONTACT:
                return self._of_contacts(before, now)
        return ComparedFinding(FindingChange.NOT_COMPARABLE if why else change, before, now, why)

    def _change(self, before: Finding, now: Finding) -> FindingChange:
        are_clear = [finding.status == Status.CLEAR for finding in (before, now)]
        if (
            are_clear[0] != are_clear[1]
        ):  # what is clear is listed only where it is the nearest pair of its rule
            return FindingChange.NEW if are_clear[0] else FindingChange.GONE
        ranks = [ORDER.index(finding.status) for finding in (before, now)]
        if ranks[0] != ranks[1]:
            return FindingChange.WORSE if ranks[1] > ranks[0] else FindingChange.BETTER
        old, new = _level(before), _level(now)
        if old is None or new is None:
            return FindingChange.UNCHANGED
        gained = new - old
        if abs(gained) <= self.tolerance:
            return FindingChange.UNCHANGED
        return FindingChange.BETTER if gained > 0.0 else FindingChange.WORSE

    def _of_contacts(self, before: Finding, now: Finding) -> ComparedFinding:
        """Two contacts by the bounds of their depths; where these overlap, the same contact is unchanged."""
        was, is_now = before.depth, now.depth
        same = was == is_now and _contact(before) == _contact(now)
        if was is None or is_now is None or same:
            return ComparedFinding(FindingChange.UNCHANGED, before, now)
        why = f"{depth_text(is_now)}, and was {depth_text(was)}"
        if is_now.at_least > was.penetration + self.tolerance:
            return ComparedFinding(FindingChange.WORSE, before, now, why)
        if is_now.penetration < was.at_least - self.tolerance:
            return ComparedFinding(FindingChange.BETTER, before, now, why)
        is_open = is_now.penetration > was.at_least + self.tolerance
        change = FindingChange.NOT_COMPARABLE if is_open else FindingChange.UNCHANGED
        return ComparedFinding(change, before, now, why if is_open else "")

    def _changed_inputs(self, finding: Finding) -> str:
        """Why a finding of one run says nothing of the other: its robot or its rule is another."""
        for robot in {self._robot_of(name) for name in (finding.body_a, finding.body_b)} - {""}:
            if not self._same(robot):
                return f"robot {robot!r} has changed"
        old, new = (
            [rule for rule in found.measured.rules_of(finding.status) if rule.name == finding.rule]
            for found in (self.before, self.now)
        )
        if old != new:
            return f"rule {finding.rule!r} has changed"
        tolerances = {self.before.measured.tolerances, self.now.measured.tolerances}
        if finding.kind in OF_TOLERANCES and len(tolerances) > 1:
            return "its tolerances have changed"
        return ""

    def _robot_of(self, body: str) -> str:
        """The robot that a body is, or is a link of, in either run; empty for an obstacle."""
        robots = [*self.before.measured.robots, *self.now.measured.robots]
        return next((one.name for one in robots if body in (*one.links, one.name)), "")

    def _same(self, robot: str) -> bool:
        old, new = (
            {one.name: one.sha256 for one in found.measured.robots}
            for found in (self.before, self.now)
        )
        return robot in old and old.get(robot) == new.get(robot)

    def _not_known(self, finding: Finding, other: FindingList) -> str:
        """Why it is not known how a finding of one run stood in the other, which has none of it."""
        if other.incomplete:
            return other.incomplete
        if other.not_listed:
            return f"{other.not_listed} findings are not listed"
        old, new = (found.measured.rules_of(finding.status) for found in (self.before, self.now))
        if old != new:
            return "other rules may have judged it"
        has_pair = finding.body_b and finding.kind not in (UNPROVEN, *OF_TOLERANCES)
        if has_pair and not other.measured.has_pair(finding.body_a, finding.body_b):
            return (
                "the pair was not measured" if other is self.before else "the pair is not measured"
            )
        return ""


def _level(finding: Finding) -> float | None:
    """[m] What says how it stands: the clearance, or what is proven where nothing nearer is seen."""
    return finding.proven if finding.kind in (UNPROVEN, *OF_TOLERANCES) else finding.clearance


def _no_number(before: Finding, now: Finding) -> str:
    """Why it is not known which of two findings is worse; empty where it is."""
    if before.status == now.status == Status.CONTACT:
        if _contact(before) == _contact(now) or (before.depth and now.depth):
            return ""
        return "both are in contact, elsewhere or at another time, and it is not known how deep"
    if _level(before) is not None and _level(now) is not None:
        return ""
    if before.status == now.status == Status.CLEAR or before.text == now.text:
        return ""
    return "how far it is broken is only known in words, and they differ"


def _contact(finding: Finding) -> list[float | None]:
    """[s] and [m] when and where two bodies touch, to a micrometre."""
    of = (finding.time, finding.start, finding.end, *(finding.point_a or ()))
    return [None if one is None else round(one, 6) for one in of]


def _lost_excuse(before: Finding, now: Finding) -> str:
    """What let a rule be broken before and does not now, in a few words; empty for nothing."""
    if before.fails or not now.fails or not before.broken:
        return ""
    return f"{'waived' if before.waived else 'accepted'} before, and is not now"


def _is_excused(row: ComparedFinding) -> bool:
    """True if it is waived now, and was not, or to a level that is higher."""
    was, is_now = (None if one is None else one.waived for one in (row.before, row.now))
    return is_now is not None and (was is None or is_now.at_least < was.at_least)


def _by_key(found: FindingList) -> dict[_Key, Finding]:
    return {_key(finding): finding for finding in found.findings}


def _key(finding: Finding) -> _Key:
    """What a finding's name is of, without the case."""
    bodies = tuple(sorted((finding.body_a, finding.body_b)))
    if finding.kind in (PROFILE, TOLERANCES):
        bodies = ()
    return finding.kind, finding.rule, bodies, finding.occurrence


def doubts_compared(before: FindingList, now: FindingList) -> tuple[ComparedDoubt, ...]:
    """The doubts of both: those that alarm first, then those of now, then the others.

    A doubt of each is the same one if they differ in names of files and in figures alone.
    """
    left = [one for one in before.doubts if one not in now.doubts]
    rows = []
    for one in now.doubts:
        was = one if one in before.doubts else next((o for o in left if o.is_like(one)), None)
        if was in left:
            left.remove(was)
        rows.append(ComparedDoubt(was, one))
    rows += [ComparedDoubt(one, None) for one in left]
    return tuple(sorted(rows, key=lambda row: (not row.alarms, row.now is None)))

"""What a run comes to with its waivers: what they cover, what they do not, and which should go.

Pairs that a waiver is of are measured and proven apart from all others, so that none hides behind what is waived.
Not for: what a waiver is (`world.waiver`), nor the words of the verdict (`verdict`).
"""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from dataclasses import dataclass, replace
from functools import cached_property
from typing import Any

from clearance.errors import nearest_name
from clearance.findings.finding import UNPROVEN, AppliedWaiver, Finding, FindingName
from clearance.findings.of_rule import RuleFindings, code_of, why_undecided
from clearance.record.moment import Moment
from clearance.record.record import Record
from clearance.record.rule_answer import RuleAnswer
from clearance.record.session import PairTest, Session
from clearance.record.status import STATUSES, Status
from clearance.world.case import Case, Limits
from clearance.world.rules import Waiver, matches

VIOLATED = STATUSES.index(Status.VIOLATED)


@dataclass(frozen=True, eq=False)
class WaiverUse:
    """What became of one waiver.

    Attributes:
        answers: what the rules come to of its pairs alone; empty where it has none, or is expired.
        findings: those of its pairs that are not clear, waived where they are broken and it covers them.
        fault: why it fails the run, in one line; empty where it does not.
        is_of: its pairs; None where it has none.
    """

    waiver: Waiver
    answers: tuple[RuleAnswer, ...] = ()
    findings: tuple[Finding, ...] = ()
    fault: str = ""
    is_of: PairTest | None = None

    @property
    def used(self) -> bool:
        """True if something needs it."""
        return any(finding.broken for finding in self.findings)

    @property
    def covers(self) -> bool:
        """True if all that needs it is covered."""
        return self.used and not any(finding.fails for finding in self.findings)


@dataclass(frozen=True, eq=False)
class Judgement:
    """The rules of a run, with its waivers; each part is worked out when it is asked for.

    Attributes:
        rest: what the rules come to without the pairs that are waived. uses: of each waiver that is of this case.
        is_rest: the pairs that are not waived; None where all are.
    """

    session: Session
    rest: tuple[RuleAnswer, ...]
    uses: tuple[WaiverUse, ...] = ()
    is_rest: PairTest | None = None

    @cached_property
    def findings(self) -> tuple[Finding, ...]:
        """Of all rules, the worst first."""
        found = [
            *of_rules(self.session, self.rest),
            *(f for use in self.uses for f in use.findings),
        ]
        return tuple(sorted(found, key=lambda finding: finding.standing))

    @cached_property
    def worst(self) -> Moment | None:
        """The most critical moment of what decides the verdict."""
        record = self.session.record
        return self.session.worst_among(self.judging) if self.uses else record.worst

    @cached_property
    def worst_sample(self) -> Moment | None:
        """The most critical step of the same."""
        record = self.session.record
        return self.session.worst_sample_among(self.judging) if self.uses else record.worst_sample

    @cached_property
    def worst_of(self) -> dict[str, Moment | None]:
        """By rule, the most critical moment of what decides the verdict."""
        by_rule: dict[str, list[RuleAnswer]] = {}
        for answer in self.judging:
            by_rule.setdefault(answer.name, []).append(answer)
        return {name: self.session.worst_among(answers) for name, answers in by_rule.items()}

    @property
    def judging(self) -> tuple[RuleAnswer, ...]:
        """What decides the verdict: the rest, and pairs that their waiver does not cover."""
        failing = [answer for use in self.uses if not use.covers for answer in use.answers]
        return (*self.rest, *failing)

    @property
    def covering(self) -> tuple[WaiverUse, ...]:
        """The waivers that the run needs and keeps to."""
        return tuple(use for use in self.uses if use.covers)

    @property
    def faults(self) -> tuple[str, ...]:
        """Why waivers fail the run, one line each."""
        return tuple(use.fault for use in self.uses if use.fault)

    @cached_property
    def status(self) -> str:
        """The worst of what decides the verdict."""
        codes = [code_of(answer) for answer in self.judging]
        judged = [f for use in self.covering for f in use.findings if f.waived is None]
        codes += [STATUSES.index(Status(finding.status)) for finding in judged]
        return str(STATUSES[max(codes, default=0)])


def judgement_of(session: Session) -> Judgement:
    """The judgement of a run."""
    case = session.record.case
    own = tuple(waiver for waiver in case.waivers if waiver.is_of_case(case.name))
    if not own:
        return Judgement(session, session.record.rules)
    return _WaivedRun(session, own).judgement()


def of_rules(session: Session, rules: Sequence[RuleAnswer]) -> tuple[Finding, ...]:
    """The findings of some rules, the worst first."""
    found = [finding for rule in rules for finding in RuleFindings(session, rule)]
    return tuple(sorted(found, key=lambda finding: finding.standing))


@dataclass(frozen=True, eq=False)
class _WaivedRun:
    """A run held against the waivers that are of its case."""

    session: Session
    waivers: tuple[Waiver, ...]

    def judgement(self) -> Judgement:
        rules = self.session.record.rules
        broken = any(finding.broken for finding in of_rules(self.session, rules))
        uses = tuple(self._use(i, broken) for i in range(len(self.waivers)))
        used = {i for i, use in enumerate(uses) if use.used}
        if not used:
            return Judgement(self.session, rules, uses)

        def is_rest(*pair: Any) -> bool:
            return self._owner(*pair) not in used

        return Judgement(self.session, self._of_pairs(is_rest), uses, is_rest)

    def _of_pairs(self, is_meant: PairTest, *levels: float) -> tuple[RuleAnswer, ...]:
        return self.session.of_pairs(is_meant, levels=levels)

    def _owner(self, rule: str, one: tuple[str, ...], other: tuple[str, ...]) -> int:
        """The last waiver that holds and is of a pair; -1 for none."""
        own = [i for i, waiver in enumerate(self.waivers) if waiver.is_of(rule, one, other)]
        return max((i for i in own if not self._expired(i)), default=-1)

    def _expired(self, i: int) -> bool:
        today = self.session.record.today
        assert today is not None, "a case with waivers has a day"
        return self.waivers[i].is_expired(today)

    def _use(self, i: int, broken: bool) -> WaiverUse:
        waiver = self.waivers[i]
        if self._expired(i):
            return WaiverUse(waiver, fault=_unless_shared(waiver, f"has expired on {waiver.until}"))

        def is_of(*pair: Any) -> bool:
            return self._owner(*pair) == i

        answers = self._of_pairs(is_of, waiver.at_least) if broken else ()
        findings = [f for rule in answers for f in self._covered(waiver, rule)]
        if not any(finding.broken for finding in findings):
            why = f"is not needed: {self._why_not_needed(i)}"
            return WaiverUse(waiver, fault=_unless_shared(waiver, why))
        failing = [finding for finding in findings if finding.fails]
        why = why_undecided(self.session.record.case)
        fault = _fault(waiver, failing[0], why) if failing else ""
        return WaiverUse(waiver, answers, tuple(findings), fault, is_of)

    def _covered(self, waiver: Waiver, rule: RuleAnswer) -> list[Finding]:
        """What of a waiver's pairs is not clear; waived what breaks a rule and stays above the waiver's level."""
        found = [one for one in RuleFindings(self.session, rule) if one.status != Status.CLEAR]
        return [_waived(self._of_waiver(one, waiver), waiver, rule.limits) for one in found]

    def _of_waiver(self, finding: Finding, waiver: Waiver) -> Finding:
        """A finding without bodies as one of what the waiver is of."""
        if finding.kind != UNPROVEN:
            return finding
        a, b = waiver.between
        name = FindingName(
            self.session.record.case.name, finding.kind, finding.rule, waiver.between
        )
        return replace(finding, id=name.id, body_a=a, body_b=b)

    def _why_not_needed(self, i: int) -> str:
        """Why nothing needs a waiver: what it names is not there, or keeps its rule."""

        unknown = unknown_name(self.session.record, self.waivers[i])
        return unknown or "its pairs keep their limits without it, or a later waiver covers them"


def _unless_shared(waiver: Waiver, why: str) -> str:
    """Why a waiver should go; empty for one that other cases may need."""
    return "" if waiver.shared else f"{waiver} {why}"


def _waived(finding: Finding, waiver: Waiver, limits: Limits) -> Finding:
    """The finding as its waiver leaves it: waived if it stays above the waiver's level, as far as proven."""
    known = [value for value in (finding.clearance, finding.proven) if value is not None]
    if (
        not finding.broken
        or finding.status == Status.CONTACT
        or not known
        or limits.below(min(known), waiver.at_least)
    ):
        return finding
    until = str(waiver.until)
    applied = AppliedWaiver(waiver.at_least, waiver.reason, waiver.by, until, finding.proven)
    return replace(finding, waived=applied)


def _fault(waiver: Waiver, failing: Finding, undecided: str) -> str:
    """Why a waiver does not cover a finding; `undecided` says why its level may be neither proven nor passed."""
    level = f"{waiver.at_least * 1000:g} mm"
    if failing.status == Status.CONTACT:
        return f"{waiver} does not cover contact"
    if failing.clearance is not None and failing.clearance < waiver.at_least:
        return f"{waiver} allows {level} or more, and less occurs"
    return f"{waiver} allows {level} or more, which is not proven; {undecided}"


def unknown_name(record: Record, waiver: Waiver) -> str:
    """What a waiver names that is not there, with the nearest name; empty where all is."""
    return unknown_among([record.case], [rule.name for rule in record.rules], waiver)


def unknown_among(cases: Iterable[Case], rules: Sequence[str], waiver: Waiver) -> str:
    """What a waiver names that none of some cases has, with the nearest name; empty where all is.

    Args:
        rules: the names of those of all cases.
    """
    if not any(matches(name, waiver.rule) for name in rules):
        return f"no rule is called {waiver.rule!r}; {nearest_name(waiver.rule, rules)}"
    bodies = list(dict.fromkeys(name for case in cases for name in _bodies(case)))
    for pattern in waiver.between:
        if not any(matches(name, pattern) for name in bodies):
            return f"no body is called {pattern!r}; {nearest_name(pattern, bodies)}"
    return ""


def _bodies(case: Case) -> list[str]:
    """All names that bodies go by: of a link also the one without its robot's."""
    links = [link for placed in case.robots for link in placed.robot.link_names]
    full = [
        case.prefix_of(placed) + link for placed in case.robots for link in placed.robot.link_names
    ]
    return [*full, *links, *(obstacle.name for obstacle in case.obstacles)]

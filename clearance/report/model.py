"""What a run comes to, for whoever tells it: made once from record and session, each part when it is asked for.

Terminal, page, summary, JUnit, Markdown, annotations and notebook are made from this alone. Not for: how anything
is told (`topics`), nor measuring, which the session does.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field
from functools import cached_property
from typing import Any

from clearance.findings.comparison import Comparison
from clearance.findings.finding import Finding
from clearance.findings.findings_file import FindingList, finding_list_of
from clearance.findings.judgement import Judgement, judgement_of
from clearance.findings.of_budget import judged_budgets, of_budget
from clearance.findings.of_record import findings_of, why_incomplete
from clearance.findings.verdict import Verdict, verdict_of
from clearance.record.budget import BudgetMoment, RuleBudget
from clearance.record.moment import Moment
from clearance.record.record import Record
from clearance.record.sensitivity import Sensitivity
from clearance.record.session import Session


@dataclass(frozen=True, eq=False)
class ReportModel:
    """A run, to be told."""

    session: Session

    @property
    def record(self) -> Record:
        """The record of the run."""
        return self.session.record

    @cached_property
    def judgement(self) -> Judgement:
        """The rules of the run with its waivers."""
        return judgement_of(self.session)

    @cached_property
    def of_tolerances(self) -> tuple[Finding, ...]:
        """The limits that are not proven with the case's tolerances."""
        return of_budget(self.session, self.judgement, self.budgets)

    @cached_property
    def budgets(self) -> tuple[RuleBudget, ...]:
        """What tolerances leave, of pairs with one limit each: those of a rule, and apart those of a waiver."""
        return judged_budgets(self.session, self.judgement)

    @cached_property
    def verdict(self) -> Verdict:
        """What the run comes to, why, and what that rests on."""
        return verdict_of(self.record, self.judgement, self.of_tolerances)

    @cached_property
    def sensitivity(self) -> Sensitivity:
        """The slopes of the clearance at the most critical moment of what decides the verdict."""
        worst, judgement = self.verdict.worst, self.judgement
        rules = judgement.judging if worst is judgement.worst else self.record.rules
        return self.session.sensitivity(rules, worst)

    @cached_property
    def findings(self) -> tuple[Finding, ...]:
        """What each rule comes to between which bodies, the worst first; what is waived is among it."""
        return findings_of(self.record, self.judgement, self.of_tolerances)

    @property
    def may_lack(self) -> str:
        """Why a run that fails may have findings that are not listed; empty where none can."""
        fails = any(finding.fails for finding in self.findings)
        return why_incomplete(self.session) if fails else ""

    @cached_property
    def finding_list(self) -> FindingList:
        """What `findings.json` holds: the findings, and what is needed to compare them with another run's."""
        return finding_list_of(self.session, self.findings, self.judgement)

    @cached_property
    def worst_of(self) -> dict[str, Moment | None]:
        """By rule, the most critical moment of what it judges, in contact the deepest."""
        return {rule.name: self.session.worst_among([rule]) for rule in self.record.rules}

    @cached_property
    def least_left(self) -> dict[RuleBudget, list[BudgetMoment]]:
        """By each of `budgets`, the moments at which tolerances leave least, with what each error takes."""
        session = self.session
        return {
            one: [session.error_sources(one, i) for i in range(len(session.least_left(one)))]
            for one in self.budgets
        }


@dataclass(frozen=True, eq=False)
class PageContent:
    """What the sections of a page are made from.

    Attributes:
        summary: as `summary.json` has it. pictures: of each profile as SVG, by its name.
        verdict, findings, comparison: those of the run, and what became of findings since a baseline, if there is
            one. may_lack: why findings may be missing; empty where none can.
    """

    summary: dict[str, Any]
    verdict: Verdict
    pictures: Mapping[str, str] = field(default_factory=dict)
    findings: Sequence[Finding] = ()
    comparison: Comparison | None = None
    may_lack: str = ""

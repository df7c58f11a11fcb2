"""Runs of the records of `records`: what reports, findings and replays say of them, without an engine."""

from __future__ import annotations

import io
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field, fields
from functools import partial
from pathlib import Path
from typing import Any

from rich.console import Console

from clearance.record.budget import BudgetMoment, RuleBudget
from clearance.record.names import pair_names
from clearance.record.record import PairMinimum, Record
from clearance.record.rule_answer import RuleAnswer
from clearance.report import page
from clearance.report.junit_cases import write_run_junit
from clearance.report.model import PageContent, ReportModel
from clearance.report.terminal import print_answer
from clearance.run import Run
from clearance.simulate.answers.contact.rows import FoundContacts
from clearance.simulate.answers.rule_pairs import MeasuredRule, SampleMoments
from clearance.simulate.measure.measured import MeasuredSteps
from clearance.simulate.replay import replay
from clearance.simulate.session import MeasuringSession
from tests.report.records import SOURCES, measure


@dataclass(frozen=True, eq=False)
class MadeSession(MeasuringSession):
    """What can be asked of a record made by hand.

    Attributes:
        minima: the least of each pair. left: by rule, the moments at which tolerances leave least.
        pictures: of profiles, by name.
    """

    minima: tuple[PairMinimum, ...] = field(kw_only=True)
    left: Mapping[str, tuple[BudgetMoment, ...]] = field(default_factory=dict, kw_only=True)
    pictures: Mapping[str, str] = field(default_factory=dict, kw_only=True)

    @property
    def _by_answer(self) -> dict[RuleAnswer, MeasuredRule]:
        return dict(zip(self.record.rules, self.rules, strict=True))

    def pair_minima(self, most: int | None = None) -> tuple[PairMinimum, ...]:
        return self.minima[:most]

    def motion_minima(self, most: int | None = None) -> tuple[PairMinimum, ...]:
        return self.minima[:most]

    def least_left(self, budget) -> tuple[BudgetMoment, ...]:
        return self.left.get(budget.rule, ())


def run_of(made: Record | Run, minima: Sequence[PairMinimum] | None = None, **known: Any) -> Run:
    """The run of a record; `minima`: the least of its pairs, if they are not what its corners say."""
    if isinstance(made, Run):
        return made
    if minima is None:
        minima = measure(made.motions, made.case)[1]
    if made.budget:
        known.setdefault("left", {one.rule: (_least_left(made, one),) for one in made.budget})
    contacts = FoundContacts(made.contacts, ()) if len(made.contacts) else None
    rules = tuple(_measured(made, rule) for rule in made.rules)
    return Run(made, MadeSession(made, rules, contacts, minima=tuple(minima), **known), None)


def _least_left(made: Record, one: RuleBudget) -> BudgetMoment:
    """The step at which a budget leaves least."""
    moment = made.worst_sample
    return BudgetMoment(moment, float(one.proven.min()), float(one.expected[moment.step]), SOURCES)


def _measured(made: Record, rule: RuleAnswer) -> MeasuredRule:
    names = pair_names(made.case, made.pairs)
    found = MeasuredSteps(**_fields(rule.measurement), measure_pair_minima=None)
    moment_at = partial(SampleMoments(names, made.motions).at, rule.measurement, rule.name)
    given = _fields(rule) | {"measurement": found, "certificate": None}
    return MeasuredRule(**given, moment_at=moment_at)


def _fields(given: Any) -> dict[str, Any]:
    return {one.name: getattr(given, one.name) for one in fields(given)}


def summary_of(made: Record | Run) -> dict[str, Any]:
    """What `summary.json` holds of it."""
    return run_of(made).summary


def verdict_of(made: Record | Run):
    """What it comes to."""
    return run_of(made).verdict


def findings_of(made: Record | Run):
    """Its findings."""
    return run_of(made).findings


def finding_list_of(made: Record | Run):
    """What `findings.json` holds of it."""
    return run_of(made).finding_list


def model_of(made: Record | Run) -> ReportModel:
    """What is told of it."""
    return run_of(made).report


def content_of(made: Record | Run, **changes: Any) -> PageContent:
    """What its page is made from; `changes` replace keys of its summary."""
    run = run_of(made)
    return PageContent(run.summary | changes, run.verdict)


def page_of(made: Record | Run, replay: Any = None) -> str:
    """Its page."""
    return page.page_of(content_of(made), replay or replay_of(made))


def printed(made: Record | Run, folder: Path | None = None) -> list[str]:
    """The lines that a wide terminal shows of it; `folder`: of its report."""
    console = Console(file=io.StringIO(), width=200)
    print_answer(model_of(made), folder, console)
    return console.file.getvalue().splitlines()


def replay_of(made: Record | Run | MeasuringSession, *args: Any, **options: Any):
    """Its drawing data."""
    session = made if isinstance(made, MeasuringSession) else run_of(made).session
    return replay.replay_of(session, *args, **options)


def write(made: Record | Run, folder, *args: Any, **options: Any) -> None:
    """Writes its report."""
    run_of(made).save(folder, *args, **options)


def write_junit(made: Record | Run, path) -> None:
    """Writes it as JUnit."""
    write_run_junit(model_of(made), path)

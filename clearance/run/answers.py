"""The parts of a run answered: the robot moves, and each section is measured and proven.

Not for: what may be asked (`question`), and the record that is made of it (`made`).
"""

from __future__ import annotations

from collections import defaultdict
from collections.abc import Sequence
from dataclasses import dataclass, replace
from itertools import accumulate

import numpy as np

from clearance.record.session import PairTest
from clearance.run.question import Question
from clearance.simulate.measure.measure import measure
from clearance.simulate.measure.measured import MeasuredSteps, ProvenMotion
from clearance.simulate.measure.resources import DEFAULT_RESOURCES, Resources
from clearance.simulate.measure.sections import Section, SectionAnswer, SectionPlan, section_plan
from clearance.world.case import Case
from clearance.world.clocks import require_clocks
from clearance.world.motion import Motion, kinematic_motion
from clearance.world.pairs import names_of
from clearance.world.reach import require_within_reach
from clearance.world.timeline import Timeline, timeline_of
from clearance.world.used_rules import require_rules_used


@dataclass(frozen=True, eq=False)
class MeasurementPlan:
    """What is measured for a question: when what moves how, and which pairs are measured when.

    Attributes:
        own: the motion of each robot at the times of its own table.
    """

    question: Question
    own: tuple[Motion, ...]
    timeline: Timeline
    sections: SectionPlan

    @property
    def motions(self) -> tuple[Motion, ...]:
        """One for each of the case's robots, with the run's steps."""
        return self.timeline.motions


def measurement_plan(question: Question) -> MeasurementPlan:
    """What is measured for a question, and when.

    Raises:
        NothingToMeasure: no pair is left. BadDimension: a body far beyond any place that a robot works at.
        UnknownLink, UnknownObstacle: in a rule. BadInput: a rule of no pair, or of times that clocks do not have.
    """
    case = question.case
    require_clocks(case)
    own = _motions(question)
    timeline = timeline_of(case, own)
    sections = section_plan(timeline)
    require_rules_used(case, sections.pairs, sections.unmeasured)
    for phase in timeline.phases:
        require_within_reach(phase.case, phase.motions)
    return MeasurementPlan(question, own, timeline, sections)


def _motions(question: Question) -> tuple[Motion, ...]:
    """The motion of each robot at the times of its own table."""
    case = question.case
    if question.motion != "simulated":
        return tuple(kinematic_motion(placed) for placed in case.robots)
    from clearance.simulate.physics.motions import simulated_motions

    return simulated_motions(case)


def section_answers(plan: MeasurementPlan, resources: Resources) -> list[SectionAnswer]:
    """What each section of a run comes to."""
    sections = plan.sections.sections
    parts = _resources_of(sections, resources)
    answers = [
        _of_section(plan.question, section, own)
        for section, own in zip(sections, parts, strict=True)
    ]
    if not plan.question.certify or plan.question.need not in ("steps", "pairs"):
        return answers
    return _with_least_proven(answers, parts)


def _with_least_proven(
    answers: Sequence[SectionAnswer], parts: Sequence[Resources]
) -> list[SectionAnswer]:
    """The answers, in which the least clearance of each rule is proven to within `LEAST_GAP`."""
    least: dict[int, float] = defaultdict(lambda: np.inf)
    for one in answers:
        least[one.section.rule] = min(least[one.section.rule], _least_of(one, "upper_bound"))
    sharpened = list(answers)
    for i in np.argsort([_least_of(one, "lower_bound") for one in answers], kind="stable").tolist():
        rule = answers[i].section.rule
        sharpened[i] = _sharpened(answers[i], least[rule], parts[i])
        least[rule] = min(least[rule], _least_of(sharpened[i], "upper_bound"))
    return sharpened


def _least_of(one: SectionAnswer, bound: str) -> float:
    """[m] the least clearance of a section that is proven, or that occurs."""
    if one.certificate is None:
        return np.inf
    return float(getattr(one.certificate, bound).min()) - one.section.padding


def _sharpened(one: SectionAnswer, least: float, own: Resources) -> SectionAnswer:
    """An answer, proven finer where its bound is below the least clearance of its rule [m]."""
    if one.certificate is None or not one.section.tied:
        return one
    from clearance.simulate.measure.certify import with_least_proven

    reached = least + one.section.padding
    proven = with_least_proven(one.section.in_motion, one.found, one.certificate, reached, own)
    return one if proven is one.certificate else replace(one, certificate=proven)


def _resources_of(sections: Sequence[Section], resources: Resources) -> list[Resources]:
    """What each section may use: all of it where there is one, else with its own rows and its part of the
    progress.
    """
    if len(sections) == 1:
        return [resources]
    ends = list(accumulate(section.phase.n_steps for section in sections))
    before = [0, *ends[:-1]]
    return [
        resources.of_section(section.number, (start, end), ends[-1])
        for section, start, end in zip(sections, before, ends, strict=True)
    ]


def _of_section(question: Question, section: Section, own: Resources) -> SectionAnswer:
    if not section.tied:
        from clearance.simulate.measure.clocks.rows import measure_two_clocks

        gap = question.certify_gap if question.certify else None
        return SectionAnswer(section, *measure_two_clocks(section.of_two_clocks, gap, own))
    found = _measurement(question, section, own)
    certificate = _certificate(question, section, found, own) if question.certify else None
    return SectionAnswer(section, found, certificate)


def _measurement(question: Question, section: Section, resources: Resources) -> MeasuredSteps:
    if question.method == "exact":
        return measure(section.in_motion, question.need, resources)
    from clearance.query.paper import NO_TOLERANCE
    from clearance.simulate.measure.measure_paper import measure_paper

    tolerance = question.paper_tolerance or NO_TOLERANCE
    return measure_paper(section.in_motion, resources.progress, tolerance, section.phase.first)


def _certificate(
    question: Question, section: Section, found: MeasuredSteps, resources: Resources
) -> ProvenMotion:
    from clearance.simulate.measure.certify import certify_motion

    levels = tuple(level + section.padding for level in section.levels)
    gap, need = question.certify_gap, question.need
    return certify_motion(section.in_motion, found, gap, need, resources, levels)


def answers_of_pairs(
    plan: MeasurementPlan,
    is_meant: PairTest,
    need: str | None = None,
    levels: tuple[float, ...] = (),
) -> tuple[SectionPlan, list[SectionAnswer]]:
    """The sections of some pairs alone, and what they come to; none where no pair is meant."""
    case = plan.question.case
    question = plan.question if need is None else replace(plan.question, need=need, certify=True)
    parts = [_part(case, section, is_meant) for section in plan.sections.sections]
    sections = tuple(replace(part, levels=levels) for part in parts if part.pairs)
    found = [_of_section(question, section, DEFAULT_RESOURCES) for section in sections]
    return replace(plan.sections, sections=sections), found


def _part(case: Case, section: Section, is_meant: PairTest) -> Section:
    """The section with those of its pairs that are meant."""
    rule = case.limits.rule_names[section.rule]
    measurable = [
        i for i, pair in enumerate(section.pairs)
        if is_meant(rule, names_of(case, pair.a), names_of(case, pair.b))
    ]  # fmt: skip
    return replace(
        section,
        pairs=tuple(section.pairs[i] for i in measurable),
        places=section.places[measurable],
    )

"""A question answered: the robot moves, all is measured, proven, looked into, and held against a peer.

One after another, each part from what is known before it; then the record is made, once. Not for: what may be
asked (`question`), nor what it comes to (`result`).
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import dataclass, replace
from functools import cache, partial
from itertools import accumulate
from typing import TYPE_CHECKING

from clearance.run.commanded_case import commanded_case
from clearance.run.notices import notices_of
from clearance.run.question import Question
from clearance.simulate.budget_answer import RuleBudget
from clearance.simulate.certificate import Certificate
from clearance.simulate.contact.sequence import ContactSequence
from clearance.simulate.fingerprint import fingerprint
from clearance.simulate.measure import measure
from clearance.simulate.measurement import Measurement
from clearance.simulate.parts import blocks
from clearance.simulate.record import (
    CommandedCourse,
    CrossCheck,
    PairTest,
    ProfileAnswer,
    Record,
    Samples,
)
from clearance.simulate.replay.bodies import notes_on_drawing
from clearance.simulate.resources import DEFAULT_RESOURCES, Resources
from clearance.simulate.rule_answer import RuleAnswer
from clearance.simulate.run_answer import RunAnswer, judged
from clearance.simulate.section_answer import SectionAnswer
from clearance.simulate.sections import Section, SectionPlan, section_plan
from clearance.simulate.steps import PairMinima, cut_throughout, every_pair, step_table
from clearance.world.case import Case
from clearance.world.clocks import require_clocks
from clearance.world.motion import Motion, kinematic_motion
from clearance.world.notice import WRAP, Notice
from clearance.world.pairs import names_of
from clearance.world.plausible_wrap import shortest_reading
from clearance.world.reach import require_within_reach
from clearance.world.timeline import Timeline, timeline_of
from clearance.world.used_rules import require_rules_used

if TYPE_CHECKING:
    import pyarrow as pa


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


@dataclass(frozen=True, eq=False)
class Answers:
    """All that was found.

    Attributes:
        cross_check: None where no peer was asked. budget: None where the case has no tolerances.
    """

    judged: RunAnswer
    samples: Samples
    contacts: ContactSequence | tuple[()]
    notices: tuple[Notice, ...]
    profiles: tuple[ProfileAnswer, ...]
    cross_check: CrossCheck | None
    budget: tuple[RuleBudget, ...] | None


def answered(question: Question, resources: Resources) -> Record:
    """The record of a question.

    Raises:
        NothingToMeasure: no pair is left. BadDimension: a body far beyond any place that a robot works at.
        BadInput: what only answering finds, as a profile that has no plane.
    """
    plan = measurement_plan(question)
    if resources.rows.folder is not None:
        pairs = plan.sections.pairs
        resources.rows.ask(fingerprint(question.case, plan.own, pairs, question.of_rows))
    record = _record(plan, _answers(plan, resources))
    other = shortest_reading(question.case)
    return record if other is None else _with_both_readings(record, question, other)


def _with_both_readings(record: Record, question: Question, other: Case) -> Record:
    """The record whose notices on turns that could go either way say what both come to.

    Args:
        other: the case in which they go the shortest way.
    """
    from clearance.report.wording import mm

    asked = replace(question, case=other, cross_check=False, contact="none", body_gaps=False)
    nearest = [one.nearest for one in (record, answered(asked, DEFAULT_RESOURCES))]
    told = ["contact" if one.touches else f"{mm(one.clearance)} mm" for one in nearest]
    text = f"least clearance as written: {told[0]}, the shortest way: {told[1]}"
    notices = (
        replace(one, text=f"{one.text}; {text}") if one.kind == WRAP else one
        for one in record.notices
    )
    return replace(record, notices=tuple(notices))


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


def _answers(plan: MeasurementPlan, resources: Resources) -> Answers:
    question = plan.question
    parts = _resources_of(plan.sections.sections, resources)
    found = [
        _of_section(question, section, own)
        for section, own in zip(plan.sections.sections, parts, strict=True)
    ]
    all_judged = judged(plan.sections, found, question.case, plan.motions)
    budget = _budget(plan, found, resources)
    samples = _samples(plan, all_judged, budget, resources)
    return Answers(
        all_judged,
        samples,
        _contacts(plan, found),
        notices_of(question, plan.sections, all_judged.certificate, found),
        _profiles(plan),
        _peer(question.case, samples, found, resources) if question.cross_check else None,
        budget,
    )


def _resources_of(sections: Sequence[Section], resources: Resources) -> list[Resources]:
    """What each section may use: all of it where there is one, else with its own rows and its part of the
    progress.
    """
    if len(sections) == 1:
        return [resources]
    ends = list(accumulate(section.phase.n_steps for section in sections))
    before = [0, *ends[:-1]]
    return [
        resources.of_section(section.number, start, ends[-1])
        for section, start in zip(sections, before, strict=True)
    ]


def _of_section(question: Question, section: Section, own: Resources) -> SectionAnswer:
    if not section.tied:
        from clearance.simulate.clocks.rows import measure_two_clocks

        gap = question.certify_gap if question.certify else None
        return SectionAnswer(section, *measure_two_clocks(section.of_two_clocks, gap, own))
    found = _measurement(question, section, own)
    certificate = _certificate(question, section, found, own) if question.certify else None
    return SectionAnswer(section, found, certificate)


def _measurement(question: Question, section: Section, resources: Resources) -> Measurement:
    if question.method == "exact":
        return measure(section.in_motion, question.need, resources)
    from clearance.query.paper import NO_TOLERANCE
    from clearance.simulate.measure_paper import measure_paper

    tolerance = question.paper_tolerance or NO_TOLERANCE
    return measure_paper(section.in_motion, resources.progress, tolerance, section.phase.first)


def _certificate(
    question: Question, section: Section, found: Measurement, resources: Resources
) -> Certificate:
    from clearance.simulate.certify import certify_motion

    levels = tuple(level + section.padding for level in section.levels)
    gap, need = question.certify_gap, question.need
    return certify_motion(section.in_motion, found, gap, need, resources, levels)


def _budget(
    plan: MeasurementPlan, found: Sequence[SectionAnswer], resources: Resources
) -> tuple[RuleBudget, ...] | None:
    """What the case's tolerances leave of what was found."""
    if plan.question.case.tolerance is None:
        return None
    from clearance.budget.answer import budget_answers

    return budget_answers(plan.question.case, plan.sections, found, resources)


def _samples(
    plan: MeasurementPlan,
    judged: RunAnswer,
    budget: tuple[RuleBudget, ...] | None,
    resources: Resources,
) -> Samples:
    case, motions, pairs = plan.question.case, plan.motions, plan.sections.pairs
    simulated = plan.question.motion == "simulated"
    left = None
    if budget is not None:
        from clearance.budget.columns import columns_of

        left = columns_of(budget)

    @cache
    def table() -> pa.Table:
        batches = step_table(case, motions, pairs, judged, with_error=simulated, left=left)
        return resources.rows.table("steps", batches)

    unmeasured = (*plan.sections.unmeasured, *cut_throughout(case, pairs, judged.found))
    on_disk = resources.rows.folder is not None  # which may be gone when somebody looks
    return Samples(case, motions, table() if on_disk else table, unmeasured)


def _contacts(plan: MeasurementPlan, found: Sequence[SectionAnswer]) -> ContactSequence | tuple[()]:
    """What the steps in contact look like from near; loads what that needs only where there is one."""
    if not any((one.found.clearance[b] <= 0.0).any() for one in found for b in _blocks(one)):
        return ()
    from clearance.simulate.contact.phases import contacts_of

    return contacts_of(plan.question.case, found, plan.motions[0].times, plan.question.contact)


def _blocks(answer: SectionAnswer) -> Iterator[slice]:
    return blocks(len(answer.found.clearance))


def _profiles(plan: MeasurementPlan) -> tuple[ProfileAnswer, ...]:
    if not plan.question.case.profiles:
        return ()
    from clearance.profiles.answer import answer_profiles

    return answer_profiles(plan.question.case, plan.timeline)


def _peer(
    case: Case, samples: Samples, found: Sequence[SectionAnswer], resources: Resources
) -> CrossCheck | None:
    """The comparison with FCL; None where nothing is measured but clouds that are too large for it."""
    from clearance.crosscheck import cross_check, cross_check_sections, is_too_large

    if any(is_too_large(case, pair) for one in found for pair in one.section.pairs):
        parts = [part for one in found if one.section.tied for part in _for_peer(case, one)]
        return cross_check_sections(parts, resources.progress) if parts else None
    if len(found) == 1 and found[0].section.padding == 0.0:
        return cross_check(samples, resources.progress)
    return cross_check_sections(found, resources.progress)


def _for_peer(case: Case, answer: SectionAnswer) -> Iterator[SectionAnswer]:
    """A section measured again without its pairs with clouds that are too large, if others are left."""
    from clearance.crosscheck import is_too_large

    section = answer.section
    kept = [i for i, pair in enumerate(section.pairs) if not is_too_large(case, pair)]
    if len(kept) == len(section.pairs):
        yield answer
    elif kept:
        pairs = tuple(section.pairs[i] for i in kept)
        part = replace(section, pairs=pairs, places=section.places[kept])
        yield SectionAnswer(part, measure(part.in_motion), None)


def _record(plan: MeasurementPlan, answers: Answers) -> Record:
    question, samples, judged = plan.question, answers.samples, answers.judged
    case, motions, pairs = question.case, plan.motions, plan.sections.pairs
    return Record(
        case=case,
        motions=motions,
        table=samples.table,
        unmeasured=samples.unmeasured,
        pair_minima=PairMinima(case, motions, pairs, judged.rules),
        tally=judged.found.tally,
        rules=judged.rules,
        timeline=plan.timeline,
        method=question.method,
        paper_tolerance=question.paper_tolerance,
        motion_kind=question.motion,
        need=question.need,
        every_pair=every_pair(case, pairs, judged),
        certificate=judged.certificate,
        notes=(
            *case.notes,
            *(note for made in motions for note in made.notes),
            *notes_on_drawing(case),
        ),
        notices=answers.notices,
        contacts=answers.contacts,
        depths_asked=question.contact != "none",
        profiles=answers.profiles,
        cross_check=answers.cross_check,
        budget=answers.budget,
        of_pairs=partial(_of_pairs, plan),
        budget_of_pairs=None if answers.budget is None else partial(_budget_of_pairs, plan),
        today=question.today,
        body_gaps=question.body_gaps,
        commanded=_commanded(question) if question.motion == "recorded" else None,
    )


def _commanded(question: Question) -> CommandedCourse:
    """What the case comes to at the steps of what was commanded, where its robots have done something else."""
    asked = Question(
        commanded_case(question.case), certify=False, contact="none", today=question.today
    )
    record = answered(asked, DEFAULT_RESOURCES)
    return CommandedCourse(record.steps["time"].to_numpy(), record.clearances, record.worst_sample)


def _of_pairs(
    plan: MeasurementPlan,
    is_meant: PairTest,
    need: str | None = None,
    levels: tuple[float, ...] = (),
) -> tuple[RuleAnswer, ...]:
    """What the rules come to of some pairs alone, as if there were no others."""
    some, found = _some(plan, is_meant, need, levels)
    return judged(some, found, plan.question.case, plan.motions).rules if found else ()


def _budget_of_pairs(plan: MeasurementPlan, is_meant: PairTest) -> tuple[RuleBudget, ...]:
    """What the case's tolerances leave of some pairs alone."""
    from clearance.budget.answer import budget_answers

    some, found = _some(plan, is_meant)
    return budget_answers(plan.question.case, some, found, DEFAULT_RESOURCES) if found else ()


def _some(
    plan: MeasurementPlan,
    is_meant: PairTest,
    need: str | None = None,
    levels: tuple[float, ...] = (),
) -> tuple[SectionPlan, list[SectionAnswer]]:
    """The sections of some pairs alone, and what they come to; none where no pair is meant."""
    case = plan.question.case
    question = plan.question if need is None else replace(plan.question, need=need)
    parts = [_part(case, section, is_meant) for section in plan.sections.sections]
    sections = tuple(replace(part, levels=levels) for part in parts if part.pairs)
    found = [_of_section(question, section, DEFAULT_RESOURCES) for section in sections]
    return replace(plan.sections, sections=sections), found


def _part(case: Case, section: Section, is_meant: PairTest) -> Section:
    """The section with those of its pairs that are meant."""
    rule = case.limits.rule_names[section.rule]
    kept = [
        i for i, pair in enumerate(section.pairs)
        if is_meant(rule, names_of(case, pair.a), names_of(case, pair.b))
    ]  # fmt: skip
    return replace(
        section, pairs=tuple(section.pairs[i] for i in kept), places=section.places[kept]
    )

"""The record of a question, made once of all that is found, with the session that can be asked for more.

One after another, each part from what is known before it. Not for: measuring (`answers`), nor what the record
comes to (`result`).
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import dataclass, replace
from typing import TYPE_CHECKING

from clearance.record.fingerprint import fingerprint
from clearance.record.record import CommandedCourse, CrossCheck, Record, Samples
from clearance.record.rows.blocks import blocks
from clearance.record.steps import StepColumns
from clearance.record.table import Table
from clearance.record.wording import mm
from clearance.run.answers import MeasurementPlan, measurement_plan, section_answers
from clearance.run.notices import notices_of
from clearance.run.question import Question
from clearance.run.session import RunSession
from clearance.simulate.answers.deepest import WorstMoments
from clearance.simulate.answers.run_answer import JudgedRun, cut_throughout, every_pair, judged
from clearance.simulate.measure.measure import measure
from clearance.simulate.measure.resources import DEFAULT_RESOURCES, Resources
from clearance.simulate.measure.sections import SectionAnswer
from clearance.simulate.replay.bodies import notes_on_drawing
from clearance.world.case import Case
from clearance.world.notice import WRAP, Notice, worst_first
from clearance.world.placed_robot import PlacedRobot
from clearance.world.plausible_wrap import shortest_reading

if TYPE_CHECKING:
    from clearance.budget.answer import MeasuredBudget
    from clearance.profiles.answer import AnsweredProfile
    from clearance.simulate.answers.contact.rows import FoundContacts


_NO_RESPONSE = "contact_response has no effect: the motion is not simulated"


@dataclass(frozen=True, eq=False)
class Answers:
    """All that was found.

    Attributes:
        cross_check: None where no peer was asked. budget: None where the case has no tolerances. contacts: None
            where nothing touches.
    """

    judged: JudgedRun
    samples: Samples
    contacts: FoundContacts | None
    notices: tuple[Notice, ...]
    profiles: tuple[AnsweredProfile, ...]
    cross_check: CrossCheck | None
    budget: tuple[MeasuredBudget, ...] | None


def answered(question: Question, resources: Resources) -> RunSession:
    """The record of a question, with what can be asked for more.

    Raises:
        NothingToMeasure: no pair is left. BadDimension: a body far beyond any place that a robot works at.
        BadInput: what only answering finds, as a profile that has no plane.
    """
    plan = measurement_plan(question)
    if resources.rows.folder is not None:
        pairs = plan.sections.pairs
        resources.rows.ask(fingerprint(question.case, plan.own, pairs, question.of_rows))
    answers = _answers(plan, resources)
    record = _record(plan, answers)
    other = shortest_reading(question.case)
    if other is not None:
        record = _with_both_readings(record, question, other)
    return RunSession(
        record,
        answers.judged.rules,
        answers.contacts,
        plan=plan,
        budgets=answers.budget or (),
        drawings={one.answer.name: one.picture for one in answers.profiles},
    )


def _with_both_readings(record: Record, question: Question, other: Case) -> Record:
    """The record whose notices on turns that could go either way say what both come to.

    Args:
        other: the case in which they go the shortest way.
    """
    asked = replace(question, case=other, cross_check=False, contact="none", body_gaps=False)
    nearest = [one.nearest for one in (record, answered(asked, DEFAULT_RESOURCES).record)]
    texts = ["contact" if one.touches else f"{mm(one.clearance)} mm" for one in nearest]
    text = f"least clearance as written: {texts[0]}, the shortest way: {texts[1]}"
    notices = (
        replace(one, text=f"{one.text}; {text}") if one.kind == WRAP else one
        for one in record.notices
    )
    return replace(record, notices=tuple(notices))


def _answers(plan: MeasurementPlan, resources: Resources) -> Answers:
    question, found = plan.question, section_answers(plan, resources)
    run = judged(plan.sections, found, question.case, plan.motions)
    budget = _budget(plan, found, resources)
    samples = _samples(plan, run, budget, resources)
    peer = _peer(question.case, found, resources) if question.cross_check else None
    profiles = _profiles(plan)
    measured = notices_of(
        question, plan.sections, plan.timeline.phases, run.answer.certificate, found
    )
    return Answers(
        run,
        samples,
        _contacts(plan, found, resources),
        worst_first(
            [
                *measured,
                *(notice for made in plan.own for notice in made.notices),
                *(notice for one in profiles for notice in one.notices),
            ]
        ),
        profiles,
        peer,
        budget,
    )


def _budget(
    plan: MeasurementPlan, found: Sequence[SectionAnswer], resources: Resources
) -> tuple[MeasuredBudget, ...] | None:
    """What the case's tolerances leave of what was found."""
    if plan.question.case.tolerance is None:
        return None
    from clearance.budget.answer import budget_answers

    return budget_answers(plan.question.case, plan.sections, found, resources)


def _samples(
    plan: MeasurementPlan,
    run: JudgedRun,
    budget: tuple[MeasuredBudget, ...] | None,
    resources: Resources,
) -> Samples:
    case, motions, pairs = plan.question.case, plan.motions, plan.sections.pairs
    simulated = plan.question.motion == "simulated"
    remaining = None
    if budget is not None:
        from clearance.budget.columns import columns_of

        remaining = columns_of([one.remaining for one in budget])
    columns = StepColumns(case, motions, pairs, run.answer, simulated, remaining)
    on_disk = resources.rows.folder is not None  # which may be gone when somebody reads it
    table: StepColumns | Table = columns
    if on_disk:
        table = resources.rows.table("table", columns.n_steps, columns.batches())
    unmeasured = (*plan.sections.unmeasured, *cut_throughout(case, pairs, run.rules))
    return Samples(case, motions, table, unmeasured)


def _contacts(
    plan: MeasurementPlan, found: Sequence[SectionAnswer], resources: Resources
) -> FoundContacts | None:
    """The pairs in contact and the overlaps asked for; loads what that needs only where there is one."""
    if not any((one.found.clearance[b] <= 0.0).any() for one in found for b in _blocks(one)):
        return None
    from clearance.simulate.answers.contact.rows import contacts_of

    question, pairs, times = plan.question, plan.sections.pairs, plan.motions[0].times
    return contacts_of(question.case, pairs, found, times, question.contact, resources.progress)


def _blocks(answer: SectionAnswer) -> Iterator[slice]:
    return blocks(len(answer.found.clearance))


def _profiles(plan: MeasurementPlan) -> tuple[AnsweredProfile, ...]:
    if not plan.question.case.profiles:
        return ()
    from clearance.profiles.answer import answer_profiles

    return answer_profiles(plan.question.case, plan.timeline)


def _peer(case: Case, found: Sequence[SectionAnswer], resources: Resources) -> CrossCheck | None:
    """The comparison with FCL; None where all that is measured is clouds too large for it, or clocks not tied."""
    from clearance.crosscheck import cross_check

    parts = [part for one in found if one.section.tied for part in _for_peer(case, one)]
    return cross_check(parts, resources.progress) if parts else None


def _for_peer(case: Case, answer: SectionAnswer) -> Iterator[SectionAnswer]:
    """A section measured again without its pairs with clouds that are too large, if others are left."""
    from clearance.crosscheck import is_too_large

    section = answer.section
    measurable = [i for i, pair in enumerate(section.pairs) if not is_too_large(case, pair)]
    if len(measurable) == len(section.pairs):
        yield answer
    elif measurable:
        pairs = tuple(section.pairs[i] for i in measurable)
        part = replace(section, pairs=pairs, places=section.places[measurable])
        yield SectionAnswer(part, measure(part.in_motion), None)


def _record(plan: MeasurementPlan, answers: Answers) -> Record:
    question, samples, run = plan.question, answers.samples, answers.judged
    case, motions, pairs = question.case, plan.motions, plan.sections.pairs
    contacts = () if answers.contacts is None else answers.contacts.rows
    depths_asked = question.contact != "none"
    worst = WorstMoments(contacts, depths_asked and run.answer.certificate is not None)
    sample = worst.at_steps(run.rules)
    assert sample is not None, "the nearest pair of a run is known"
    return Record(
        case=case,
        motions=motions,
        table=samples.table,
        unmeasured=samples.unmeasured,
        tally=run.answer.found.tally,
        rules=tuple(run.answer.rules),
        timeline=plan.timeline,
        pairs=pairs,
        worst_sample=sample,
        worst=worst.of_motion(run.rules, sample),
        method=question.method,
        paper_tolerance=question.paper_tolerance,
        motion_kind=question.motion,
        need=question.need,
        every_pair=every_pair(case, pairs, run.answer),
        certificate=run.answer.certificate,
        notes=(
            *case.notes,
            *(note for made in motions for note in made.notes),
            *notes_on_drawing(case),
            *([_NO_RESPONSE] if case.contact_response and question.motion != "simulated" else []),
        ),
        notices=answers.notices,
        contacts=contacts,
        depths_asked=depths_asked,
        profiles=tuple(one.answer for one in answers.profiles),
        cross_check=answers.cross_check,
        budget=None if answers.budget is None else tuple(one.remaining for one in answers.budget),
        today=question.today,
        body_gaps=question.body_gaps,
        commanded=_commanded(question) if question.motion == "recorded" else None,
    )


def _commanded(question: Question) -> CommandedCourse:
    """What the case comes to at the steps of what was commanded, where its robots have done something else."""
    asked = Question(
        commanded_case(question.case), certify=False, contact="none", today=question.today
    )
    record = answered(asked, DEFAULT_RESOURCES).record
    return CommandedCourse(record.rows.numbers("time"), record.clearances, record.worst_sample)


def commanded_case(case: Case) -> Case:
    """The case with what its robots were commanded in place of what was recorded, without tolerances."""
    return replace(case, robots=tuple(map(_as_commanded, case.robots)), tolerance=None)


def _as_commanded(placed: PlacedRobot) -> PlacedRobot:
    found = placed.recording
    if found is None:
        return placed
    return replace(placed, trajectory=found.commanded, timing=found.timing, recording=None)

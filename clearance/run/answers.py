"""A question answered: the robot moves, all is measured, proven, looked into, and held against a peer.

One after another, each part from what is known before it; then the record is made, once. Not for: what may be
asked (`question`), nor what it comes to (`result`).
"""

from __future__ import annotations

from dataclasses import dataclass

from clearance.run.question import Question
from clearance.simulate import inside
from clearance.simulate.fingerprint import fingerprint
from clearance.simulate.kinematic import kinematic_motion
from clearance.simulate.measure import Measurement, measure
from clearance.simulate.parts import blocks
from clearance.simulate.record import (
    Certificate,
    ContactSequence,
    CrossCheck,
    ProfileAnswer,
    Record,
    Samples,
)
from clearance.simulate.resources import Resources
from clearance.simulate.steps import PairMinima, cut_throughout, every_pair, step_table
from clearance.world.case import Omission
from clearance.world.motion import Motion
from clearance.world.notice import Notice, worst_first
from clearance.world.pairs import Pair, measured_pairs
from clearance.world.reach import require_within_reach


@dataclass(frozen=True, eq=False)
class MeasurementPlan:
    """What is measured for a question.

    Attributes:
        motions: one for each of the case's robots.
        unmeasured: links and pairs that are left out.
    """

    question: Question
    motions: tuple[Motion, ...]
    pairs: list[Pair]
    unmeasured: list[Omission]


@dataclass(frozen=True, eq=False)
class Answers:
    """All that was found.

    Attributes:
        certificate: None where nothing is proven. cross_check: None where no peer was asked.
    """

    measurement: Measurement
    certificate: Certificate | None
    samples: Samples
    contacts: ContactSequence | tuple[()]
    notices: tuple[Notice, ...]
    profiles: tuple[ProfileAnswer, ...]
    cross_check: CrossCheck | None


def answered(question: Question, resources: Resources) -> Record:
    """The record of a question.

    Raises:
        NothingToMeasure: no pair is left. BadDimension: a body far beyond any place that a robot works at.
        BadInput: what only answering finds, as a profile that has no plane.
    """
    plan = _plan(question)
    if resources.rows.folder is not None:
        case = question.case
        resources.rows.ask(fingerprint(case, plan.motions, plan.pairs, question.of_rows))
    return _record(plan, _answers(plan, resources))


def _plan(question: Question) -> MeasurementPlan:
    pairs, unmeasured = measured_pairs(question.case)
    motions = _motions(question)
    require_within_reach(question.case, motions)
    return MeasurementPlan(question, motions, pairs, unmeasured)


def _motions(question: Question) -> tuple[Motion, ...]:
    case = question.case
    if question.motion == "kinematic":
        return tuple(kinematic_motion(placed) for placed in case.robots)
    from clearance.simulate.bullet import simulated_motion

    return tuple(
        simulated_motion(placed, case.obstacles, contact_response=case.contact_response)
        for placed in case.robots
    )


def _answers(plan: MeasurementPlan, resources: Resources) -> Answers:
    question = plan.question
    found = _measurement(plan, resources)
    certificate = _certificate(plan, found, resources) if question.certify else None
    samples = _samples(plan, found, certificate, resources)
    return Answers(
        found,
        certificate,
        samples,
        _contacts(plan, found),
        _notices(plan, certificate),
        _profiles(samples),
        _peer(samples, resources) if question.cross_check else None,
    )


def _measurement(plan: MeasurementPlan, resources: Resources) -> Measurement:
    question = plan.question
    what = question.case, plan.motions, plan.pairs
    if question.method == "exact":
        return measure(*what, question.need, resources)
    from clearance.query.paper import NO_TOLERANCE
    from clearance.simulate.measure_paper import measure_paper

    return measure_paper(*what, resources.progress, question.paper_tolerance or NO_TOLERANCE)


def _certificate(plan: MeasurementPlan, found: Measurement, resources: Resources) -> Certificate:
    from clearance.simulate.certify import certify_motion

    question = plan.question
    return certify_motion(
        question.case,
        plan.motions,
        plan.pairs,
        found,
        question.certify_gap,
        question.need,
        resources,
    )


def _samples(
    plan: MeasurementPlan, found: Measurement, certificate: Certificate | None, resources: Resources
) -> Samples:
    case, motions, pairs = plan.question.case, plan.motions, plan.pairs
    simulated = plan.question.motion == "simulated"
    batches = step_table(case, motions, pairs, found, certificate=certificate, with_error=simulated)
    unmeasured = (*plan.unmeasured, *cut_throughout(case, pairs, found))
    return Samples(case, motions, resources.rows.table("steps", batches), unmeasured)


def _contacts(plan: MeasurementPlan, found: Measurement) -> ContactSequence | tuple[()]:
    """What the steps in contact look like from near; loads what that needs only where there is one."""
    if not any((found.clearance[block] <= 0.0).any() for block in blocks(len(found.clearance))):
        return ()
    from clearance.simulate.contact import find_contacts

    question = plan.question
    return find_contacts(
        question.case, plan.motions, plan.pairs, found.clearance, found.pair, question.contact
    )


def _notices(plan: MeasurementPlan, certificate: Certificate | None) -> tuple[Notice, ...]:
    """All that a reader of the verdict must know: of the case, and of how it was measured."""
    question = plan.question
    exact = question.method == "exact"
    measured = inside.notices(question.case, plan.motions, plan.pairs) if exact else ()
    proven = () if certificate is None else certificate.notices
    return worst_first([*question.case.notices, *measured, *proven])


def _profiles(samples: Samples) -> tuple[ProfileAnswer, ...]:
    if not samples.case.profiles:
        return ()
    from clearance.profiles.answer import answer_profiles

    return answer_profiles(samples)


def _peer(samples: Samples, resources: Resources) -> CrossCheck:
    from clearance.crosscheck import cross_check

    return cross_check(samples, resources.progress)


def _record(plan: MeasurementPlan, answers: Answers) -> Record:
    question, samples, found = plan.question, answers.samples, answers.measurement
    case, motions = question.case, plan.motions
    return Record(
        case=case,
        motions=motions,
        steps=samples.steps,
        unmeasured=samples.unmeasured,
        pair_minima=PairMinima(case, motions, plan.pairs, found),
        tally=found.tally,
        method=question.method,
        paper_tolerance=question.paper_tolerance,
        motion_kind=question.motion,
        need=question.need,
        every_pair=every_pair(case, plan.pairs, found),
        certificate=answers.certificate,
        notes=(*case.notes, *(note for made in motions for note in made.notes)),
        notices=answers.notices,
        contacts=answers.contacts,
        profiles=answers.profiles,
        cross_check=answers.cross_check,
    )

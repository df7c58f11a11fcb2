"""Moments between the steps of a certified run for replay and chart: dips, and steps between distant samples."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import replace
from itertools import pairwise
from operator import attrgetter

import numpy as np

from clearance.record.certificate import Certificate, motion_codes
from clearance.record.moment import Moment
from clearance.record.rows.blocks import blocks
from clearance.record.rule_answer import standing_worst
from clearance.simulate.answers.measured_run import MeasuredRun
from clearance.simulate.answers.rule_pairs import MeasuredRule
from clearance.simulate.measure.measure import nearest_at
from clearance.simulate.measure.measured import ProvenMotion
from clearance.simulate.measure.moment_query import MomentQuery
from clearance.simulate.measure.sections import SectionAnswer
from clearance.tolerance import REACH
from clearance.world.forest import positions_along

MOST_DIPS = 500
"""Most intervals whose least moment is a frame of its own, the most critical first."""

BEYOND_REACH = 4.0 * REACH
"""[m] More than any margin, so that a worse status comes first."""

FINE = 200
"""Parts of a run; each has a frame, even if samples are farther from each other in time."""


def curve_moments(run: MeasuredRun, worst: Moment | None = None) -> list[Moment]:
    """The moments, in order of time, each of its most critical pair, waived or not, as one curve needs them.
    The times of `worst`, and of the most critical and the nearest of all are among them.
    """
    record = run.record
    if record.certificate is None:
        return []
    reported = [one for one in (worst, record.nearest, record.worst) if one and one.between]
    found = [*_evenly(run), *_dips(run.rules)]  # of one moment the last counts
    found += [_most_critical_at(run, one) for one in reported]
    each = {(one.step, one.share): one for one in found}
    return [each[key] for key in sorted(each)]


def _dips(rules: Sequence[MeasuredRule]) -> Iterator[Moment]:
    """The least moment of each interval that comes nearer than its ends, by the most critical rule."""
    worst: dict[int, tuple[float, ProvenMotion]] = {}
    for rule in rules:
        own = rule.certificate
        if own is None:
            continue
        for block in blocks(len(own.pair)):
            steps = block.start + np.flatnonzero(_is_dip(rule, own, block))
            standing = own.upper_bound[steps] - rule.limits.fail
            standing -= motion_codes(own, rule.limits, block)[steps - block.start] * BEYOND_REACH
            for step, value in zip(steps.tolist(), standing.tolist(), strict=True):
                if step not in worst or value < worst[step][0]:
                    worst[step] = value, own
            worst = _first(worst) if len(worst) > 4 * MOST_DIPS else worst
    for step, (_, own) in _first(worst).items():
        yield own.moment_of(step)


def _first(worst: dict[int, tuple[float, ProvenMotion]]) -> dict[int, tuple[float, ProvenMotion]]:
    """The most critical of some steps, the worst first."""
    return {step: worst[step] for step in sorted(worst, key=lambda one: worst[one][0])[:MOST_DIPS]}


def _is_dip(rule: MeasuredRule, certificate: Certificate, block: slice) -> np.ndarray:
    """(k,) True where the motion is seen nearer than at both ends by more than the gap, or in contact."""
    clearance = rule.measurement.clearance[block.start : block.stop + 1]
    ends = np.where(np.isnan(clearance), np.inf, clearance)
    n = block.stop - block.start
    lesser = np.minimum(ends[:n], np.append(ends[1:], np.inf)[:n])
    deeper = certificate.upper_bound[block] < lesser - certificate.gap
    touches = certificate.touches(block) & (lesser > 0.0)
    return (certificate.pair[block] >= 0) & (deeper | touches)


def _tied_answers(run: MeasuredRun) -> list[tuple[MeasuredRule, SectionAnswer]]:
    """All answers; none where clocks are not tied, which have no pair that is nearest at a time."""
    answers = [(rule, one) for rule in run.rules if rule.pairs for one in rule.pairs.answers]
    return answers if all(answer.section.tied for _, answer in answers) else []


def _most_critical_at(run: MeasuredRun, moment: Moment) -> Moment:
    """The moment, or that of another pair which is more critical at its time."""
    worst = standing_worst(
        (rule, nearest_moments(rule, answer, moment.step, np.array([moment.share]))[0])
        for rule, answer in _tied_answers(run)
        if answer.section.phase.first <= moment.step < answer.section.phase.last
    )
    names = attrgetter("rule", "link", "obstacle")
    if worst is None or names(worst) == names(moment):
        return moment
    return replace(worst, time=moment.time)


def _evenly(run: MeasuredRun) -> list[Moment]:
    """Moments in intervals that are longer than a part of the run, by the most critical pair."""
    times = run.record.motions[0].times
    part = (times[-1] - times[0]) / FINE
    answers = _tied_answers(run)
    if part <= 0.0 or not answers:
        return []
    found = []
    for step, (start, end) in enumerate(pairwise(times.tolist())):
        n_parts = int((end - start) / part)
        if n_parts < 2:
            continue
        shares = np.arange(1, n_parts) / n_parts
        own = [
            (rule, nearest_moments(rule, answer, step, shares))
            for rule, answer in answers
            if answer.section.phase.first <= step < answer.section.phase.last
        ]
        for i in range(len(shares)):
            worst = standing_worst((rule, moments[i]) for rule, moments in own)
            found += [worst] if worst is not None else []
    return found


def nearest_moments(
    rule: MeasuredRule, answer: SectionAnswer, step: int, shares: np.ndarray
) -> list[Moment]:
    """The nearest pair of a section at some shares (k,) of the interval after a step of the run."""
    section, phase = answer.section, answer.section.phase
    own = step - phase.first
    found = nearest_at(section.in_motion, positions_along(phase.case, phase.motions, own, shares))
    query = MomentQuery(phase.case, phase.motions, section.pairs)
    nearest = zip(shares.tolist(), found.pair.tolist(), strict=True)
    moments = (query.between(own, share, pair) for share, pair in nearest)
    return [one.of_run(phase.first, section.padding, rule.name) for one in moments]

"""Moments between the steps of a certified run that its replay and chart need: dips, and ways between far samples.

Not for: the frames that are made of them (`frames`).
"""

from __future__ import annotations

from collections.abc import Iterator
from itertools import pairwise

import numpy as np

from clearance.simulate.certificate import Certificate, motion_codes
from clearance.simulate.measure import nearest_at
from clearance.simulate.moment import Moment
from clearance.simulate.names import pair_names
from clearance.simulate.record import Record
from clearance.simulate.rule_answer import RuleAnswer, standing_worst
from clearance.simulate.section_answer import SectionAnswer
from clearance.tolerance import REACH
from clearance.world.forest import positions_along

MOST_DIPS = 500
"""Most intervals whose least moment is a frame of its own, those that stand worst first."""

BEYOND_REACH = 4.0 * REACH
"""[m] More than any margin: what stands worse by its status comes first."""

FINE = 200
"""Parts of a run of which each has a frame, if its samples are farther apart."""


def curve_moments(record: Record) -> list[Moment]:
    """The moments, in order of time; the one that stands worst and the nearest of all are among them."""
    if record.certificate is None:
        return []
    told = [one for one in (record.nearest, record.worst) if one.between]
    found = [*_evenly(record), *_dips(record), *told]  # of one moment the last counts
    each = {(one.step, one.share): one for one in found}
    return [each[key] for key in sorted(each)]


def _dips(record: Record) -> Iterator[Moment]:
    """The least moment of each interval that comes nearer than its ends, by the rule that stands worst then."""
    certificates, standing = [], []
    for rule in record.rules:
        own = rule.certificate
        if own is not None:
            codes = motion_codes(own, rule.limits, slice(None))
            margins = own.upper_bound - rule.limits.fail
            certificates.append(own)
            standing.append(np.where(_is_dip(rule, own), codes * BEYOND_REACH - margins, -np.inf))
    which, worst = np.argmax(standing, axis=0), np.max(standing, axis=0)
    dips = np.flatnonzero(np.isfinite(worst))
    for step in dips[np.argsort(-worst[dips], kind="stable")][:MOST_DIPS].tolist():
        yield certificates[int(which[step])].moment_of(step)


def _is_dip(rule: RuleAnswer, certificate: Certificate) -> np.ndarray:
    """(n,) True where the motion is seen nearer than at both ends by more than the gap, or in contact."""
    ends = np.where(np.isnan(rule.measurement.clearance), np.inf, rule.measurement.clearance)
    lesser = np.minimum(ends, np.append(ends[1:], np.inf))
    deeper = certificate.upper_bound < lesser - certificate.gap
    touches = certificate.touches(slice(None)) & (lesser > 0.0)
    return (certificate.pair >= 0) & (deeper | touches)


def _evenly(record: Record) -> list[Moment]:
    """Moments in intervals that are longer than a part of the run, by the pair that stands worst then."""
    times = record.motions[0].times
    part = (times[-1] - times[0]) / FINE
    answers = [(rule, one) for rule in record.rules if rule.pairs for one in rule.pairs.answers]
    if part <= 0.0 or not all(answer.section.tied for _, answer in answers):
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
    rule: RuleAnswer, answer: SectionAnswer, step: int, shares: np.ndarray
) -> list[Moment]:
    """The nearest pair of a section at some shares (k,) of the interval after a step of the run."""
    section, phase = answer.section, answer.section.phase
    own = step - phase.first
    found = nearest_at(section.in_motion, positions_along(phase.case, phase.motions, own, shares))
    names = pair_names(phase.case, section.pairs)
    start, end = phase.motions[0].times[own : own + 2]
    return [
        Moment(
            step=step,
            time=float(start + share * (end - start)),
            between=True,
            clearance=float(found.clearance[i] - section.padding),
            link=names[0][found.pair[i]],
            obstacle=names[1][found.pair[i]],
            point_link=tuple(found.points[i, 0].tolist()),
            point_obstacle=tuple(found.points[i, 1].tolist()),
            positions=tuple(motion.positions_after(own, share) for motion in phase.motions),
            share=share,
            rule=rule.name,
            touches=bool(found.clearance[i] <= 0.0),
        )
        for i, share in enumerate(shares.tolist())
    ]

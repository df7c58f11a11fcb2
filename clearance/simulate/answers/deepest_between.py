"""Penetration depth between the steps, for contacts with few steps in them."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import replace

import numpy as np

from clearance.errors import ClearanceError
from clearance.query.contact import contact
from clearance.record.moment import Depth, Moment
from clearance.simulate.answers.pairs_alone import can_be_alone, near_alone
from clearance.simulate.answers.rule_pairs import MeasuredRule
from clearance.simulate.answers.stretches import RuleStretches
from clearance.simulate.measure.moment_query import MomentQuery
from clearance.world.forest import forest_of, positions_between

N_MOMENTS = 9
"""Moments at which the depth of a stretch of contact with fewer steps is computed, and as many again near the
deepest; each takes milliseconds."""

MOST_STRETCHES = 3
"""Most stretches to examine, longest first: the verdict waits for them."""


def deepest_between(rules: Sequence[MeasuredRule]) -> Moment | None:
    """The first of the deepest moments found between the steps; None if no stretch has few steps."""
    spans = sorted(_spans(rules), key=lambda one: one[1] - one[2])[:MOST_STRETCHES]
    return _deepest([_deepest_in(*span) for span in spans])


def _deepest(found: Sequence[Moment | None]) -> Moment | None:
    """The first of the deepest of some moments."""
    known = [one for one in found if one is not None]
    return max(known, key=lambda one: one.depth.penetration if one.depth else 0.0, default=None)


def _deepest_in(rule: MeasuredRule, start: float, end: float) -> Moment | None:
    """The deepest moment of a stretch: of evenly spread moments, then of as many near the deepest."""
    best = _deepest([*_moments(rule, start, end)])
    if best is None:
        return None
    spacing = (end - start) / (N_MOMENTS + 1)
    about = max(start, best.time - spacing), min(end, best.time + spacing)
    return _deepest([best, *_moments(rule, *about)])


def _spans(rules: Sequence[MeasuredRule]) -> Iterator[tuple[MeasuredRule, float, float]]:
    """Start and end [s] of each pair's stretches of contact that have few steps."""
    for rule in rules:
        within = rule.limits.warn
        if rule.certificate is None or not can_be_alone(rule, within):
            continue
        for answer in near_alone(rule, within).values():
            if answer.worst is None or not answer.worst.touches or answer.pairs is None:
                continue
            times = np.concatenate(
                [one.section.phase.motions[0].times for one in answer.pairs.answers]
            )
            for start, end in RuleStretches(answer, "contact").spans.tolist():
                if ((times >= start) & (times <= end)).sum() < N_MOMENTS:
                    yield answer, start, end


def _moments(rule: MeasuredRule, start: float, end: float) -> Iterator[Moment]:
    """The moments of a stretch at which the one pair of a rule overlaps, with their depth."""
    assert rule.pairs is not None
    for answer in rule.pairs.answers:
        phase, (pair,) = answer.section.phase, answer.section.pairs
        case, times = phase.case, phase.motions[0].times
        if pair.has_cloud(case):
            continue
        for time in np.linspace(start, end, N_MOMENTS + 2)[1:-1].tolist():
            step = int(np.searchsorted(times, time, side="right")) - 1
            if not 0 <= step < len(times) - 1:
                continue
            share = float((time - times[step]) / (times[step + 1] - times[step]))
            poses = forest_of(case).poses(positions_between(case, phase.motions, step, share)[None])
            shapes, placed = zip(
                *((body.shape_in(case), body.poses_in(case, poses)[0]) for body in pair),
                strict=True,
            )
            try:
                found = contact(*shapes, pose_a=placed[0], pose_b=placed[1], rough=True)
            except ClearanceError:  # a body without any extent
                return
            if found is not None:
                query = MomentQuery(case, phase.motions, answer.section.pairs)
                moment = query.between(step, share, 0, touches=True)
                exact = bool(found.exact[0])
                depth = Depth(found.penetration, found.penetration_at_least, exact)
                reported = moment.of_run(phase.first, answer.section.padding, rule.name)
                yield replace(reported, depth=depth)

"""The worst moments of a run: in contact the deepest, as far as depth is known, between the steps too."""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Sequence
from dataclasses import dataclass, replace

import numpy as np

from clearance.errors import ClearanceError
from clearance.record.contact import ContactRows, StepContact
from clearance.record.moment import Depth, Moment
from clearance.record.rule_answer import standing_worst, worst_of
from clearance.simulate.answers.pairs_alone import can_be_alone, near_alone
from clearance.simulate.answers.rule_pairs import MeasuredRule
from clearance.simulate.answers.stretches import RuleStretches
from clearance.simulate.measure.moment_query import MomentQuery
from clearance.world.forest import forest_of, positions_between


@dataclass(frozen=True, eq=False)
class WorstMoments:
    """The most critical moments of a run.

    Attributes:
        contacts: those of the run. between: whether depth is computed between the steps too.
    """

    contacts: ContactRows | tuple[()]
    between: bool

    def at_steps(self, rules: Sequence[MeasuredRule]) -> Moment | None:
        """The most critical step; without rules, the first of least clearance; None where none is known."""
        worst = standing_worst((rule, rule.worst_sample) for rule in rules)
        return None if worst is None else self._deepest_of(rules, worst)

    def of_motion(self, rules: Sequence[MeasuredRule], sample: Moment) -> Moment:
        """The most critical moment of the motion; `sample` is `at_steps`."""
        worst = worst_of(rules)
        assert worst is not None
        known = sample if worst.touches and sample.depth else worst
        return self._deeper_between(rules, known)

    def among(self, rules: Sequence[MeasuredRule]) -> Moment | None:
        """The most critical moment, as if there were no other rules than some, or than some of their pairs."""
        worst = worst_of(rules)
        if worst is None:
            return None
        return self._deeper_between(rules, self._deepest_of(rules, worst))

    def _deepest_of(self, rules: Sequence[MeasuredRule], worst: Moment) -> Moment:
        """The deepest of the moments in contact in place of one of them, where depth is known."""
        if not (
            worst.touches and isinstance(self.contacts, ContactRows) and self.contacts.are_asked
        ):
            return worst
        return _deepest_step(self.contacts.worked_out, rules) or worst

    def _deeper_between(self, rules: Sequence[MeasuredRule], known: Moment) -> Moment:
        """The deepest moment between two steps in place of one in contact, if it is deeper and depth is asked."""
        if not known.touches or not self.between:
            return known
        found = deepest_between(rules)
        if found is None or found.depth is None:
            return known
        deeper = known.depth is None or found.depth.penetration > known.depth.penetration
        return found if deeper else known


def _deepest_step(rows: Iterable[StepContact], rules: Sequence[MeasuredRule]) -> Moment | None:
    """The first moment of the deepest overlap that one of the rules judges; None where none judges any."""
    for row in sorted(rows, key=lambda row: -row.penetration):
        for rule in rules:
            moment = _touching(rule, row)
            if moment is not None and row.known is not None:
                found = row.known
                depth = Depth(found.penetration, found.penetration_at_least, bool(found.exact[0]))
                return replace(moment, depth=depth)
    return None


def _touching(rule: MeasuredRule, row: StepContact) -> Moment | None:
    """The moment of an overlap, if the rule judges its pair and finds it in contact there."""
    pair = None if rule.pairs is None else rule.pairs.place_of(row.step, (row.link, row.obstacle))
    if pair is None or rule.pairs is None:
        return None
    nearest = rule.measurement.pair[row.step] == pair
    moment = rule.moment_at(row.step) if nearest else rule.pairs.moment(row.step, pair)
    return moment if moment.touches else None


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
    from clearance.query.contact import contact

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

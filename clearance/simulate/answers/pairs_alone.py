"""Proves the pairs of a certified rule one by one: which come near between the steps, and how near.

The proof of a rule covers all its pairs but names only the nearest in each interval. Here each other pair is
proven on its own. Not for: the clearance of pairs at the steps (`rule_pairs`).
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace
from functools import cached_property

import numpy as np

from clearance.kernels.motion.certify import CertifiedSteps, IntervalBounds
from clearance.kernels.motion.joint_path import JointPath
from clearance.kernels.motion.twist import CertificateGoal
from clearance.record.moment import Moment
from clearance.record.rule_answer import NearRows
from clearance.simulate.answers.rule_pairs import MeasuredRule, RulePairs, measured_rule
from clearance.simulate.answers.run_answer import joined, joined_certificates
from clearance.simulate.answers.stretches import runs_of
from clearance.simulate.measure.certify import (
    BEYOND,
    MOST_PARTS,
    certify_motion,
    path_of,
    prove_path,
)
from clearance.simulate.measure.measured import MeasuredSteps
from clearance.simulate.measure.moment_query import MomentQuery
from clearance.simulate.measure.sections import SectionAnswer

FAR_GAP = 0.01
"""[-] Largest gap of the bound of a pair that is not near: a hundredth of its clearance is enough for a table."""


def can_be_alone(rule: MeasuredRule, within: float) -> bool:
    """True if the pairs of a rule that come within [m] can be proven one by one."""
    if rule.certificate is None or rule.pairs is None or rule.pairs.is_cut(within):
        return False
    return all(answer.section.tied for answer in rule.pairs.answers)


def near_alone(rule: MeasuredRule, within: float) -> dict[int, MeasuredRule]:
    """The answer of a rule for each pair that comes within [m], at a step or between; pairs of the run."""
    within = max(within, rule.limits.rounding)  # bodies in contact are near, whatever the limit
    if within not in rule.alone:
        assert rule.pairs is not None, "the sections of a rule are known"
        rows = [rows for _, rows in rule.pairs.near_by_section(within)]
        found = {pair for own in rows for pair in own.pairs.tolist()}
        for answer in rule.pairs.answers:
            found |= near_between(answer, within, found)
        rule.alone[within] = {pair: _of_pair(rule, pair, within, rows) for pair in sorted(found)}
    return rule.alone[within]


def _of_pair(
    rule: MeasuredRule, pair: int, within: float, rows: Sequence[NearRows]
) -> MeasuredRule:
    """The answer of a rule for one pair; `rows`: its clearances at steps where it is near, by section."""
    assert rule.pairs is not None
    own = [
        _alone(answer, near, pair, within)
        for answer, near in zip(rule.pairs.answers, rows, strict=True)
        if pair in answer.section.places
    ]
    n_steps, pairs = len(rule.measurement.clearance), RulePairs(own, rule.name)

    def moment_at(step: int) -> Moment:
        return pairs.moment(step, pair)

    found = joined(own, n_steps, pair + 1)
    certificate = joined_certificates(own, n_steps, rule.name)
    return measured_rule(rule.name, rule.limits, found, certificate, moment_at, pairs)


def near_between(answer: SectionAnswer, within: float, known: set[int]) -> set[int]:
    """The pairs of the run that are known, and those that come within [m] between two steps of a section."""
    certificate, section = answer.certificate, answer.section
    assert certificate is not None, "the run is certified"
    reach = within + section.padding
    seen = certificate.pair[(certificate.pair >= 0) & (certificate.upper_bound < reach)]
    known = known | set(section.places[seen].tolist())
    spans = [slice(a, b + 1) for a, b in runs_of(certificate.lower_bound[:-1] < reach).tolist()]
    while True:
        rest = np.array([i for i, place in enumerate(section.places) if place not in known])
        new = {int(section.places[i]) for span in spans for i in _nearer(answer, rest, span, reach)}
        if not new:
            return known
        known |= new


def _nearer(answer: SectionAnswer, pairs: np.ndarray, steps: slice, reach: float) -> set[int]:
    """Those of some pairs of a section that are measured within reach [m] between some steps."""
    if not len(pairs):
        return set()
    assert answer.certificate is not None
    bounds = _Path(answer, steps).proven(pairs, reach + BEYOND * answer.certificate.gap)
    near = (bounds.pair >= 0) & (bounds.upper < reach)
    return set(pairs[bounds.pair[near]].tolist())


def least_between(
    rule: MeasuredRule, pairs: dict[int, float]
) -> dict[int, tuple[float, Moment | None]]:
    """For each of some pairs with a clearance [m]: its proven bound up to that [m], and a moment between two steps
    with a lower clearance, or None."""
    found: dict[int, tuple[float, Moment | None]] = {}
    assert rule.pairs is not None, "the sections of a rule are known"
    for answer in rule.pairs.answers:
        path = _Path(answer, slice(0, answer.section.phase.n_steps))
        for place, pair in enumerate(answer.section.places.tolist()):
            if pair not in pairs:
                continue
            proven, moment = path.least(place, pairs[pair], rule.name)
            before, known = found.get(pair, (np.inf, None))
            if known is not None and (moment is None or known.clearance <= moment.clearance):
                moment = known
            found[pair] = min(proven, before), moment
    return found


@dataclass(frozen=True, eq=False)
class _Path:
    """The motion of a section between some of its steps."""

    answer: SectionAnswer
    steps: slice

    @cached_property
    def path(self) -> JointPath:
        what = self.answer.section.in_motion
        return path_of(what.layout.world.links, what.case, what.motions, self.steps)

    def proven(self, pairs: np.ndarray, asked: float, gap: float = 0.0) -> IntervalBounds:
        """Proven bounds of some pairs of the section up to a distance [m]; `pair` counts these pairs."""
        layout, certificate = self.answer.section.in_motion.layout, self.answer.certificate
        assert certificate is not None, "the run is certified"
        n, own = len(self.path.times), layout.world.pairs[pairs]
        order = np.zeros(n - 1, dtype=np.int64)
        others = np.ones(len(layout.world.frames), dtype=bool)
        others[own] = False  # nobody asks how far they move
        frames = np.where(others, -1, layout.world.frames)
        world = layout.world._replace(pairs=np.ascontiguousarray(own), frames=frames)
        aim = CertificateGoal(max(gap, certificate.gap), 0.0, MOST_PARTS)
        steps = CertifiedSteps(0, n - 1, order, np.full(n, asked))
        return prove_path(layout.whole_faces, world, self.path, steps, aim)[0]

    def least(self, place: int, clearance: float, rule: str) -> tuple[float, Moment | None]:
        """For a pair of the section: its proven bound [m] up to a clearance [m], and the moment of a lower one."""
        section = self.answer.section
        nearest, distance, seen = clearance + section.padding, np.inf, None
        while nearest < 0.5 * distance:  # the gap was of a clearance far above the least
            distance = nearest
            bounds = self.proven(np.array([place]), distance, FAR_GAP * distance)
            if not len(bounds.lower):
                return clearance, None
            step = int(np.argmin(np.where(bounds.pair >= 0, bounds.upper, np.inf)))
            if bounds.pair[step] >= 0:
                nearest, seen = float(bounds.upper[step]), (step, float(bounds.share[step]))
        proven = float(bounds.lower.min()) - section.padding
        if seen is None:
            return proven, None
        step, share = seen
        moments = MomentQuery(section.phase.case, section.phase.motions, section.pairs)
        found = moments.between(step, share, place)
        return proven, found.of_run(section.phase.first, section.padding, rule)


def _alone(answer: SectionAnswer, rows: NearRows, pair: int, within: float) -> SectionAnswer:
    """A section with one pair alone, whose clearances are known where they are within [m]."""
    section = answer.section
    place = int(np.flatnonzero(section.places == pair)[0])
    alone = replace(section, pairs=(section.pairs[place],), places=np.array([pair]))
    n, reach = section.phase.n_steps, within + section.padding
    clearance, own = np.full(n, np.nan), rows.pairs == pair
    clearance[rows.steps[own] - section.phase.first] = rows.clearances[own] + section.padding
    known = clearance < reach
    found = _measured(np.where(known, clearance, np.nan), np.where(known, clearance, reach))
    whole = answer.certificate
    assert whole is not None, "the run is certified"
    asked = np.where(known, clearance, reach + BEYOND * whole.gap)
    own = certify_motion(alone.in_motion, _measured(asked, asked), whole.gap)
    own.lower_bound[-1] = min(own.lower_bound[-1], found.lower_bound[-1])
    np.maximum(own.lower_bound, whole.lower_bound, out=own.lower_bound)
    seen = np.flatnonzero(whole.pair == place)  # reported as the rule reports it
    own.upper_bound[seen], own.share[seen] = whole.upper_bound[seen], whole.share[seen]
    own.pair[seen] = 0
    nearest = np.append(answer.found.pair, -1)
    at_ends = (nearest[:-2] == place) | (nearest[1:-1] == place)
    own.pair[:-1][at_ends & (whole.pair[:-1] < 0) & known[:-1] & known[1:]] = -1
    return SectionAnswer(alone, found, own)


def _measured(clearance: np.ndarray, lower_bound: np.ndarray) -> MeasuredSteps:
    """A measurement of one pair, without witness points."""
    n = len(clearance)
    points = np.broadcast_to(np.nan, (n, 2, 3))
    pair = np.where(np.isnan(clearance), -1, 0)
    return MeasuredSteps(clearance, lower_bound, pair, points, {}, measure_pair_minima=None)

"""Stretches of time below a level: every moment outside a stretch is proven to be above the level.

Intervals that are not proven as a whole are proven in parts of a millisecond, or of a hundredth of the interval if
that is more. Parts that are not proven belong to the stretch. Not for: whether a level is proven (`certificate`).
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from functools import cached_property
from typing import NamedTuple

import numpy as np

from clearance.kernels.motion.certify import CertifiedSteps, IntervalBounds
from clearance.kernels.motion.twist import CertificateGoal
from clearance.kernels.search.proof import FINEST_GAP
from clearance.record.certificate import Certificate
from clearance.record.moment import Moment
from clearance.record.rows.blocks import blocks
from clearance.simulate.answers.rule_pairs import MeasuredRule
from clearance.simulate.measure.certify import finer_path, prove_path
from clearance.simulate.measure.measure import nearest_at
from clearance.simulate.measure.moment_query import MomentQuery
from clearance.simulate.measure.sections import Section, SectionAnswer
from clearance.tolerance import SEEN_AT_LEVEL
from clearance.world.forest import positions_along
from clearance.world.motion import place_in

FINEST_TIME, FINEST_SHARE = 1e-3, 0.01
"""[s] and [-] The length of a part of an interval: the greater of both."""

PART_GAP = 1e-3
"""[m] Largest gap between the bound of a part and a clearance in it; a thousandth of that at the level."""

MOST_PARTS = 2**6
"""Parts of a part and pair until its gap is widened."""

MOST_SPLIT = 2000
"""Most intervals of a section that are proven in parts as a level is passed in them; others count as a whole."""

MOST_VISITS = 700
"""Most parts in all intervals of a section with both ends below the level: between them it may be exceeded.
These are seven long intervals, or 35 of 20 ms; with more, samples are dense enough."""


class Threshold(NamedTuple):
    """[m] The distance that is above a level; where `strict`, only more is."""

    distance: float
    strict: bool

    def above(self, distances: np.ndarray) -> np.ndarray:
        """True where distances are above the level."""
        return distances > self.distance if self.strict else distances >= self.distance


class Parts(NamedTuple):
    """Parts of the motion that are not proven to be above a level, and steps below it.

    Attributes:
        start, end: (k,) [s], the same for a step.
        least: (k,) [m] a clearance that occurs there, infinite where none is known.
        answer, step, share, pair: (k,) which section's that is, its own step and pair, and the share of the
            interval that has passed.
    """

    start: np.ndarray
    end: np.ndarray
    least: np.ndarray
    answer: np.ndarray
    step: np.ndarray
    share: np.ndarray
    pair: np.ndarray

    def only(self, rows: np.ndarray) -> Parts:
        """Some of them."""
        return Parts(*(column[rows] for column in self))


@dataclass(frozen=True, eq=False)
class RuleStretches:
    """The times at which pairs of a certified rule are below one of `LEVELS`, or below a clearance [m]."""

    rule: MeasuredRule
    level: str | float

    @cached_property
    def parts(self) -> Parts:
        """All parts and steps, in order of time."""
        assert self.rule.pairs is not None, "the sections of a rule are known"
        found = [_parts_of(i, one, self.level) for i, one in enumerate(self.rule.pairs.answers)]
        joined = Parts(*(np.concatenate(column) for column in zip(*found, strict=True)))
        return joined.only(np.argsort(joined.start, kind="stable"))

    @cached_property
    def spans(self) -> np.ndarray:
        """(k, 2) [s] start and end of each stretch; no stretch of contact without measured contact."""
        if self._is_contact and not self._is_seen:
            return np.empty((0, 2))
        spans = joined_spans(np.column_stack([self.parts.start, self.parts.end]))
        if not self._is_contact:
            return spans
        known = np.isfinite(self.parts.least)
        return np.array([one for one in spans if known[self._within(*one)].any()]).reshape(-1, 2)

    @property
    def _is_contact(self) -> bool:
        """True where the level is contact, of the bodies or of their paddings."""
        assert self.rule.pairs is not None, "the sections of a rule are known"
        return all(threshold_of(one.section, self.level).strict for one in self.rule.pairs.answers)

    @property
    def _is_seen(self) -> bool:
        """True if such contact occurs."""
        worst = self.rule.worst
        if worst is None:
            return False
        return worst.touches or (self.level != "contact" and worst.clearance <= 0.0)

    def worst(self, start: float, end: float) -> Moment | None:
        """The moment of the least clearance that was seen from `start` to `end` [s]."""
        own = self.parts.only(self._within(start, end))
        known = np.flatnonzero(np.isfinite(own.least))
        return self._moment(own, int(known[np.argmin(own.least[known])])) if len(known) else None

    def at(self, time: float, start: float, end: float) -> Moment | None:
        """The pair measured nearest to a time [s] within a stretch, at that time."""
        own = self.parts.only(self._within(start, end))
        known = np.flatnonzero(np.isfinite(own.least))
        if not len(known):
            return None
        away = np.maximum(own.start[known] - time, time - own.end[known])
        return self._moment(own, int(known[np.argmin(away)]), time)

    def _within(self, start: float, end: float) -> np.ndarray:
        return np.flatnonzero((self.parts.start >= start) & (self.parts.end <= end))

    def _moment(self, parts: Parts, row: int, time: float | None = None) -> Moment:
        """The known moment of a part, or its pair at another time [s]."""
        assert self.rule.pairs is not None
        answer = self.rule.pairs.answers[int(parts.answer[row])]
        section, step = answer.section, int(parts.step[row])
        phase = section.phase
        share = float(parts.share[row])
        if not section.tied:
            assert answer.certificate is not None
            found = answer.certificate.moment_of(step)
        else:
            if time is not None:
                step, share = place_in(phase.motions[0].times, time)
            moments = MomentQuery(phase.case, phase.motions, section.pairs)
            pair = int(parts.pair[row])
            found = moments.between(step, max(share, 0.0), pair)
        return found.of_run(phase.first, section.padding, self.rule.name)


def joined_spans(spans: np.ndarray) -> np.ndarray:
    """(k, 2) the unions of spans (n, 2) that overlap or meet, in order of time."""
    if not len(spans):
        return np.empty((0, 2))
    spans = spans[np.argsort(spans[:, 0], kind="stable")]
    reached = np.maximum.accumulate(spans[:, 1])
    first = np.flatnonzero(np.append(True, spans[1:, 0] > reached[:-1]))
    return np.column_stack([spans[first, 0], np.append(reached[first[1:] - 1], reached[-1])])


def runs_of(marked: np.ndarray) -> np.ndarray:
    """(k, 2) first and, after the last, of each run of True."""
    change = np.flatnonzero(np.diff(np.concatenate([[False], marked, [False]]).astype(np.int8)))
    return change.reshape(-1, 2)


def _places(n: int, test: Callable[[slice], np.ndarray]) -> np.ndarray:
    """(k,) where a test is true among n rows, asked a block at a time to save memory."""
    found = [block.start + np.flatnonzero(test(block)) for block in blocks(n)]
    return np.concatenate([np.empty(0, dtype=np.int64), *found])


def threshold_of(section: Section, level: str | float) -> Threshold:
    """The threshold for distances of a section without padding."""
    if level == "contact":
        return Threshold(0.0, strict=True)
    limits = section.limits
    named = {"below_fail": limits.fail, "below_warn": limits.warn}
    distance = named[level] if isinstance(level, str) else level + section.padding
    least = distance - limits.rounding
    return Threshold(section.padding, True) if least <= section.padding else Threshold(least, False)


def _parts_of(i_answer: int, answer: SectionAnswer, level: str | float) -> Parts:
    """The parts of a section."""
    assert answer.certificate is not None, "the run is certified"
    own = _Intervals(answer, answer.certificate, threshold_of(answer.section, level))
    opened = own.opened
    inner = own.inside(opened) & own.inside(opened + 1)
    parted = (own.most_parts(opened) > 1) & answer.section.tied
    if own.most_parts(opened[inner]).sum() > MOST_VISITS:
        parted &= ~inner
    split = opened[parted][:MOST_SPLIT]
    whole = np.setdiff1d(opened, split, assume_unique=True)
    found = [own.steps(_places(len(own.times), own.below)), own.whole(whole)]
    found += [own.parts(int(i), int(n)) for i, n in zip(split, own.most_parts(split), strict=True)]
    joined = Parts(*(np.concatenate(column) for column in zip(*found, strict=True)))
    return joined._replace(
        least=joined.least - answer.section.padding,
        answer=np.full(len(joined.start), i_answer),
    )


@dataclass(frozen=True, eq=False)
class _Intervals:
    """The intervals of a section; their distances are without padding."""

    answer: SectionAnswer
    certificate: Certificate
    threshold: Threshold

    @property
    def times(self) -> np.ndarray:
        """(n,) [s] of its steps."""
        return self.answer.section.phase.motions[0].times

    @property
    def opened(self) -> np.ndarray:
        """(k,) the intervals that are not proven to be above the level."""
        lower = self.certificate.lower_bound[:-1]
        return _places(len(lower), lambda block: ~self.threshold.above(lower[block]))

    def below(self, steps: np.ndarray | slice) -> np.ndarray:
        """(k,) True for steps that are known to be below the level."""
        clearance = self.answer.found.clearance[steps]
        return ~(np.isnan(clearance) | self.threshold.above(clearance))

    def inside(self, steps: np.ndarray) -> np.ndarray:
        """(k,) True for steps that are below the level, or touch but for rounding where that is contact."""
        rounding = SEEN_AT_LEVEL * self.answer.section.limits.rounding
        clearance = self.answer.found.clearance[steps]
        touching = self.threshold.strict & (clearance - self.threshold.distance <= rounding)
        return self.below(steps) | touching

    def most_parts(self, steps: np.ndarray) -> np.ndarray:
        """(k,) how many parts of the intervals after some steps are as long as they should be."""
        length = self.times[steps + 1] - self.times[steps]
        part = np.maximum(FINEST_TIME, FINEST_SHARE * length)
        return np.maximum(1, np.ceil(length / part * (1.0 - 1e-9))).astype(np.int64)

    def steps(self, steps: np.ndarray) -> Parts:
        """Steps that are below the level."""
        times, pairs = self.times[steps], self.answer.found.pair[steps]
        none = np.zeros(len(steps))
        return Parts(times, times, self.answer.found.clearance[steps], pairs, steps, none, pairs)

    def whole(self, steps: np.ndarray) -> Parts:
        """Whole intervals, with the least that the certificate saw in them."""
        own, pairs = self.certificate, self.certificate.pair[steps]
        least = np.where(pairs >= 0, own.upper_bound[steps], np.inf)
        ends = self.times[steps], self.times[steps + 1]
        return Parts(*ends, least, pairs, steps, own.share[steps], pairs)

    def parts(self, step: int, n_parts: int) -> Parts:
        """The parts of an interval that are not proven to be above the level."""
        bounds = self._proven(step, n_parts)
        rows = np.flatnonzero(~self._is_outside(step, self.threshold.above(bounds.lower)))
        edges = self.times[step] + np.arange(n_parts + 1) / n_parts * np.diff(self.times)[step]
        edges[-1] = self.times[step + 1]
        least = np.where(bounds.pair >= 0, bounds.upper, np.inf)
        share, pair = (np.arange(n_parts) + bounds.share) / n_parts, bounds.pair
        seen = self.whole(np.array([step]))  # to within the gap, which parts are not
        place = min(int(seen.share[0] * n_parts), n_parts - 1)
        if seen.least[0] < least[place]:
            least[place], share[place], pair[place] = seen.least[0], seen.share[0], seen.pair[0]
        steps = np.full(len(rows), step)
        return Parts(
            edges[rows], edges[rows + 1], least[rows], steps, steps, share[rows], pair[rows]
        )

    def _is_outside(self, step: int, proven: np.ndarray) -> np.ndarray:
        """(k,) True for parts above the level: those that are proven, unless a body is within another.

        A proof is of surfaces, and of bodies that begin or end disjoint. So parts that are proven one after
        another need no visit if they join a step that is above the level; of others one moment is measured.
        """
        n, ends = len(proven), ~self.below(slice(step, step + 2))
        outside = proven.copy()
        for first, stop in runs_of(proven).tolist():
            if (first == 0 and ends[0]) or (stop == n and ends[1]):
                continue
            phase, what = self.answer.section.phase, self.answer.section.in_motion
            middle = np.array([0.5 * (first + stop) / n])
            there = nearest_at(what, positions_along(phase.case, phase.motions, step, middle))
            outside[first:stop] = self.threshold.above(there.clearance)[0]
        return outside

    def _proven(self, step: int, n_parts: int) -> IntervalBounds:
        what = self.answer.section.in_motion
        path = finer_path(what, step, n_parts)
        level = self.threshold.distance
        asked = np.full(n_parts + 1, level + 2.0 * FINEST_GAP * PART_GAP)
        first = max(self.certificate.pair[step], self.answer.found.pair[step], 0)
        order = np.full(n_parts, first)
        aim = CertificateGoal(PART_GAP, level, MOST_PARTS)
        steps = CertifiedSteps(0, n_parts, order, asked)
        return prove_path(what.layout.whole_faces, what.layout.world, path, steps, aim)[0]

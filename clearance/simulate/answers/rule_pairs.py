"""The pairs that one rule judges, one by one: which are near at which steps, and the moment of any.

A run has the nearest pair of each step; what else is near then is measured when it is first asked for.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass, field, replace
from functools import cached_property

import numpy as np

from clearance.record.measurement import Measurement
from clearance.record.moment import Moment
from clearance.record.names import pair_names
from clearance.record.rule_answer import MOST_NEAR_STEPS, NearRows, RuleAnswer
from clearance.simulate.measure.measure import NearestPairs, pairs_within
from clearance.simulate.measure.measured import MeasuredSteps, ProvenMotion
from clearance.simulate.measure.moment_query import MomentQuery
from clearance.simulate.measure.sections import Section, SectionAnswer
from clearance.world.case import Limits
from clearance.world.motion import Motion


@dataclass(frozen=True, eq=False)
class SampleMoments:
    """The moments of steps; names of the bodies of each pair, and the robots' motions."""

    names: tuple[list[str], list[str]]
    motions: Sequence[Motion]

    def at(self, found: Measurement, rule: str, step: int) -> Moment:
        """The moment of a step whose clearance is known."""
        pair, points = int(found.pair[step]), found.points[step].tolist()
        time_b = None if found.times_b is None else float(found.times_b[step])
        return Moment(
            step=step,
            time=float(self.motions[0].times[step]),
            between=False,
            clearance=float(found.clearance[step]),
            link=self.names[0][pair],
            obstacle=self.names[1][pair],
            point_link=tuple(points[0]),
            point_obstacle=tuple(points[1]),
            positions=tuple(motion.positions[step] for motion in self.motions),
            rule=rule,
            touches=bool(found.touches(slice(step, step + 1))[0]),
            time_b=None if time_b is None or np.isnan(time_b) else time_b,
        )


@dataclass(frozen=True, eq=False)
class RulePairs:
    """What the sections of one rule have found, pair by pair."""

    answers: Sequence[SectionAnswer]
    rule: str

    @property
    def names(self) -> Iterator[tuple[str, str]]:
        """The two bodies of each pair, once a section."""
        for answer in self.answers:
            yield from zip(
                *pair_names(answer.section.phase.case, answer.section.pairs), strict=True
            )

    def near(self, within: float) -> NearRows:
        """All pairs nearer than `within` [m] at each step."""
        parts = [_near(answer, within) for answer in self.answers]
        if len(parts) == 1 and _is_sorted(parts[0]):
            return NearRows(*parts[0])
        columns = [np.concatenate(column) for column in zip(*parts, strict=True)]
        order = np.lexsort((columns[1], columns[0]))
        return NearRows(*(column[order] for column in columns))

    def near_by_section(self, within: float) -> Iterator[tuple[Section, NearRows]]:
        """The same, section by section: its pairs are as it is."""
        for answer in self.answers:
            yield answer.section, NearRows(*_near(answer, within))

    def is_cut(self, within: float) -> bool:
        """True if `near` knows only the nearest pair of some steps, since there are too many."""
        return any(len(_near_steps(one, within)) > MOST_NEAR_STEPS for one in self.answers)

    def place_of(self, step: int, names: tuple[str, str]) -> int | None:
        """The place of a pair among those of the run, if the rule judges it at a step; else None."""
        for answer in self.answers:
            section = answer.section
            if section.steps.start <= step < section.steps.stop:
                own = list(zip(*pair_names(section.phase.case, section.pairs), strict=True))
                if names in own:
                    return int(section.places[own.index(names)])
        return None

    def moment(self, step: int, pair: int) -> Moment:
        """The moment of a step at which a pair is measured: of those of several sections the nearest."""
        found = [moment for answer in self.answers for moment in _moments(answer, step, pair)]
        nearest = min(found, key=lambda moment: moment.clearance)
        return replace(nearest, rule=self.rule)


_Columns = tuple[np.ndarray, np.ndarray, np.ndarray, np.ndarray, np.ndarray]


def _is_sorted(columns: _Columns) -> bool:
    """True if rows are by steps, and those of one step by pairs."""
    steps, pairs, *_ = columns
    later = steps[1:] > steps[:-1]
    return bool((later | ((steps[1:] == steps[:-1]) & (pairs[1:] > pairs[:-1]))).all())


def _near(answer: SectionAnswer, within: float) -> _Columns:
    """The columns of `NearRows` of one section."""
    section, found = answer.section, answer.found
    steps = _near_steps(answer, within)
    if not section.tied or found.may_cut_pairs or len(steps) > MOST_NEAR_STEPS:
        return _nearest(answer, steps)
    reached = within + section.padding
    if found.every is not None:
        rows, pairs = np.nonzero(found.every[steps] < reached)
        distances = found.every[steps[rows], pairs]
    elif len(steps):
        nearest = NearestPairs(found.pair[steps], found.clearance[steps])
        rows, pairs, distances = pairs_within(section.in_motion, steps, reached, nearest)
        near = distances < reached
        rows, pairs, distances = rows[near], pairs[near], distances[near]
    else:
        rows, pairs, distances = steps, steps, np.empty(0)
    return (
        steps[rows] + section.phase.first,
        section.places[pairs],
        distances - section.padding,
        distances <= 0.0,
        np.zeros(len(rows), dtype=bool),
    )


def _near_steps(answer: SectionAnswer, within: float) -> np.ndarray:
    """The steps at which a pair of a section can be nearer than `within` [m]."""
    found = answer.found
    floor = np.where(np.isnan(found.clearance), found.lower_bound, found.clearance)
    return np.flatnonzero(floor - answer.section.padding < within)


def _nearest(answer: SectionAnswer, steps: np.ndarray) -> _Columns:
    section, found = answer.section, answer.found
    steps = steps[found.pair[steps] >= 0]
    distances = found.clearance[steps]
    return (
        steps + section.phase.first,
        section.places[found.pair[steps]],
        distances - section.padding,
        distances <= 0.0,
        np.ones(len(steps), dtype=bool),
    )


def _moments(answer: SectionAnswer, step: int, pair: int) -> Iterator[Moment]:
    """The moment of a pair at a step of the run, if a section has both."""
    section = answer.section
    own = np.flatnonzero(section.places == pair)
    if not (len(own) and section.steps.start <= step < section.steps.stop):
        return
    found = _moment(answer, step - section.phase.first, int(own[0]))
    yield replace(found, step=step, clearance=found.clearance - section.padding)


def _moment(answer: SectionAnswer, step: int, pair: int) -> Moment:
    section = answer.section
    case, motions = section.phase.case, section.phase.motions
    if section.tied:
        return MomentQuery(case, motions, section.pairs).between(step, 0.0, pair)
    names = pair_names(case, section.pairs)
    return SampleMoments(names, motions).at(answer.found, "", step)


@dataclass(frozen=True, eq=False)
class MeasuredRule(RuleAnswer):
    """What a rule comes to, and what measures its moments and its pairs one by one.

    Attributes:
        moment_at: the moment of a step whose clearance is known.
        pairs: its pairs one by one; None where only the nearest of each step is known.
        alone: by a level [m], the pairs that come within it, each proven alone, as far as that was asked for.
    """

    measurement: MeasuredSteps
    certificate: ProvenMotion | None = None
    moment_at: Callable[[int], Moment] = field(kw_only=True)
    pairs: RulePairs | None = field(default=None, kw_only=True)
    alone: dict[float, dict[int, MeasuredRule]] = field(default_factory=dict, kw_only=True)

    @cached_property
    def answer(self) -> RuleAnswer:
        """The data of it alone."""
        certificate = None if self.certificate is None else self.certificate.data
        return RuleAnswer(
            self.name,
            self.limits,
            self.measurement.data,
            certificate,
            self.worst_sample,
            self.worst,
            self.sections,
        )


def measured_rule(
    name: str,
    limits: Limits,
    found: MeasuredSteps,
    proven: ProvenMotion | None,
    moment_at: Callable[[int], Moment],
    pairs: RulePairs | None = None,
) -> MeasuredRule:
    """A rule with its worst moments."""
    sample = _worst_sample(found, moment_at)
    return MeasuredRule(
        name,
        limits,
        found,
        proven,
        sample,
        _lesser(sample, None if proven is None else proven.nearest_moment),
        () if pairs is None else tuple(one.section.pairs for one in pairs.answers),
        moment_at=moment_at,
        pairs=pairs,
    )


def _worst_sample(found: MeasuredSteps, moment_at: Callable[[int], Moment]) -> Moment | None:
    """The first step of least clearance; None where none is known."""
    unknown = np.isnan(found.clearance)
    if unknown.all():
        return None
    touching = found.touches(slice(None))
    if found.touching is not None and touching.any():
        return moment_at(int(np.argmax(touching)))
    return moment_at(int(np.argmin(np.where(unknown, np.inf, found.clearance))))


def _lesser(known: Moment | None, between: Moment | None) -> Moment | None:
    """The one of less clearance; contact of the bodies themselves is least."""
    if known is None or between is None:
        return between if known is None else known
    if known.touches:
        return known
    return between if between.touches or between.clearance < known.clearance else known

"""The pairs that one rule judges, one by one: which are near at which steps, and the moment of any.

A run has the nearest pair of each step; what else is near then is measured when it is first asked for. Not for:
how the rule stands as a whole (`rule_answer`).
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import dataclass, replace

import numpy as np

from clearance.simulate.measure import NearestPairs, pairs_within
from clearance.simulate.moment import Moment, MomentQuery
from clearance.simulate.names import pair_names
from clearance.simulate.sample_moments import SampleMoments
from clearance.simulate.section_answer import SectionAnswer
from clearance.simulate.sections import Section

MOST_NEAR_STEPS = 250_000
"""Of a section; where something is near at more, only the nearest pair of each is told, to save memory."""


@dataclass(frozen=True, eq=False)
class NearRows:
    """Pairs near at steps, one row a pair and step, steps in order.

    Attributes:
        steps, pairs: (k,) pairs are places among those of the run. clearances: (k,) [m] less padding.
        touching: (k,) where the bodies themselves touch.
        nearest_only: (k,) True where only the nearest pair of the step is known: others may be near as well.
    """

    steps: np.ndarray
    pairs: np.ndarray
    clearances: np.ndarray
    touching: np.ndarray
    nearest_only: np.ndarray


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
        return MomentQuery(case, motions, section.pairs).at(step, pair)
    names = pair_names(case, section.pairs)
    return SampleMoments(names, motions).at(answer.found, "", step)

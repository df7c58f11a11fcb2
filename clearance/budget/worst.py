"""The moments at which a budget leaves least, and the loss by each error there."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import dataclass, replace
from functools import cached_property

import numpy as np

from clearance.budget.errors_of import NOW
from clearance.budget.expected import clock_rates, deviations, variance_of
from clearance.budget.largest import ToleranceSearch
from clearance.budget.proven import PairsWithErrors, PathMoments, SectionBudget
from clearance.budget.sources import (
    Slope,
    SourceKey,
    Witness,
    sizes_of,
    slopes,
    units_of,
    with_sizes,
)
from clearance.record.budget import BudgetMoment, ErrorSource
from clearance.record.moment import Moment
from clearance.simulate.measure.moment_query import MomentQuery
from clearance.world.budget import Budget
from clearance.world.case import Limits
from clearance.world.forest import forest_of, positions_between
from clearance.world.pairs import Pair

MOST_WORST = 3
"""Moments of a rule to report, each of another pair."""

MOST_BETWEEN = 8
"""Intervals whose least moments are candidates for that."""


@dataclass(frozen=True, eq=False)
class _LowMoment:
    """A moment of a section at which little is left of a pair: [m] proven, less padding."""

    section: SectionBudget
    interval: int
    share: float
    pair: int
    proven: float

    @property
    def moments(self) -> PathMoments:
        return PathMoments(np.array([self.interval]), np.array([self.share]))


class WorstMoments:
    """The moments of a rule at which a budget leaves least, each of another pair, the worst first."""

    def __init__(self, rule: str, limits: Limits, sections: Sequence[SectionBudget]) -> None:
        self._rule, self._sections = rule, sections
        self._largest = ToleranceSearch(limits.fail, sections)

    @cached_property
    def moments(self) -> tuple[BudgetMoment, ...]:
        """The moments, without the loss by each error."""
        return tuple(self._moment(low) for low in self._lows)

    def with_sources(self, i: int, most: int | None = None) -> BudgetMoment:
        """One of them with the loss by each error, and for the first `most`, or all, its greatest size."""
        low = self._lows[i]
        case = low.section.section.phase.case
        sources = tuple(
            replace(one, largest=tuple(self._largest.of(case, key._replace(moment=NOW))))
            if most is None or place < most
            else one
            for place, (key, one) in enumerate(self._sources[i])
        )
        return replace(self.moments[i], sources=sources)

    @cached_property
    def _lows(self) -> list[_LowMoment]:
        lows = sorted(
            (low for section in self._sections for low in _lows(section)),
            key=lambda low: low.proven,
        )
        named: dict[Pair, _LowMoment] = {}
        for low in lows:
            named.setdefault(low.section.section.pairs[low.pair], low)
        return [*named.values()][:MOST_WORST]

    @cached_property
    def _sources(self) -> list[list[tuple[SourceKey, ErrorSource]]]:
        return [_sources(low) for low in self._lows]

    def _moment(self, low: _LowMoment) -> BudgetMoment:
        section = low.section.section
        moment = _measured(low)
        expected = np.nan
        if not moment.touches:
            what = low.section.pairs
            loss = what.budget.coverage * deviations(
                section.phase.case, what.budget, _witness(low, moment)
            )
            expected = max(moment.clearance - float(loss[0]) - section.padding, low.proven)
        reported = moment.of_run(section.phase.first, section.padding, self._rule)
        return BudgetMoment(reported, low.proven, expected)


def _sources(low: _LowMoment) -> list[tuple[SourceKey, ErrorSource]]:
    """The loss by each error at a moment, the greatest first."""
    section, moment = low.section, _measured(low)
    case, budget = section.section.phase.case, section.pairs.budget
    pairs = _alone(low)
    by_key: dict[SourceKey, list[Slope]] = {}
    for slope in slopes(case, budget, _witness(low, moment)):
        by_key.setdefault(slope.key, []).append(slope)
    found = []
    for key, own in by_key.items():
        sizes, units = sizes_of(budget, key), units_of(case, key)
        less = with_sizes(budget, key, (0.0,) * len(sizes))
        loss = _at(pairs.of(budget, (key.moment, less)), low) - _at(pairs, low)
        expected = None if moment.touches else _deviation(own, budget)
        source = ErrorSource(
            key.owner, key.kind, key.part, tuple(zip(sizes, units, strict=True)),
            max(0.0, loss), expected, moment=key.moment,
        )  # fmt: skip
        found.append((key, source))
    return sorted(found, key=lambda one: -one[1].proven)


def _deviation(own: list[Slope], budget: Budget) -> float:
    """[m] standard deviation of the clearance by errors of one source."""
    return float(np.sqrt(sum(float(variance_of(slope, budget)[0]) for slope in own)))


def _alone(low: _LowMoment) -> PairsWithErrors:
    """The pair without all others: one of those could be nearer as soon as an error is taken away."""
    pairs = low.section.pairs
    what = replace(pairs.what, pairs=(pairs.what.pairs[low.pair],))
    return PairsWithErrors(what, pairs.budget)


def _at(alone: PairsWithErrors, low: _LowMoment) -> float:
    """[m] the bound on a pair alone at a moment."""
    found = alone.at(low.moments, np.zeros(1, dtype=np.int64), np.array([np.nan]))
    return float(found.proven[0])


def _lows(section: SectionBudget) -> Iterator[_LowMoment]:
    """The least moment of each pair over the steps, and of the intervals with less between their steps."""
    steps, padding = section.steps, section.section.padding
    at = section.pairs.steps
    for pair in np.unique(steps.pair[steps.pair >= 0]).tolist():
        i = int(np.argmin(np.where(steps.pair == pair, steps.proven, np.inf)))
        place = int(at.intervals[i]), float(at.shares[i])
        yield _LowMoment(section, *place, pair, float(steps.proven[i]) - padding)
    between = section.between
    if between is None:
        return
    seen = np.flatnonzero(between.share >= 0.0)
    seen = seen[np.argsort(between.proven[seen], kind="stable")][:MOST_BETWEEN]
    found = section.pairs.at(
        PathMoments(seen, between.share[seen]), between.pair[seen], np.full(len(seen), np.nan)
    )
    for i, interval in enumerate(seen.tolist()):
        place = interval, float(between.share[interval])
        proven = max(float(found.proven[i]), float(between.proven[interval]))  # both hold then
        yield _LowMoment(section, *place, int(found.pair[i]), proven - padding)


def _measured(low: _LowMoment) -> Moment:
    """The pair, measured without errors, in its phase."""
    phase = low.section.section.phase
    moments = MomentQuery(phase.case, phase.motions, low.section.section.pairs)
    if low.share == 1.0:
        return moments.between(low.interval + 1, 0.0, low.pair)
    return moments.between(low.interval, low.share, low.pair)


def _witness(low: _LowMoment, moment: Moment) -> Witness:
    """The nearest points of the pair at the moment, and the poses then."""
    phase, budget = low.section.section.phase, low.section.pairs.budget
    step = min(low.interval, max(0, phase.n_steps - 2))
    columns = positions_between(
        phase.case, phase.motions, step, low.share if phase.n_steps > 1 else 0.0
    )
    points = np.array([[moment.point_link, moment.point_obstacle]])
    rates = clock_rates(phase.case, budget, phase.motions, np.array([moment.time]))
    poses = forest_of(phase.case).poses(columns[None])
    return Witness(low.section.section.pairs[low.pair], points, poses, rates)

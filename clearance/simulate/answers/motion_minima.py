"""The least clearance of each pair over the certified motion. Not for: at the steps (`measured_run`)."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace
from functools import cached_property

import numpy as np

from clearance.record.moment import Moment
from clearance.record.record import PairMinimum
from clearance.simulate.answers.pairs_alone import (
    can_be_alone,
    least_between,
    near_alone,
    near_between,
)
from clearance.simulate.answers.rule_pairs import MeasuredRule

MOST_INTERVALS = 2**14
"""Most intervals times pairs for which far pairs are proven too: a tenth of a second."""


def motion_minima(
    rules: Sequence[MeasuredRule], sampled: Sequence[PairMinimum], most: int | None = None
) -> tuple[PairMinimum, ...]:
    """The least clearance of each pair over the motion, where that is certified; else at the steps.

    Far pairs have their least at the samples if there are too many to prove each on its own. So have pairs of two
    clocks, and pairs hidden by a nearer one among them; the nearest of an interval has what the proof saw.

    Args:
        sampled: the least of each pair at the steps. most: the first few alone.
    """
    found: list[PairMinimum] = []
    for rule in rules:
        own = [one for one in sampled if one.rule == rule.name]
        within = max(rule.limits.warn, rule.limits.fail)
        seen = _with_seen(rule, own)
        if rule.pairs is None or not can_be_alone(rule, within):
            found += seen
        else:
            found += _RuleMinima(rule, within).of(seen, most)
    return tuple(sorted(found, key=lambda one: one.clearance)[:most])


def _with_seen(rule: MeasuredRule, sampled: Sequence[PairMinimum]) -> list[PairMinimum]:
    """The least of pairs at the steps, or between them where the proof of their rule saw them nearer."""
    certificate = rule.certificate
    if certificate is None or not sampled:
        return list(sampled)
    found = {(one.link, one.obstacle): one for one in sampled}
    for pair in np.unique(certificate.pair[certificate.pair >= 0]).tolist():
        own = np.flatnonzero(certificate.pair == pair)
        moment = certificate.moment_of(int(own[np.argmin(certificate.upper_bound[own])]))
        names = moment.link, moment.obstacle
        found[names] = _lesser(found.get(names), moment, None)
    return list(found.values())


@dataclass(frozen=True, eq=False)
class _RuleMinima:
    """The pairs of a rule; those within [m] are near."""

    rule: MeasuredRule
    within: float

    def of(self, sampled: Sequence[PairMinimum], most: int | None) -> list[PairMinimum]:
        """The least of the pairs that are given, and of all others that are among the first `most`."""
        assert self.rule.pairs is not None
        near = near_alone(self.rule, self.within)
        known = {self._places[one.link, one.obstacle]: one for one in sampled}
        far = {pair: one.clearance for pair, one in known.items() if pair not in near}
        n_steps = len(self.rule.measurement.clearance)
        if most is None and n_steps * len(far) > MOST_INTERVALS:
            far = {}
        found = dict(known)
        for pair, answer in near.items():
            if pair in known or most is not None:
                assert answer.certificate is not None
                proven = float(answer.certificate.lower_bound.min())
                found[pair] = _lesser(known.get(pair), answer.worst, proven)
        found |= self._proven(far, known)
        looked_at = {*found}
        while most is not None and len(found) >= most:
            level = sorted(one.clearance for one in found.values())[most - 1]
            near_by = (near_between(one, level, looked_at) for one in self.rule.pairs.answers)
            new = set[int]().union(*near_by) - looked_at
            if not new:
                break
            looked_at |= new
            found |= self._proven(dict.fromkeys(new, level), {})
        return list(found.values())

    def _proven(
        self, asked: dict[int, float], known: dict[int, PairMinimum]
    ) -> dict[int, PairMinimum]:
        """The least of some pairs up to a clearance [m] each, without those that stay above it; `known`: their
        least at the steps. The certificate of the rule holds for each."""
        found = least_between(self.rule, asked) if asked else {}
        certificate = self.rule.certificate
        of_all = -np.inf if certificate is None else float(certificate.lower_bound.min())
        return {
            pair: _lesser(known.get(pair), moment, max(proven, of_all))
            for pair, (proven, moment) in found.items()
            if pair in known or moment is not None
        }

    @cached_property
    def _places(self) -> dict[tuple[str, str], int]:
        """The place of each pair among those of the run, by its names."""
        assert self.rule.pairs is not None
        places = [place for one in self.rule.pairs.answers for place in one.section.places.tolist()]
        return dict(zip(self.rule.pairs.names, places, strict=True))


def _lesser(
    sampled: PairMinimum | None, moment: Moment | None, proven: float | None
) -> PairMinimum:
    """The least of a pair: at a step, unless a moment between has a lower clearance."""
    if sampled is not None and (moment is None or sampled.clearance <= moment.clearance):
        return replace(sampled, proven=proven)
    assert moment is not None
    return PairMinimum(
        link=moment.link,
        obstacle=moment.obstacle,
        clearance=moment.clearance,
        step=moment.step,
        time=moment.time,
        point_link=moment.point_link,
        point_obstacle=moment.point_obstacle,
        rule=moment.rule,
        between=moment.between,
        proven=proven,
    )

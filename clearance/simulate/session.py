"""One object that works out on demand what a record leaves open: pairs, moments, stretches, a replay.

Whoever makes a record has its session with it, and gives it to those who ask.
"""

from __future__ import annotations

from collections.abc import Sequence
from functools import cached_property

import numpy as np

from clearance.record.budget import BudgetMoment, RuleBudget
from clearance.record.levels import Event, Interval
from clearance.record.moment import Moment
from clearance.record.record import PairMinimum
from clearance.record.replay import EarlierBody, Replay
from clearance.record.rows.resumable import IN_MEMORY, MeasuredRows
from clearance.record.rule_answer import NearRows, RuleAnswer
from clearance.record.sensitivity import Sensitivity
from clearance.simulate.answers import intervals
from clearance.simulate.answers.deepest import WorstMoments
from clearance.simulate.answers.measured_run import MeasuredRun
from clearance.simulate.answers.motion_minima import motion_minima
from clearance.simulate.answers.pairs_alone import can_be_alone, near_alone
from clearance.simulate.answers.standing import standing_bodies, standing_hint
from clearance.simulate.answers.stretches import RuleStretches


class MeasuringSession(MeasuredRun):
    """What can be asked of a measured run; each answer is worked out once."""

    def is_cut(self, rule: RuleAnswer, within: float) -> bool:
        """True if only the nearest pair of some steps is known within [m], since there are too many."""
        pairs = self.measured(rule).pairs
        return pairs is not None and pairs.is_cut(within)

    def near(self, rule: RuleAnswer, within: float) -> NearRows:
        """All pairs of a rule that come within [m] at each step, as far as they are known."""
        pairs = self.measured(rule).pairs
        if pairs is not None:
            return pairs.near(within)
        found = rule.measurement
        steps = np.flatnonzero((found.pair >= 0) & (found.clearance < within))
        touching = found.touches(slice(None))[steps]
        only = np.ones(len(steps), dtype=bool)
        return NearRows(steps, found.pair[steps], found.clearance[steps], touching, only)

    def alone(self, rule: RuleAnswer, within: float) -> tuple[RuleAnswer, ...] | None:
        """The answer for each pair that comes within [m], proven alone; None where pairs cannot be."""
        own = self.measured(rule)
        if not can_be_alone(own, within):
            return None
        return self.answers(near_alone(own, within).values())

    def moment(self, rule: RuleAnswer, step: int, pair: int) -> Moment:
        """The moment of a pair of the run at a step at which it is measured."""
        own = self.measured(rule)
        if own.pairs is None or rule.measurement.pair[step] == pair:
            return own.moment_at(step)
        return own.pairs.moment(step, pair)

    def moment_at(self, rule: RuleAnswer, step: int) -> Moment:
        """The moment of the nearest pair at a step whose clearance is known."""
        return self.measured(rule).moment_at(step)

    def moment_between(self, rule: RuleAnswer, step: int) -> Moment:
        """The moment after a step at which the proof of a rule saw the least distance."""
        certificate = self.measured(rule).certificate
        assert certificate is not None, "the run is certified"
        return certificate.moment_of(step)

    def spans_below(self, rule: RuleAnswer, level: float) -> np.ndarray:
        """(k, 2) [s] start and end of each stretch in which the pairs of a rule are below a level [m]."""
        return RuleStretches(self.measured(rule), level).spans

    def worst_among(self, rules: Sequence[RuleAnswer]) -> Moment | None:
        """The most critical moment, in contact the deepest, as if there were no other rules."""
        return self._worst.among([self.measured(rule) for rule in rules])

    def worst_sample_among(self, rules: Sequence[RuleAnswer]) -> Moment | None:
        """The most critical step, in contact the deepest, as if there were no other rules."""
        return self._worst.at_steps([self.measured(rule) for rule in rules])

    @cached_property
    def _worst(self) -> WorstMoments:
        record = self.record
        between = record.depths_asked and record.certificate is not None
        return WorstMoments(record.contacts, between)

    @cached_property
    def _motion_minima(self) -> dict[int | None, tuple[PairMinimum, ...]]:
        return {}

    def motion_minima(self, most: int | None = None) -> tuple[PairMinimum, ...]:
        """The least clearance of each pair over the motion, where that is certified; else at the steps."""
        if most not in self._motion_minima:
            self._motion_minima[most] = motion_minima(self.rules, self.pair_minima(most), most)
        return self._motion_minima[most]

    @cached_property
    def intervals(self) -> dict[str, list[Interval]]:
        """For each level its first stretches, in order of time."""
        return intervals.intervals(self)

    @cached_property
    def events(self) -> list[Event]:
        """The first moments at which a level was entered or left, in order of time."""
        return intervals.events(self)

    @cached_property
    def not_listed(self) -> dict[str, int]:
        """The number of intervals of each level and of events that these omit."""
        return intervals.not_listed(self)

    def extent(self, level: str) -> tuple[int, int]:
        """The number of intervals of a level, and of the steps in them."""
        return intervals.extent(self, level)

    def sensitivity(self, rules: Sequence[RuleAnswer], moment: Moment) -> Sensitivity:
        """The slopes of the clearance at a moment that one of the rules judges, of their pairs alone."""
        from clearance.simulate.answers.sensitivity import sensitivity_of

        own = [self.measured(rule) for rule in rules if rule.name == moment.rule]
        return sensitivity_of(own, moment)

    @cached_property
    def hints(self) -> tuple[str, ...]:
        """The hints on pairs that touch all the time, and on parts that touch as they change hands."""
        return tuple(standing_hint(self.record))

    @cached_property
    def standing_bodies(self) -> frozenset[str]:
        """The names of the measured bodies that never move."""
        return standing_bodies(self.record)

    def replay(self, rows: MeasuredRows = IN_MEMORY, worst: Moment | None = None) -> Replay:
        """The drawing data of the run.

        Args:
            rows: where its rows are. worst: the most critical moment; that of the record if it is not given.
        """
        from clearance.simulate.replay.replay import replay_of

        return replay_of(self, rows=rows, worst=worst)

    def curve_moments(self) -> list[Moment]:
        """The moments between the steps that a chart shows, in order of time."""
        from clearance.simulate.replay.curve_moments import curve_moments

        return curve_moments(self)

    def earlier_motion(self, replay: Replay) -> list[EarlierBody]:
        """The bodies of a replay of another run that were elsewhere in this one."""
        from clearance.simulate.replay.replay import earlier_motion

        return earlier_motion(self.record, replay)

    def least_left(self, budget: RuleBudget) -> tuple[BudgetMoment, ...]:
        """The moments at which tolerances leave least to a rule, the worst first; none where that is not known."""
        return ()

    def error_sources(
        self, budget: RuleBudget, i_moment: int = 0, most: int | None = None
    ) -> BudgetMoment:
        """One of these moments with what each error takes of it, and of the first `most` the greatest size."""
        return self.least_left(budget)[i_moment]

"""The questions asked of a run beside its record. Not for: answering them (`simulate.session`)."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from typing import Protocol

import numpy as np

from clearance.record.budget import BudgetMoment, RuleBudget
from clearance.record.levels import Event, Interval
from clearance.record.moment import Moment
from clearance.record.record import PairMinimum, Record
from clearance.record.rule_answer import NearRows, RuleAnswer
from clearance.record.sensitivity import Sensitivity
from clearance.world.rules import Waiver

PairTest = Callable[[str, tuple[str, ...], tuple[str, ...]], bool]
"""Whether a pair is meant: the name of its rule, and the names that each of its bodies goes by."""


class Session(Protocol):
    """Works out on demand what a record leaves open; held beside the record by whoever made it."""

    @property
    def record(self) -> Record:
        """The record of the run."""

    def is_cut(self, rule: RuleAnswer, within: float) -> bool:
        """True if only the nearest pair of some steps is known within [m], since there are too many."""

    def near(self, rule: RuleAnswer, within: float) -> NearRows:
        """All pairs of a rule that come within [m] at each step, as far as they are known."""

    def alone(self, rule: RuleAnswer, within: float) -> tuple[RuleAnswer, ...] | None:
        """The answer for each pair that comes within [m], proven alone; None where pairs cannot be."""

    def moment(self, rule: RuleAnswer, step: int, pair: int) -> Moment:
        """The moment of a pair of the run at a step at which it is measured."""

    def moment_between(self, rule: RuleAnswer, step: int) -> Moment:
        """The moment after a step at which the proof of a rule saw the least distance."""

    def spans_below(self, rule: RuleAnswer, level: float) -> np.ndarray:
        """(k, 2) [s] start and end of each stretch in which the pairs of a rule are below a level [m]."""

    def worst_among(self, rules: Sequence[RuleAnswer]) -> Moment | None:
        """The most critical moment, as if there were no other rules."""

    def worst_sample_among(self, rules: Sequence[RuleAnswer]) -> Moment | None:
        """The most critical step, as if there were no other rules."""

    def sensitivity(self, rules: Sequence[RuleAnswer], moment: Moment) -> Sensitivity:
        """The slopes of the clearance at a moment that one of the rules judges, of their pairs alone."""

    def of_pairs(
        self, is_meant: PairTest, need: str | None = None, levels: tuple[float, ...] = ()
    ) -> tuple[RuleAnswer, ...]:
        """The answer of each rule for the pairs that are meant, as if there were no others.

        Args:
            need: as of the run if not given; else proven too. levels: [m] to be decided beside the limits.
        """

    def budget_of_pairs(
        self, is_meant: PairTest, waiver: Waiver | None = None
    ) -> tuple[RuleBudget, ...]:
        """What tolerances leave to the pairs that are meant, against their waiver if they have one; empty without
        tolerances.
        """

    def least_left(self, budget: RuleBudget) -> Sequence[BudgetMoment]:
        """The moments at which tolerances leave least to a rule, the worst first."""

    def error_sources(
        self, budget: RuleBudget, i_moment: int = 0, most: int | None = None
    ) -> BudgetMoment:
        """One of these moments with what each error takes of it, and of the first `most` the greatest size."""

    def pair_minima(self, most: int | None = None) -> Sequence[PairMinimum]:
        """The least clearance of each pair at the steps, least first; the first `most` if that is given."""

    def motion_minima(self, most: int | None = None) -> Sequence[PairMinimum]:
        """The least clearance of each pair over the motion, where that is certified; else at the steps."""

    @property
    def intervals(self) -> Mapping[str, Sequence[Interval]]:
        """For each level its first stretches, in order of time."""

    @property
    def events(self) -> Sequence[Event]:
        """The first moments at which a level was entered or left, in order of time."""

    @property
    def not_listed(self) -> Mapping[str, int]:
        """The number of intervals of each level and of events that these omit."""

    def extent(self, level: str) -> tuple[int, int]:
        """The number of intervals of a level, and of the steps in them."""

    @property
    def hints(self) -> tuple[str, ...]:
        """The hints on pairs that touch all the time, and on parts that touch as they change hands."""

    @property
    def standing_bodies(self) -> frozenset[str]:
        """The names of the measured bodies that never move."""

"""What a report shows of a run beside its record, worked out for it by the session of the run."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass

from clearance.record.budget import BudgetMoment
from clearance.record.levels import Event, Interval
from clearance.record.moment import Moment
from clearance.record.record import PairMinimum


@dataclass(frozen=True, eq=False)
class RunDetails:
    """What a report shows of a run beside its record.

    Attributes:
        minima: the least clearance of each pair, over the motion where that is certified, least first.
        n_pairs: by rule, the number of pairs with a least clearance at the steps.
        worst: by rule, the most critical moment of what it judges, in contact the deepest.
        intervals, events, not_listed: the times below each level, when each is entered and left, and the number of
            those that are left out.
        hints: on pairs that touch all the time. standing: names of the measured bodies that never move.
        least_remaining: by rule, the moments at which tolerances leave least, with what each error takes.
    """

    minima: tuple[PairMinimum, ...]
    n_pairs: Mapping[str, int]
    worst: Mapping[str, Moment]
    intervals: Mapping[str, Sequence[Interval]]
    events: Sequence[Event]
    not_listed: Mapping[str, int]
    hints: tuple[str, ...]
    standing: frozenset[str]
    least_remaining: Mapping[str, tuple[BudgetMoment, ...]]

"""Intervals and events of a certified run: the times below each level, and the most critical moment of each.

Not for: runs that are not certified (`intervals`).
"""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property
from typing import Any
from weakref import WeakKeyDictionary

import numpy as np

from clearance.simulate.moment import Moment
from clearance.simulate.record import Record
from clearance.simulate.rule_answer import standing_worst
from clearance.simulate.stretches import LEVELS, RuleStretches, joined_spans

Span = tuple[float, float]

_KNOWN: WeakKeyDictionary[Record, MotionLevels] = WeakKeyDictionary()


def motion_levels(record: Record) -> MotionLevels | None:
    """The stretches of a record, found once; None where only samples are known."""
    certified = all(rule.pairs and rule.certificate for rule in record.rules)
    if record.certificate is None or not certified or record.need == "minimum":
        return None
    if record not in _KNOWN:
        _KNOWN[record] = MotionLevels(record)
    return _KNOWN[record]


@dataclass(frozen=True, eq=False)
class MotionLevels:
    """The stretches below each level, over all rules."""

    record: Record

    @cached_property
    def _rules(self) -> dict[str, list[RuleStretches]]:
        return {level: [RuleStretches(one, level) for one in self.record.rules] for level in LEVELS}

    @cached_property
    def spans(self) -> dict[str, list[Span]]:
        """Start and end [s] of each stretch, in order, for each level."""
        found = {}
        for level, rules in self._rules.items():
            joined = joined_spans(np.concatenate([rule.spans for rule in rules]))
            found[level] = [(float(start), float(end)) for start, end in joined]
        return found

    @property
    def times(self) -> np.ndarray:
        """(n,) [s] of the steps."""
        return self.record.motions[0].times

    def steps_in(self, span: Span) -> np.ndarray:
        """The steps in a span; the one before it where there is none."""
        first = int(np.searchsorted(self.times, span[0]))
        last = int(np.searchsorted(self.times, span[1], side="right"))
        return np.arange(first, last) if last > first else np.array([first - 1])

    def worst(self, level: str, span: Span) -> Moment | None:
        """The most critical moment of a span."""
        return standing_worst((one.rule, one.worst(*span)) for one in self._rules[level])

    def edge(self, level: str, span: Span, *, last: bool) -> Moment | None:
        """The nearest pair of the rule by which a span begins, or ends, at that time."""
        time = span[1] if last else span[0]
        for one in self._rules[level]:
            if len(one.spans) and (one.spans[:, int(last)] == time).any():
                return one.at(time, *span)
        return None


def told_moment(moment: Moment | None, time: float) -> dict[str, Any]:
    """The fields of a moment; if none is known, of a time [s]."""
    if moment is None:
        return {"time": time, "clearance": None, "link": None, "obstacle": None, "rule": ""}
    names = ("clearance", "link", "obstacle", "rule")
    return {"time": time} | {name: getattr(moment, name) for name in names}

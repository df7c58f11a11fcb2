"""Intervals and events of a certified run: the times below each level, and the most critical moment of each."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from functools import cached_property
from typing import Any

import numpy as np

from clearance.record.levels import LEVELS
from clearance.record.moment import Moment
from clearance.record.rule_answer import standing_worst
from clearance.simulate.answers.rule_pairs import MeasuredRule
from clearance.simulate.answers.stretches import RuleStretches, joined_spans

Span = tuple[float, float]


@dataclass(frozen=True, eq=False)
class MotionLevels:
    """The stretches below each level, over all rules.

    Attributes:
        times: (n,) [s] of the steps.
    """

    times: np.ndarray
    rules: Sequence[MeasuredRule]

    @cached_property
    def _rules(self) -> dict[str, list[RuleStretches]]:
        return {level: [RuleStretches(one, level) for one in self.rules] for level in LEVELS}

    @cached_property
    def spans(self) -> dict[str, list[Span]]:
        """Start and end [s] of each stretch, in order, for each level."""
        found = {}
        for level, rules in self._rules.items():
            joined = joined_spans(np.concatenate([rule.spans for rule in rules]))
            found[level] = [(float(start), float(end)) for start, end in joined]
        return found

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


def moment_fields(moment: Moment | None, time: float) -> dict[str, Any]:
    """The fields of a moment; if none is known, of a time [s]."""
    if moment is None:
        return {"time": time, "clearance": None, "link": None, "obstacle": None, "rule": ""}
    names = ("clearance", "link", "obstacle", "rule")
    return {"time": time} | {name: getattr(moment, name) for name in names}

"""The record of a run with what can measure more of it. Not for: what is worked out on demand (`session`)."""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Sequence
from dataclasses import dataclass
from functools import cached_property
from typing import TYPE_CHECKING, Any

import numpy as np

from clearance.record.contact import StepContact
from clearance.record.levels import LEVELS
from clearance.record.moment import Moment
from clearance.record.names import pair_names
from clearance.record.record import PairMinimum, Record
from clearance.record.rule_answer import RuleAnswer, standing_worst
from clearance.simulate.answers.rule_pairs import MeasuredRule
from clearance.simulate.answers.stretches import RuleStretches, joined_spans

if TYPE_CHECKING:
    from clearance.query.contact import Contact
    from clearance.simulate.answers.contact.rows import FoundContacts


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


@dataclass(frozen=True, eq=False)
class MeasuredRun:
    """A record and what was measured for it.

    Attributes:
        rules: those of the record, with what measures more of them. contacts: None where nothing touches.
    """

    record: Record
    rules: tuple[MeasuredRule, ...]
    contacts: FoundContacts | None = None

    @cached_property
    def _by_answer(self) -> dict[RuleAnswer, MeasuredRule]:
        return {rule.answer: rule for rule in self.rules}

    def measured(self, answer: RuleAnswer) -> MeasuredRule:
        """The rule that an answer of this run is of."""
        return self._by_answer[answer]

    def answers(self, rules: Iterable[MeasuredRule]) -> tuple[RuleAnswer, ...]:
        """The data of some rules, of which more can be asked later."""
        by_answer = {rule.answer: rule for rule in rules}
        self._by_answer.update(by_answer)
        return tuple(by_answer)

    def overlap(self, row: StepContact) -> Contact:
        """All of an overlap, with its region; worked out now where the record does not have it."""
        assert self.contacts is not None, "a row of contact needs a run with contacts"
        return self.contacts.overlap(row)

    @cached_property
    def _pair_minima(self) -> dict[int | None, tuple[PairMinimum, ...]]:
        return {}

    def pair_minima(self, most: int | None = None) -> tuple[PairMinimum, ...]:
        """The least clearance of each pair at the steps, least first; the first `most` if that is given."""
        known = self._pair_minima
        if None in known:
            return known[None][:most]
        if most not in known:
            record = self.record
            names, times = pair_names(record.case, record.pairs), record.motions[0].times
            known[most] = pair_minima(self.rules, names, times, most)
        return known[most]

    @cached_property
    def motion_levels(self) -> MotionLevels | None:
        """The stretches below each level; None where only samples are known."""
        certified = all(rule.pairs and rule.certificate for rule in self.rules)
        if self.record.certificate is None or not certified or self.record.need == "minimum":
            return None
        return MotionLevels(self.record.motions[0].times, self.rules)


def pair_minima(
    rules: Sequence[MeasuredRule],
    names: tuple[list[str], list[str]],
    times: np.ndarray,
    most: int | None = None,
) -> tuple[PairMinimum, ...]:
    """The least clearance of every pair at the steps, least first, ties in the order of the pairs.

    Empty if less was asked for. A pair that different rules judge at different times is there once for each.

    Args:
        names: the bodies of each pair of the run. times: (n,) [s] of its steps.
        most: the first few alone, of which nothing else is measured.
    """
    found = [row for rule in rules for row in _of_rule(rule, names, times, most)]
    return tuple(sorted(found, key=lambda row: row.clearance)[:most])


def _of_rule(
    rule: MeasuredRule, names: tuple[list[str], list[str]], times: np.ndarray, most: int | None
) -> Iterator[PairMinimum]:
    find = rule.measurement.measure_pair_minima
    if find is None:
        return
    links, obstacles = names
    found = find(most)
    for i in np.argsort(found.clearance, kind="stable"):
        if np.isfinite(found.clearance[i]):  # the paper's rules can cut a pair at every step
            yield PairMinimum(
                link=links[i],
                obstacle=obstacles[i],
                clearance=float(found.clearance[i]),
                step=int(found.step[i]),
                time=float(times[found.step[i]]),
                point_link=tuple(found.points[i, 0].tolist()),
                point_obstacle=tuple(found.points[i, 1].tolist()),
                rule=rule.name,
            )

"""The record of a run beside what can measure more of it. Not for: what is worked out on demand (`session`)."""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import dataclass
from functools import cached_property
from typing import TYPE_CHECKING

from clearance.record.contact import StepContact
from clearance.record.names import pair_names
from clearance.record.record import PairMinimum, Record
from clearance.record.rule_answer import RuleAnswer
from clearance.simulate.answers.motion_levels import MotionLevels
from clearance.simulate.answers.pair_minima import pair_minima
from clearance.simulate.answers.rule_pairs import MeasuredRule

if TYPE_CHECKING:
    from clearance.query.contact import Contact
    from clearance.simulate.answers.contact.rows import FoundContacts


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
        told = {rule.answer: rule for rule in rules}
        self._by_answer.update(told)
        return tuple(told)

    def overlap(self, row: StepContact) -> Contact:
        """All of an overlap, with its region; worked out now where the record does not have it."""
        assert self.contacts is not None, "a row of contact is of a run with contacts"
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

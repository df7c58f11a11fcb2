"""The worst moments of a run: in contact the deepest, as far as depth is known."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace

from clearance.record.contact import ContactRows, StepContact
from clearance.record.moment import Depth, Moment
from clearance.record.rule_answer import standing_worst, worst_of
from clearance.simulate.answers.rule_pairs import MeasuredRule


@dataclass(frozen=True, eq=False)
class WorstMoments:
    """The most critical moments of a run.

    Attributes:
        contacts: those of the run. between: whether depth is computed between the steps too.
    """

    contacts: ContactRows | tuple[()]
    between: bool

    def at_steps(self, rules: Sequence[MeasuredRule]) -> Moment | None:
        """The most critical step; without rules, the first of least clearance; None where none is known."""
        worst = standing_worst((rule, rule.worst_sample) for rule in rules)
        return None if worst is None else self._deepest_of(rules, worst)

    def of_motion(self, rules: Sequence[MeasuredRule], sample: Moment) -> Moment:
        """The most critical moment of the motion; `sample` is `at_steps`."""
        worst = worst_of(rules)
        assert worst is not None
        known = sample if worst.touches and sample.depth else worst
        return self._deeper_between(rules, known)

    def among(self, rules: Sequence[MeasuredRule]) -> Moment | None:
        """The most critical moment, as if there were no other rules than some, or than some of their pairs."""
        worst = worst_of(rules)
        if worst is None:
            return None
        return self._deeper_between(rules, self._deepest_of(rules, worst))

    def _deepest_of(self, rules: Sequence[MeasuredRule], worst: Moment) -> Moment:
        """The deepest of the moments in contact in place of one of them, where depth is known."""
        if not (
            worst.touches and isinstance(self.contacts, ContactRows) and self.contacts.are_asked
        ):
            return worst
        return _deepest_step(self.contacts.worked_out, rules) or worst

    def _deeper_between(self, rules: Sequence[MeasuredRule], known: Moment) -> Moment:
        """The deepest moment between two steps in place of one in contact, if it is deeper and depth is asked."""
        if not known.touches or not self.between:
            return known
        from clearance.simulate.answers.deepest_between import deepest_between

        found = deepest_between(rules)
        if found is None or found.depth is None:
            return known
        deeper = known.depth is None or found.depth.penetration > known.depth.penetration
        return found if deeper else known


def _deepest_step(rows: Sequence[StepContact], rules: Sequence[MeasuredRule]) -> Moment | None:
    """The first moment of the deepest overlap that one of the rules judges; None where none judges any."""
    for row in sorted(rows, key=lambda row: -row.penetration):
        for rule in rules:
            moment = _touching(rule, row)
            if moment is not None and row.known is not None:
                found = row.known
                depth = Depth(found.penetration, found.penetration_at_least, bool(found.exact[0]))
                return replace(moment, depth=depth)
    return None


def _touching(rule: MeasuredRule, row: StepContact) -> Moment | None:
    """The moment of an overlap, if the rule judges its pair and finds it in contact there."""
    pair = None if rule.pairs is None else rule.pairs.place_of(row.step, (row.link, row.obstacle))
    if pair is None or rule.pairs is None:
        return None
    nearest = rule.measurement.pair[row.step] == pair
    moment = rule.moment_at(row.step) if nearest else rule.pairs.moment(row.step, pair)
    return moment if moment.touches else None

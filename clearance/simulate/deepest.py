"""The moment of deepest contact among the pairs that some rules judge.

Not for: finding overlaps and their depth (`contact`), nor moments without contact (`rule_answer`).
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace

from clearance.simulate.contact.sequence import StepContact
from clearance.simulate.moment import Depth, Moment
from clearance.simulate.rule_answer import RuleAnswer


def deepest_moment(rows: Sequence[StepContact], rules: Sequence[RuleAnswer]) -> Moment | None:
    """The first moment of the deepest overlap that one of the rules judges; None where none judges any.

    Args:
        rows: the overlaps whose depth is known.
    """
    for row in sorted(rows, key=lambda row: -row.numbers.penetration):
        for rule in rules:
            moment = _touching(rule, row)
            if moment is not None:
                found = row.numbers
                depth = Depth(found.penetration, found.penetration_at_least, bool(found.exact[0]))
                return replace(moment, depth=depth)
    return None


def _touching(rule: RuleAnswer, row: StepContact) -> Moment | None:
    """The moment of an overlap, if the rule judges its pair and finds it in contact there."""
    pair = None if rule.pairs is None else rule.pairs.place_of(row.step, (row.link, row.obstacle))
    if pair is None or rule.pairs is None:
        return None
    nearest = rule.measurement.pair[row.step] == pair
    moment = rule.moment_at(row.step) if nearest else rule.pairs.moment(row.step, pair)
    return moment if moment.touches else None

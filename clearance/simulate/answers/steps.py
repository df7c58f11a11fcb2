"""Turns measurements into the tables that everybody reads."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from clearance.record.every_pair import EveryPair
from clearance.record.names import pair_names, sides_of
from clearance.record.record import CUT
from clearance.record.steps import RunAnswer
from clearance.simulate.answers.rule_pairs import MeasuredRule
from clearance.world.case import Case, Omission
from clearance.world.pairs import Pair


def every_pair(case: Case, pairs: Sequence[Pair], judged: RunAnswer) -> EveryPair | None:
    """The clearance of every pair at every step; None if that was not asked for."""
    every = judged.found.every
    if every is None:
        return None
    own = [(rule.name, rule.measurement.every) for rule in judged.rules]
    by_rule = tuple((name, found) for name, found in own if found is not None)
    return EveryPair(*pair_names(case, pairs), every, sides_of(case), by_rule)


def cut_throughout(
    case: Case, pairs: Sequence[Pair], rules: Sequence[MeasuredRule]
) -> list[Omission]:
    """The pairs of which the paper's method says nothing at any step; none for the exact method."""
    found = rules[0].measurement
    if len(rules) > 1 or not found.may_cut_pairs or found.measure_pair_minima is None:
        return []
    links, obstacles = pair_names(case, pairs)
    cut = np.flatnonzero(np.isinf(found.measure_pair_minima(None).clearance))
    return [Omission(links[i], obstacles[i], CUT) for i in cut]

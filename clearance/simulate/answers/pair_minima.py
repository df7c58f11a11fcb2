"""The least clearance of each pair over the steps. Not for: over the motion (`motion_minima`)."""

from __future__ import annotations

from collections.abc import Iterator, Sequence

import numpy as np

from clearance.record.record import PairMinimum
from clearance.simulate.answers.rule_pairs import MeasuredRule


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

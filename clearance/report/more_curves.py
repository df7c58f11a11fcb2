"""Curves beside that of the clearance: what tolerances leave of it, and what was asked of a recorded run.

Thinned so that the least of every stretch is kept. Not for: the curve itself (`page`).
"""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass

import numpy as np

from clearance.budget.columns import least_between, least_expected, least_proven
from clearance.record.record import Record

MOST_PARTS = 2000
"""Stretches that a screen can resolve."""


@dataclass(frozen=True, eq=False)
class PageCurve:
    """One curve.

    Attributes:
        name: what it is called where it is pointed at. times: (k,) [s]. values: (k,) [m]; NaN where it has none.
        dash: how its line is drawn. filled: whether the space to the curve before it is.
    """

    name: str
    times: np.ndarray
    values: np.ndarray
    dash: str = "solid"
    filled: bool = False


def more_curves(record: Record) -> tuple[PageCurve, ...]:
    """The curves; none where there are neither tolerances nor a recording."""
    return tuple(_curves(record))


def _curves(record: Record) -> Iterator[PageCurve]:
    if record.commanded is not None:
        yield _thinned("as asked", record.commanded.times, record.commanded.clearances, "dash")
    if record.budget:
        times, between = record.motions[0].times, least_between(record.budget)
        proven = least_proven(record.budget)
        proven = proven if between is None else np.minimum(proven, between)
        yield _thinned("proven with tolerances", times, proven)
        expected = np.maximum(
            least_expected(record.budget), proven
        )  # as `tolerances.least_expected`
        yield _thinned("expected, an estimate", times, expected, "dot", filled=True)


def _thinned(
    name: str, times: np.ndarray, values: np.ndarray, dash: str = "solid", filled: bool = False
) -> PageCurve:
    n_parts = min(len(times), MOST_PARTS)
    starts = np.arange(n_parts) * len(times) // n_parts
    ends = np.append(starts[1:], len(times)) - 1
    middles = 0.5 * (times[starts] + times[ends])
    return PageCurve(name, middles, np.fmin.reduceat(values, starts), dash, filled)

"""Where between two steps to look: moments in the motions of a path that are not proven.

A path that is to keep away between its steps may bend there, and then needs less than where both steps are
farther. First moments are even; then they are beside the lowest, where the least of a line past a body lies. Not
for: what is wanted at them (`shortfalls`).
"""

from __future__ import annotations

import numpy as np

from clearance.gains.shortfalls import (
    MOMENTS,
    MOST_INTERVALS,
    SAME,
    Requirement,
    State,
    intervals,
    raised,
    short_of,
    with_new_moments,
)
from clearance.record.record import Record


def refined(wanted: Requirement, record: Record, state: State) -> Requirement:
    """What is wanted, with moments in the motions that are farthest from being proven, and more in the others.

    Args:
        record: what is proven of a state. state: it, measured at its steps and at the moments wanted so far.
    """
    times, short = record.motions[0].times, short_of(record)
    n_looks = np.bincount(intervals(times, wanted.moments), minlength=len(times))
    open_ones = np.where(n_looks <= MOMENTS, short, 0.0)
    open_ones[-1] = 0.0
    chosen = np.argsort(-open_ones, kind="stable")[:MOST_INTERVALS]
    chosen = np.sort(chosen[open_ones[chosen] > 0.0])
    own, least = state.record.motions[0].times, _least(state)
    new = [_moments(own, least, times[i], times[i + 1]) for i in chosen.tolist()]
    return with_new_moments(raised(wanted, record, chosen), np.concatenate([np.zeros(0), *new]))


def _moments(times: np.ndarray, least: np.ndarray, start: float, end: float) -> np.ndarray:
    """(k,) [s] where to look in a motion: evenly, or, where it was looked into, on both sides of the lowest."""
    first, last = np.searchsorted(times, [start - SAME, end - SAME])
    lowest = first + int(np.argmin(least[first : last + 1]))
    if last - first == 1:
        ends = times[[first, last]]
    else:
        ends = times[max(lowest - 1, first) : min(lowest + 1, last) + 1]
    shares = np.arange(1, MOMENTS + 1) / (MOMENTS + 1)
    return np.asarray((ends[:-1, None] + np.diff(ends)[:, None] * shares).ravel())


def _least(state: State) -> np.ndarray:
    """(n,) [m] what the nearest of each step has above what is wanted; infinite where nothing is near."""
    least = np.full(len(state.record.motions[0].times), np.inf)
    for approach in state.near:
        np.minimum.at(least, approach.steps, -state.missing(approach))
    return least

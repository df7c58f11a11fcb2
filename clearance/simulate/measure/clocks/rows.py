"""What is found of pairs of two clocks, as rows of the first clock: a measurement and a certificate like any
other.
"""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from clearance.kernels.clocks.unsynchronised import TwoClockBounds
from clearance.record.measurement import SWEEP_COUNTERS, Minima
from clearance.simulate.measure.clocks.pairs import PairsOfTwoClocks
from clearance.simulate.measure.clocks.unsynchronised import (
    UnsynchronisedAnswers,
    least_of_all_steps,
    least_unsynchronised,
)
from clearance.simulate.measure.measured import MeasuredSteps, ProvenMotion, no_minima
from clearance.simulate.measure.resources import Resources

ROUNDED_DOWN = 1.0 - 2.0**-50
"""Covers the rounding of the steps' clearances, which are right to the last place."""


def measure_two_clocks(
    what: PairsOfTwoClocks, gap: float | None, resources: Resources
) -> tuple[MeasuredSteps, ProvenMotion | None]:
    """The clearances at the steps of the first clock, and what is proven between; nothing without a `gap` [m]."""
    found = least_unsynchronised(what, gap, resources)
    return _measurement(what, found, resources), _certificate(what, found)


def _measurement(
    what: PairsOfTwoClocks, found: UnsynchronisedAnswers, resources: Resources
) -> MeasuredSteps:
    steps, known = found.steps, found.steps.pair >= 0
    tally = dict.fromkeys(SWEEP_COUNTERS, 0)
    tally |= {name: number for name, number in found.steps_tally.items() if name in tally}
    quiet = Resources(resources.jobs)
    return MeasuredSteps(
        np.where(known, steps.clearance, np.nan),
        steps.clearance * ROUNDED_DOWN,
        steps.pair,
        steps.points,
        tally,
        measure_pair_minima=lambda most: _minima(what, quiet),
        times_b=np.where(known, what.b.times[np.maximum(steps.step_b, 0)], np.nan),
    )


def _minima(what: PairsOfTwoClocks, resources: Resources) -> Minima:
    """The least of each pair, each asked about by itself."""
    least = no_minima(len(what.pairs))
    for i, pair in enumerate(what.pairs):
        steps = least_of_all_steps(replace(what, pairs=(pair,)), resources)
        if (steps.pair < 0).all():  # no two steps occur together
            continue
        step = int(np.argmin(np.where(steps.pair < 0, np.inf, steps.clearance)))
        least.clearance[i], least.step[i] = steps.clearance[step], step
        least.points[i] = steps.points[step]
    return least


def _certificate(what: PairsOfTwoClocks, found: UnsynchronisedAnswers) -> ProvenMotion | None:
    """Rows as those of one clock: one for each interval, and the last step's."""
    if found.intervals is None:
        return None
    own, last = found.intervals, found.steps.clearance[-1:]
    occurs = np.isfinite(own.upper)
    return ProvenMotion(
        np.append(own.lower, last * ROUNDED_DOWN),
        np.append(own.upper, last),
        np.append(np.where(occurs, own.share_a, -1.0), -1.0),
        np.append(np.where(occurs, own.pair, -1), -1),
        _widest(own, found.gap),
        {name: n for name, n in found.intervals_tally.items() if name in SWEEP_COUNTERS},
        found.notices,
        moment_of=found.moment_of,
    )


def _widest(intervals: TwoClockBounds, gap: float) -> float:
    """[m] The gap that the bounds of an interval were allowed."""
    known = np.isfinite(intervals.upper)
    gaps = intervals.upper[known] - intervals.lower[known]
    return max(gap, float(gaps.max(initial=0.0)))

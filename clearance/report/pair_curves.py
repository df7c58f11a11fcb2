"""Each pair's own clearance over time for the page, thinned so that the page stays small.

Not for: the table of every pair at every step (`tables`).
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from clearance.record.record import PairMinimum, Record
from clearance.record.rows.resumable import IN_MEMORY, MeasuredRows

MOST_NUMBERS = 250_000
"""Numbers of all curves together: 1.3 MB on the page."""


@dataclass(frozen=True, eq=False)
class PairCurves:
    """The least clearance of each pair in each stretch of steps.

    Attributes:
        times: (k,) [s] the middle of each stretch; of each step where there are no more.
        clearances: (p, k) float32 [m], rounded down; pairs as in `minima`; NaN while one is not
            measured.
    """

    times: np.ndarray
    clearances: np.ndarray


def pair_curves(
    record: Record, minima: Sequence[PairMinimum], kept: MeasuredRows = IN_MEMORY
) -> PairCurves | None:
    """The curves; None unless every pair was measured at every step."""
    every = record.every_pair
    if every is None:
        return None
    n_steps, n_pairs = every.clearance.shape
    n_parts = min(n_steps, max(1, MOST_NUMBERS // n_pairs))
    starts = np.arange(n_parts) * n_steps // n_parts
    least = np.fmin.reduceat(every.clearance, starts, axis=0)
    kept.let_go()
    times = record.motions[0].times
    middles = 0.5 * (times[starts] + times[np.append(starts[1:], n_steps) - 1])
    places = {pair: i for i, pair in enumerate(zip(every.links, every.obstacles, strict=True))}
    order = [places[minimum.link, minimum.obstacle] for minimum in minima]
    return PairCurves(middles, _rounded_down(least.T[order]))


def _rounded_down(values: np.ndarray) -> np.ndarray:
    """The greatest float32 numbers that are not above."""
    near = values.astype(np.float32)
    return np.where(near > values, np.nextafter(near, np.float32(-np.inf)), near)

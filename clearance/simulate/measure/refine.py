"""Refines the proof of intervals where a level is undecided: it lies between bound and occurring clearance.

The gap of such an interval is reduced to a thousandth, down to rounding, until the level is decided or the budget
of searches is used up. Not for: the first proof (`certify`).
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass

import numpy as np

from clearance.kernels.motion.certify import IntervalBounds
from clearance.kernels.motion.twist import CertificateGoal
from clearance.tolerance import SEEN_AT_LEVEL

FINER = 2.0**-10
"""The share of a gap to ask for next; the kernel itself refines to a thousandth of a gap at a level."""

MOST_PARTS = 2**17
"""Most parts of one interval and pair; then its gap is widened."""

MOST_QUERIES = 2**19
"""Most searches for one level: a few seconds."""

MOST_EXPECTED = 4 * MOST_QUERIES
"""Most expected searches of an interval that is at the level throughout. A part is as long as the root of its gap;
a quarter of the searches estimated from that was measured."""

LEAST_GAP = 1e-6
"""[m] How far the proof of the least clearance may lie below one that occurs."""

LEAST_PARTS, LEAST_QUERIES = 2**9, 2**11
"""The same two limits for that: some milliseconds. A motion that stays at its least distance may use them up."""

Prove = Callable[[int, np.ndarray, CertificateGoal], tuple[IntervalBounds, np.ndarray]]
"""Proves an interval, given the distance (2,) [m] that is asked about at its ends; bounds of it, and counters."""


@dataclass(frozen=True, eq=False)
class Refinement:
    """Proves intervals again for some levels.

    Attributes:
        prove: an interval. gap, finest: [m] what was allowed, and the least that rounding allows.
        rounding: [m] a distance that is less than a level by no more is at it.
    """

    prove: Prove
    gap: float
    finest: float
    rounding: float

    def decided(
        self, bounds: IntervalBounds, levels: Sequence[float]
    ) -> tuple[IntervalBounds, np.ndarray]:
        """The bounds, finer in the intervals by which a level [m] is open, and counters.

        A clearance measured below a level decides it. Contact is a level too, undecided while the bound is
        no more than rounding.
        """
        counts = np.zeros(4, dtype=np.int64)
        for level in sorted({0.0, *levels}):
            target = level - self.rounding if level > self.rounding else self.rounding
            if ((bounds.lower < target) & (bounds.upper >= target)).any():
                if not bounds.lower.flags.owndata:
                    bounds = IntervalBounds(*(np.array(column) for column in bounds))
                counts += self._decide(bounds, target, MOST_PARTS, MOST_QUERIES)
        return bounds, counts

    def raise_to(self, bounds: IntervalBounds, target: float) -> np.ndarray:
        """Makes bounds finer where they are below a target [m] just below the least clearance; counters."""
        return self._decide(bounds, target, LEAST_PARTS, LEAST_QUERIES)

    def _decide(
        self,
        bounds: IntervalBounds,
        target: float,
        most_parts: int,
        most_queries: int,
    ) -> np.ndarray:
        """Proves again, into `bounds`, the intervals not proven to have a clearance of `target` [m]; counters."""
        counts, gap = np.zeros(4, dtype=np.int64), self.gap
        expected = np.zeros(len(bounds.lower) - 1)  # searches until an interval is decided
        while True:
            aim = CertificateGoal(gap, target, most_parts)
            finer = max(gap * FINER, self.finest)
            last = finer if target <= self.rounding else self.finest  # contact may still be seen
            at_level = bounds.upper[:-1] - target <= (SEEN_AT_LEVEL + 1.0) * self.rounding
            is_open = (bounds.lower[:-1] < target) & (bounds.upper[:-1] >= target)
            is_open &= ~(at_level & (expected > MOST_EXPECTED))
            for step in np.flatnonzero(is_open).tolist():
                if counts[1] > most_queries:
                    return counts
                own = self._again(bounds, step, aim)
                expected[step] = own[1] * np.sqrt(gap / last)
                counts += own
            if gap <= self.finest or not is_open.any():
                return counts
            gap = finer

    def _again(self, bounds: IntervalBounds, step: int, aim: CertificateGoal) -> np.ndarray:
        own, counts = self.prove(step, np.full(2, bounds.upper[step]), aim)
        bounds.lower[step] = max(bounds.lower[step], own.lower[0])
        if own.share[0] >= 0.0 and own.upper[0] < bounds.upper[step]:
            bounds.upper[step], bounds.share[step] = own.upper[0], own.share[0]
            bounds.pair[step] = own.pair[0]
        return counts

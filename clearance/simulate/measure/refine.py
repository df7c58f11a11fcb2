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

LEAST_QUERIES = 2**11
"""Most searches for that, and most parts of one interval and pair: some milliseconds. A motion that stays at its
least distance may use them up."""

LEAST_RUN = 32
"""Most neighbouring intervals that are proven at once for that: what is far is asked about once."""

Prove = Callable[[int, np.ndarray, CertificateGoal], tuple[IntervalBounds, np.ndarray]]
"""Proves intervals from a step on, asked about distances (k + 1,) [m] at their ends: bounds, and counters."""


@dataclass(frozen=True, eq=False)
class Refinement:
    """Proves intervals again for some levels.

    Attributes:
        prove: neighbouring intervals. gap, finest: [m] what was allowed, and the least that rounding allows.
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
                counts += self._decide(bounds, target)
        return bounds, counts

    def raise_to(self, bounds: IntervalBounds, steps: np.ndarray, least: float) -> np.ndarray:
        """Makes bounds finer where they are more than `LEAST_GAP` below the least clearance; counters.

        Args:
            bounds: of the intervals after steps (k,). least: [m] seen so far; what is seen below it counts.
        """
        counts, gap = np.zeros(4, dtype=np.int64), max(LEAST_GAP, self.finest)
        aim = CertificateGoal(gap, 0.0, LEAST_QUERIES)
        for places in _runs(bounds.lower, steps):
            is_open = places[bounds.lower[places] < least - gap]
            if counts[1] > LEAST_QUERIES or least <= self.rounding:
                break
            if len(is_open):
                run = slice(int(is_open[0]), int(is_open[-1]) + 1)
                asked = np.full(run.stop - run.start + 1, least)
                counts += self._again(bounds, run, int(steps[run.start]), asked, aim)
                least = min(least, float(bounds.upper[run].min()))
        return counts

    def _decide(self, bounds: IntervalBounds, target: float) -> np.ndarray:
        """Proves again, into `bounds`, the intervals not proven to have a clearance of `target` [m]; counters."""
        counts, gap = np.zeros(4, dtype=np.int64), self.gap
        expected = np.zeros(len(bounds.lower) - 1)  # searches until an interval is decided
        while True:
            aim = CertificateGoal(gap, target, MOST_PARTS)
            finer = max(gap * FINER, self.finest)
            last = finer if target <= self.rounding else self.finest  # contact may still be seen
            at_level = bounds.upper[:-1] - target <= (SEEN_AT_LEVEL + 1.0) * self.rounding
            is_open = (bounds.lower[:-1] < target) & (bounds.upper[:-1] >= target)
            is_open &= ~(at_level & (expected > MOST_EXPECTED))
            for step in np.flatnonzero(is_open).tolist():
                if counts[1] > MOST_QUERIES:
                    return counts
                asked = np.full(2, bounds.upper[step])
                own = self._again(bounds, slice(step, step + 1), step, asked, aim)
                expected[step] = own[1] * np.sqrt(gap / last)
                counts += own
            if gap <= self.finest or not is_open.any():
                return counts
            gap = finer

    def _again(
        self, bounds: IntervalBounds, run: slice, step: int, asked: np.ndarray, aim: CertificateGoal
    ) -> np.ndarray:
        """Proves the intervals from a step on again, into a run of `bounds`; counters."""
        found, counts = self.prove(step, asked, aim)
        own = IntervalBounds(*(column[run] for column in bounds))
        np.maximum(own.lower, found.lower, out=own.lower)
        nearer = (found.share >= 0.0) & (found.upper < own.upper)
        for column, seen in zip(own[1:], found[1:], strict=True):
            column[nearer] = seen[nearer]
        return counts


def _runs(lower: np.ndarray, steps: np.ndarray) -> list[np.ndarray]:
    """The places of intervals with bounds (k,) in runs of neighbours, the least bound first, and alone."""
    begins = (np.diff(steps, prepend=-2) > 1) | (steps % LEAST_RUN == 0)
    runs = np.split(np.arange(len(steps)), np.flatnonzero(begins)[1:])
    return [np.array([lower.argmin()]), *sorted(runs, key=lambda run: lower[run].min())]

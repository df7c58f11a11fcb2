"""Occurrences: the stretches of a motion in which a pair is below a limit, so that noise makes no more of them.

A stretch begins where the pair is below the release level and ends where it is not; it counts if the pair is below
the fail limit in it. The release level is the warn limit, or `HYSTERESIS` above the fail limit where that is more:
a pair that flickers about its limit is one occurrence, and a pair that parts and comes back is two. Not for: which
pairs are near when (`simulate.answers.rule_pairs`).
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from functools import cached_property
from itertools import pairwise

import numpy as np

from clearance.world.case import Limits

HYSTERESIS = 0.001
"""[m] Least distance that a pair must gain on the fail limit for an occurrence to end."""


def release_level(limits: Limits) -> float:
    """[m] What a pair must reach for an occurrence to end."""
    return max(limits.warn, limits.fail + HYSTERESIS)


@dataclass(frozen=True, eq=False)
class NearCourse:
    """When a pair is below the release level, and how near.

    Positions count half steps: 2 i is step i, 2 i + 1 a moment between it and the next.

    Attributes:
        positions: (k,) increasing. clearances: (k,) [m]. touching: (k,).
        bridges: (m,) positions of steps at which the pair is not known to be above the release level.
    """

    positions: np.ndarray
    clearances: np.ndarray
    touching: np.ndarray
    bridges: np.ndarray

    def worst(self, rows: slice) -> int:
        """The first row of some that touches, or else of least clearance."""
        touching = np.flatnonzero(self.touching[rows])
        least = touching[0] if len(touching) else np.argmin(self.clearances[rows])
        return rows.start + int(least)

    @cached_property
    def stretches(self) -> tuple[slice, ...]:
        """The rows of each longest stretch without a break."""
        if not len(self.bridges):  # then what breaks a stretch stands between two rows of it
            ahead = np.diff(self.positions)
            from_step_to_step = (ahead == 2) & (self.positions[:-1] % 2 == 0)
            ends = np.flatnonzero((ahead > 1) & ~from_step_to_step) + 1
            return _between([0, *ends.tolist(), len(self.positions)])
        steps = np.union1d(self.positions[self.positions % 2 == 0], self.bridges)
        passed = steps[:-1][np.diff(steps) == 2] + 1  # between two steps at which it is near
        covered = np.unique(np.concatenate([self.positions, steps, passed]))
        group = np.cumsum(np.diff(covered, prepend=covered[:1]) > 1)
        own = group[np.searchsorted(covered, self.positions)]
        return _between([0, *(np.flatnonzero(np.diff(own)) + 1).tolist(), len(own)])

    @property
    def nearest_stretch(self) -> slice:
        """The rows of the stretch in which the pair is nearest."""
        worst = self.worst(slice(0, len(self.positions)))
        return next(rows for rows in self.stretches if rows.start <= worst < rows.stop)

    def broken(self, limits: Limits) -> list[slice]:
        """The rows of each stretch in which the pair is below the fail limit, or at 0."""
        below = limits.below(self.clearances, limits.fail)
        below |= (self.clearances <= 0.0) | self.touching
        if not below.any():
            return []
        return [rows for rows in self.stretches if below[rows].any()]


def _between(edges: Sequence[int]) -> tuple[slice, ...]:
    """The rows from each edge to the next."""
    return tuple(slice(*ends) for ends in pairwise(edges))

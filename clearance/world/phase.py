"""A stretch of a run in which nothing changes hands, comes, goes or jumps: a plain case and its motion."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass

import numpy as np

from clearance.world.carry import Carry
from clearance.world.case import Case
from clearance.world.motion import Motion


@dataclass(frozen=True, eq=False)
class Phase:
    """A stretch of a run in which nothing changes hands, comes, goes or jumps, and no window begins or ends.

    Attributes:
        first, last: the steps at its ends; they belong to it.
        case: the case as it is then; obstacles that move have a sample at each of its steps.
        motions: of its robots at its steps.
        carried: how each part that is carried is.
        absent_robots, absent_obstacles: which are not in the cell, and all that stands on them.
    """

    first: int
    last: int
    case: Case
    motions: tuple[Motion, ...]
    carried: Mapping[str, Carry]
    absent_robots: frozenset[int]
    absent_obstacles: frozenset[int]

    @property
    def times(self) -> np.ndarray:
        """(k,) [s] of its steps."""
        return self.motions[0].times

    @property
    def n_steps(self) -> int:
        """Number of its steps, both ends included."""
        return self.last - self.first + 1

    @property
    def span(self) -> tuple[float, float]:
        """[s] When it begins and ends."""
        return float(self.times[0]), float(self.times[-1])

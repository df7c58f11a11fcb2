"""What measuring a motion comes to: least clearances, one row a step. Not for: how it is measured (`measure`)."""

from __future__ import annotations

from dataclasses import dataclass
from typing import NamedTuple

import numpy as np

COUNTERS = ("pairs_skipped", "queries", "node_tests", "polygon_tests")

SWEEP_COUNTERS = (*COUNTERS, "steps_passed_over")
"""The last are steps at which no pose was made: all their pairs are skipped."""


class Minima(NamedTuple):
    """One row a pair: least clearance [m], the first step that has it, witness points in the world [m]."""

    clearance: np.ndarray
    step: np.ndarray
    points: np.ndarray  # (p, 2, 3)


@dataclass(frozen=True, eq=False)
class Measurement:
    """The least clearances of a motion, one row a step.

    Attributes:
        clearance: (n,) [m], NaN where only a bound was asked for.
        lower_bound: (n,) [m] proven for the step; equal to the clearance within rounding where that is known.
        pair: (n,) index of the pair that attains it, or -1.
        points: (n, 2, 3) witness points [m] in the world frame: on the link, on the obstacle.
        tally: counters by name.
        every: (n, p) [m] the clearance of each pair at each step, if that was asked for.
        may_cut_pairs: True if a pair can be left out by rules without proof (the paper's).
        touching: (n,) where the nearest bodies touch, if padding has lessened clearances; None without padding.
        times_b: (n,) [s] when the second body of the nearest pair is where it was met, if that is not the time of
            the step since their clocks are not tied; NaN where it is. None if all are tied.
    """

    clearance: np.ndarray
    lower_bound: np.ndarray
    pair: np.ndarray
    points: np.ndarray
    tally: dict[str, int]
    every: np.ndarray | None = None
    may_cut_pairs: bool = False
    touching: np.ndarray | None = None
    times_b: np.ndarray | None = None

    def touches(self, steps: slice) -> np.ndarray:
        """(k,) where the nearest bodies touch at some steps."""
        return self.clearance[steps] <= 0.0 if self.touching is None else self.touching[steps]

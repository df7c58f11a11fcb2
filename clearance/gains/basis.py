"""Smooth courses of offsets: uniform cubic B-splines over a table's times, with stretches where they are 0.

Source: de Boor 1978, by scipy's `BSpline`. Not for: what offsets do (`offsets`).
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from functools import cached_property

import numpy as np

DEGREE = 3

LEAST = 1e-9
"""[-] Values and slopes of splines below it are rounding."""


@dataclass(frozen=True, eq=False)
class Basis:
    """Splines on so many equal intervals of a table's times, those that reach into a window that is kept left out.

    Attributes:
        times: (n,) [s] of the table.
        fixed: (start, end) of its times [s] in which there is no offset, nor a speed of one.
    """

    times: np.ndarray
    n_intervals: int
    fixed: Sequence[tuple[float, float]]

    @cached_property
    def free(self) -> np.ndarray:
        """(m,) the splines that are 0 in all windows, with their speed, as places among all."""
        low, high = self._knots[: -DEGREE - 1], self._knots[DEGREE + 1 :]
        bound = np.zeros(len(low), dtype=bool)
        for start, end in self.fixed:
            bound |= (low < end) & (start < high)
            ends = np.clip([start, end], self.times[0], self.times[-1])
            for order in (0, 1):
                bound |= (np.abs(self._all_at(ends, order)) > LEAST).any(axis=0)
        return np.flatnonzero(~bound)

    def at(self, times: np.ndarray, order: int = 0) -> np.ndarray:
        """(k, m) the splines, or their derivative of an order [1/s], at times (k,) [s].

        Before the table's first time and after its last they are what they are there.
        """
        clipped = np.clip(times, self.times[0], self.times[-1])
        return self._all_at(clipped, order)[:, self.free]

    def _all_at(self, times: np.ndarray, order: int) -> np.ndarray:
        from scipy.interpolate import BSpline

        n_all = len(self._knots) - DEGREE - 1
        return np.asarray(BSpline(self._knots, np.eye(n_all), DEGREE)(times, nu=order))

    @cached_property
    def _knots(self) -> np.ndarray:
        ends = np.linspace(self.times[0], self.times[-1], self.n_intervals + 1)
        before, after = np.full(DEGREE, ends[0]), np.full(DEGREE, ends[-1])
        return np.concatenate([before, ends, after])

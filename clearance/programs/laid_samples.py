"""Samples of legs, laid one after another, and what becomes of velocities that jump between.

They jump where a tool takes on the speed of a conveyor, or loses it. A trajectory has one velocity a sample.
About a jump by d at T the joints go on the parabola that touches both sides at T - h and T + h. It is off them by
h d / 4 at most. A small jump takes its mean, if cubics are not farther off for it. Not for: what makes velocities
jump (`carriage`).
"""

from __future__ import annotations

from collections.abc import Iterable
from typing import NamedTuple

import numpy as np

from clearance.errors import BadDimension
from clearance.programs.carriage import AT_KNOT, Carriage
from clearance.programs.path_samples import SAME_SPEED
from clearance.world.cubic import Cubics, position_on, velocity_on

SLOPE = 4.0 / 27.0
"""How far a cubic is moved by its slope at one end, at most: the greatest s (1 - s)^2. Half a jump at both ends
comes to that."""


class JumpingSamples(NamedTuple):
    """Samples, and velocities as joints come to them and as they leave them.

    Attributes:
        times: (n,) [s]. positions, come, leave: (n, k) [rad or m], and per second.
    """

    times: np.ndarray
    positions: np.ndarray
    come: np.ndarray
    leave: np.ndarray

    @property
    def jumps(self) -> np.ndarray:
        """The places of samples at which a velocity jumps."""
        return np.flatnonzero((self.come != self.leave).any(axis=1))

    def without_jumps(self, most: float) -> tuple[np.ndarray, np.ndarray, np.ndarray, float]:
        """Times, positions and velocities without jumps but at both ends, and how far joints are off, at most.

        Args:
            most: [rad or m] that they may be off.
        """
        velocities = np.concatenate([self.leave[:1], self.come[1:]])
        inside = self.jumps[(self.jumps > 0) & (self.jumps < len(self.times) - 1)]
        lengths, by = np.diff(self.times), self.leave[inside] - self.come[inside]
        by_mean = np.abs(by).max(axis=1, initial=0.0) * SLOPE
        by_mean *= np.maximum(lengths[inside - 1], lengths[inside])
        small = by_mean <= most
        velocities[inside] += 0.5 * by
        i, by, least = inside[~small], by[~small], float(by_mean[small].max(initial=0.0))
        if not len(i):
            return self.times, self.positions, velocities, least
        room = 0.45 * np.minimum(lengths[i - 1], lengths[i])
        half = np.minimum(room, 4.0 * most / np.abs(by).max(axis=1))
        before = self._beside(i - 1, 1.0 - half / lengths[i - 1])
        after = self._beside(i, half / lengths[i])
        positions, off = self.positions.copy(), 0.25 * half[:, None] * by
        positions[i] += off
        times = np.concatenate([self.times, self.times[i] - half, self.times[i] + half])
        order = np.argsort(times, kind="stable")
        positions = np.concatenate([positions, before[0], after[0]])[order]
        velocities = np.concatenate([velocities, before[1], after[1]])[order]
        return times[order], positions, velocities, least + float(np.abs(off).max())

    def _beside(self, i: np.ndarray, share: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
        """(m, k) positions and velocities at shares (m,) of intervals (m,)."""
        lengths = (self.times[i + 1] - self.times[i])[:, None]
        start, step = self.positions[i], self.positions[i + 1] - self.positions[i]
        cubics = Cubics(
            start, step, lengths * self.leave[i] - step, lengths * self.come[i + 1] - step
        )
        shares = share[:, None]
        return position_on(cubics, shares), velocity_on(cubics, shares) / lengths


MOST_SAMPLES = 1_000_000
"""Most samples of a program: a step in the wrong unit needs more."""


class LaidSamples:
    """Samples of legs, one after another, from rest at joints (k,) at 0 s.

    Attributes:
        now: [s] the time of the last.
    """

    def __init__(self, start: np.ndarray) -> None:
        rest = np.zeros((1, len(start)))
        self.now, self._n = 0.0, 1
        self.times, self.positions = [np.zeros(1)], [start[None]]
        self._come, self._leave = [rest], [rest.copy()]

    @property
    def rates(self) -> np.ndarray:
        """(k,) how fast the joints come to the last."""
        return np.asarray(self._come[-1][-1])

    def add(
        self,
        times: np.ndarray,
        positions: np.ndarray,
        come: np.ndarray,
        leave: np.ndarray,
        may_jump: bool,
    ) -> None:
        """Adds samples (n,) and (n, k), the first of which is the last so far.

        Args:
            come, leave: velocities as joints come there and go on. may_jump: from the first they may go on
                otherwise than they came to it, by more than rounding.

        Raises:
            BadDimension: there are too many.
        """
        jumps = may_jump and np.abs(leave[0] - self.rates).max() > SAME_SPEED
        self._leave[-1][-1] = leave[0] if jumps else self.rates
        self.times.append(self.now + times[1:])
        self.positions.append(positions[1:])
        self._come.append(come[1:])
        self._leave.append(leave[1:].copy())
        self.now += float(times[-1])
        self._n += len(times) - 1
        if self._n > MOST_SAMPLES:
            raise BadDimension(
                f"more than {MOST_SAMPLES:,} samples", where="step", valid="write a larger step"
            )

    def end_at(self, joints: np.ndarray, at_rest: bool) -> None:
        """Puts the last where a move says (k,), but for rounding."""
        self.positions[-1][-1] = joints
        if at_rest:
            self._come[-1][-1] = self._leave[-1][-1] = 0.0

    def joined(self, carriages: Iterable[Carriage]) -> JumpingSamples:
        """All of them, at rest after the last; at the very times of knots that they are at but for rounding."""
        times = np.concatenate(self.times)
        for one in carriages:
            i = np.minimum(np.searchsorted(one.knots, times - AT_KNOT), len(one.knots) - 1)
            near = one.knots[i]
            times = np.where(np.abs(near - times) < AT_KNOT, near, times)
        self._leave[-1][-1] = 0.0
        rows = self.positions, self._come, self._leave
        return JumpingSamples(times, *(np.concatenate(one) for one in rows))

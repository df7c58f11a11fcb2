"""A table of samples laid out over a run: before its first sample, after its last, and round again where it loops.

Between two knots a value goes straight, on a cubic where velocities are given, and a rotation turns about one
axis at constant speed. A knot has a value on either side, since a table that loops may jump.
"""

from __future__ import annotations

import math
from dataclasses import dataclass
from functools import cached_property, partial

import numpy as np

from clearance.errors import BadTime
from clearance.world.cubic import Cubics, position_on, velocity_on
from clearance.world.motion import Motion
from clearance.world.pose_table import PoseTable
from clearance.world.slerp import slerp

MOST_ROUNDS = 100_000
"""Times that a table may be gone through: a period in the wrong unit would fill the memory."""


@dataclass(frozen=True, eq=False)
class Knots:
    """Values over a run's time; they stay before the first knot and after the last.

    Attributes:
        times: (k,) [s]. before, after: (k, c) the values just before a knot and just after it.
        rates_before, rates_after: (k, c) the same of velocities; None where values go straight.
        n_rotation: how many of the last columns are a quaternion: 0 or 4.
    """

    times: np.ndarray
    before: np.ndarray
    after: np.ndarray
    rates_before: np.ndarray | None = None
    rates_after: np.ndarray | None = None
    n_rotation: int = 0

    @cached_property
    def jumps(self) -> np.ndarray:
        """The times [s] at which a value or a velocity changes at once."""
        if self.before is self.after and self.rates_before is self.rates_after:
            return self.times[:0]
        at_once = (self.before != self.after).any(axis=1)
        if self.rates_before is not None and self.rates_after is not None:
            at_once |= (self.rates_before != self.rates_after).any(axis=1)
        return self.times[at_once]

    def values_at(self, times: np.ndarray) -> np.ndarray:
        """(n, c) the values over a stretch that jumps at its ends only: after the first knot, before the last."""
        if len(times) == len(self.times) and np.array_equal(times, self.times):
            if np.array_equal(self.before[1:], self.after[1:]):
                return self.after
        places, share = self._places(times)
        found = self._between(places, share)
        if _is_come_to(times):
            found[-1] = self._come_to(times[-1])
        return found

    def rates_at(self, times: np.ndarray) -> np.ndarray | None:
        """(n, c) the velocities likewise."""
        if self.rates_before is None or self.rates_after is None:
            return None
        places, share = self._places(times)
        found = self.rates_after[places]
        inside = (share > 0.0) & (share < 1.0)
        if inside.any():
            length = np.diff(self.times)[places[inside], None]
            cubics = self._cubics(places[inside])
            found[inside] = velocity_on(cubics, share[inside, None]) / length
        found[(times < self.times[0]) | (times > self.times[-1])] = 0.0
        if _is_come_to(times) and times[-1] in self.times:
            found[-1] = self.rates_before[np.searchsorted(self.times, times[-1])]
        return found

    def _places(self, times: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
        """(n,) the knot before each time, and the share (0 to 1) of the interval to the next."""
        places = np.clip(
            np.searchsorted(self.times, times, side="right") - 1, 0, len(self.times) - 1
        )
        ahead = np.minimum(places + 1, len(self.times) - 1)
        length = self.times[ahead] - self.times[places]
        gone = np.clip(times - self.times[places], 0.0, length)
        share = np.divide(gone, length, out=np.zeros(len(times)), where=length > 0.0)
        return places, share

    def _between(self, places: np.ndarray, share: np.ndarray) -> np.ndarray:
        found = self.after[places]
        inside = np.flatnonzero(share > 0.0)
        places, share = places[inside], share[inside, None]
        if not len(inside):
            return found
        if self.rates_before is not None:
            found[inside] = position_on(self._cubics(places), share)
            return found
        start, end = self.after[places], self.before[places + 1]
        found[inside] = start + share * (end - start)
        if self.n_rotation:
            turned = slice(-self.n_rotation, None)
            found[inside, turned] = slerp(start[:, turned], end[:, turned], share[:, 0])
        return found

    def _cubics(self, places: np.ndarray) -> Cubics:
        """The cubics from some knots to the next."""
        assert self.rates_before is not None
        assert self.rates_after is not None
        length = (self.times[places + 1] - self.times[places])[:, None]
        start, step = self.after[places], self.before[places + 1] - self.after[places]
        e0 = length * self.rates_after[places] - step
        return Cubics(start, step, e0, length * self.rates_before[places + 1] - step)

    def _come_to(self, time: float) -> np.ndarray:
        """(c,) the value at the end of a stretch."""
        place = int(np.searchsorted(self.times, time))
        if place < len(self.times) and self.times[place] == time:
            return self.before[place]
        return self._between(*self._places(np.array([time])))[0]


def knots_of(
    times: np.ndarray,
    values: np.ndarray,
    rates: np.ndarray | None = None,
    *,
    n_rotation: int = 0,
) -> Knots:
    """The knots of a table that is gone through once.

    Args:
        times: (k,) [s] of the run. values, rates: (k, c). n_rotation: as in `Knots`.
    """
    if rates is None:
        return Knots(times, values, values, n_rotation=n_rotation)
    arriving, leaving = rates.copy(), rates.copy()
    arriving[0] = leaving[-1] = 0.0  # it stands before and after
    return Knots(times, values, values, arriving, leaving, n_rotation)


def knots_of_motion(motion: Motion) -> Knots:
    """The knots of all joints of a robot, in the run's time."""
    timing, rates = motion.placed.timing, motion.velocities
    if rates is not None and timing.rate != 1.0:
        rates = rates * timing.rate
    return knots_of(timing.run_times(motion.times), motion.positions, rates)


def knots_of_poses(table: PoseTable) -> Knots:
    """The knots of a table of poses, in the run's time."""
    return knots_of(table.timing.run_times(table.times), table.columns, n_rotation=4)


def looped(once: Knots, end: float) -> Knots:
    """The knots of a table that begins again until `end` [s].

    Raises:
        BadTime: more rounds than `MOST_ROUNDS`.
    """
    period = once.times[-1] - once.times[0]
    n_rounds = max(1, math.ceil((end - once.times[0]) / period))
    if n_rounds > MOST_ROUNDS:
        raise BadTime(
            f"a table of {period:g} s loops {n_rounds} times", valid=f"{MOST_ROUNDS} times or less"
        )
    start = [once.times[:-1] + i * period for i in range(n_rounds)]
    times = np.concatenate([*start, [once.times[0] + n_rounds * period]])
    rounds = partial(_rounds, n_rounds)
    values = rounds(once.before, once.before[-1]), rounds(once.after, once.after[0])
    if once.rates_before is None or once.rates_after is None:
        return Knots(times, *values, n_rotation=once.n_rotation)
    come = rounds(once.rates_before, once.rates_before[-1])
    return Knots(
        times, *values, come, rounds(once.rates_after, once.rates_after[0]), once.n_rotation
    )


def _rounds(n_rounds: int, rows: np.ndarray, at_wrap: np.ndarray) -> np.ndarray:
    """The rows of all rounds: the last of one round is the first of the next, and is `at_wrap` there."""
    again = rows[:-1].copy()
    again[0] = at_wrap
    found = np.concatenate([*[again] * n_rounds, at_wrap[None]])
    found[0] = rows[0]
    return found


def _is_come_to(times: np.ndarray) -> bool:
    """True where the last of several times is the end of a stretch, not also its start."""
    return len(times) > 1

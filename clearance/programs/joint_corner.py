"""The corner zone between two moves of which one is a joint move, and how far its admissible paths take links.

Admissible is every path of the joints in the triangle of where they are at entry, corner and exit, which each
joint may leave by as much as a line or an arc beside the zone does:

    q = E + a d1 + b d2 + w,   0 <= b <= a <= 1,   |w| <= wide.

The nominal motion is the cubic that begins and ends as the neighbours do. A path's q with a + b = 2u is held
against it at u. The parabola with a = 2u - u^2 and b = u^2 is off the cubic by a cubic that is 0 at both ends, and
q off the parabola by s (d1 - d2) + w, |s| <= 1/4. Not for: zones between lines and arcs (`corner`).
"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from clearance.programs.arm import Arm
from clearance.programs.enclosure import Intervals, cubic_series
from clearance.programs.links_off import Cells, links_off
from clearance.programs.path_samples import PathSamples
from clearance.world.cubic import cubics_of, position_on, velocity_on
from clearance.world.trajectory import Deviation

FINEST = 0.02
"""[rad] or [m]: joints of one cell are no farther apart, if `MOST_CELLS` allow it."""

MOST_CELLS = 64


class JointCorner(NamedTuple):
    """The joints of a corner zone.

    Attributes:
        entry, corner, exit: (k,) [rad or m]. rates: (2, k) at entry and exit [1/s]. wide: (k,) [rad or m].
        duration: [s].
    """

    entry: np.ndarray
    corner: np.ndarray
    exit: np.ndarray
    rates: np.ndarray
    wide: np.ndarray
    duration: float

    def samples(self, n: int) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
        """Times (n + 1,) [s], positions and velocities (n + 1, k) of the nominal motion."""
        shares, ends = np.linspace(0.0, 1.0, n + 1), np.array([0.0, self.duration])
        cubic = cubics_of(ends, np.stack([self.entry, self.exit]), self.rates)
        positions = position_on(cubic, shares[:, None])
        positions[-1] = self.exit
        rates = velocity_on(cubic, shares[:, None]) / self.duration
        return self.duration * shares, positions, rates

    def links_off(self, arm: Arm, n: int) -> dict[str, Deviation]:
        """How far each link may be off, from the nominal motion in n intervals."""
        times, positions, rates = self.samples(n)
        ways = self.corner - self.entry, self.exit - self.corner
        across = ways[0] - ways[1]
        ends = np.array([2.0 * ways[0], 2.0 * ways[1]]) - self.duration * self.rates
        off = 0.25 * np.abs(ends).max(axis=0)
        count = int(np.clip(np.ceil(np.abs(across).max() / FINEST), 1, MOST_CELLS))
        given = Intervals(
            np.diff(times),
            positions[:-1],
            positions[1:],
            np.stack([rates[:-1], rates[1:]]),
            np.zeros((3, n, 2)),
        )
        series = cubic_series(given, 0.5 * given.lengths[:, None])
        i, cell = (one.ravel() for one in np.indices((n, count)))
        shifts = (0.5 * (cell[:, None] + 0.5) / count - 0.25) * across
        box = np.tile(0.25 / count * np.abs(across) + self.wide + off, (len(i), 1))
        within = np.abs(series[1:]).sum(axis=0)
        return links_off(arm, Cells(series[0][i] + shifts, shifts, within[i], box))


def bow(samples: PathSamples) -> np.ndarray:
    """(k,) [rad or m] how far the joints along a line or an arc are, at most, off straight ones from end to end.

    A cubic is in the convex hull of its control points (Bezier).
    """
    given, third = samples.intervals, samples.intervals.lengths[:, None] / 3.0
    points = np.concatenate(
        [
            given.before,
            given.before + third * given.rates[0],
            given.after - third * given.rates[1],
            given.after,
        ]
    )
    start, way = samples.positions[0], samples.positions[-1] - samples.positions[0]
    shares = np.clip((points - start) @ way / max(float(way @ way), 1e-300), 0.0, 1.0)
    off = np.abs(points - start - shares[:, None] * way).max(axis=0)
    return np.asarray(off + samples.deviations.max(axis=0))

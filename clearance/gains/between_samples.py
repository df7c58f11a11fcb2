"""What is between the samples of a table: lines or, where it has velocities, cubics. Not for: runs
(`world.knots`).
"""

from __future__ import annotations

import numpy as np

from clearance.world.cubic import Cubics, position_on, velocity_on
from clearance.world.trajectory import Trajectory


def values_between(
    asked: Trajectory, times: np.ndarray, at_samples: np.ndarray, rates: np.ndarray | None
) -> np.ndarray:
    """(k, m) what comes of values at the samples of a table, between them as the table's joints go.

    Args:
        times: (k,) [s] of the table; before its first and after its last it is as it is there.
        at_samples: (n, m). rates: (n, m) a second, where the table has velocities.
    """
    row, length, share = _places(asked, times)
    cubics = _cubics(row, length, at_samples, rates)
    if cubics is None:
        return np.asarray(at_samples[row] + share * (at_samples[row + 1] - at_samples[row]))
    return np.asarray(position_on(cubics, share))


def rates_between(asked: Trajectory, times: np.ndarray) -> np.ndarray:
    """(k, joints) the velocities of a table with velocities at times (k,) [s] of it."""
    row, length, share = _places(asked, times)
    cubics = _cubics(row, length, asked.positions, asked.velocities)
    assert cubics is not None
    return np.asarray(velocity_on(cubics, share) / length)


def _places(asked: Trajectory, times: np.ndarray) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """(k,) the sample before each time, (k, 1) the length of its interval [s], and the share of it that has
    passed.
    """
    clipped = np.clip(times, asked.times[0], asked.times[-1])
    row = np.clip(np.searchsorted(asked.times, clipped, side="right") - 1, 0, asked.n_steps - 2)
    length = (asked.times[row + 1] - asked.times[row])[:, None]
    return row, length, (clipped - asked.times[row])[:, None] / length


def _cubics(
    row: np.ndarray, length: np.ndarray, at_samples: np.ndarray, rates: np.ndarray | None
) -> Cubics | None:
    if rates is None:
        return None
    step = at_samples[row + 1] - at_samples[row]
    ends = length[..., None] * rates[np.stack([row, row + 1], axis=1)]
    return Cubics(at_samples[row], step, ends[:, 0] - step, ends[:, 1] - step)

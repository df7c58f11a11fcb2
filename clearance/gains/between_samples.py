"""What is between the samples of a table: lines or, where it has velocities, cubics. Not for: runs
(`world.knots`).
"""

from __future__ import annotations

import numpy as np

from clearance.world.cubic import Cubics, position_on
from clearance.world.trajectory import Trajectory


def values_between(
    asked: Trajectory, times: np.ndarray, at_samples: np.ndarray, rates: np.ndarray | None
) -> np.ndarray:
    """(k, m) what comes of values at the samples of a table, between them as the table's joints go.

    Args:
        times: (k,) [s] of the table; before its first and after its last it is as it is there.
        at_samples: (n, m). rates: (n, m) a second, where the table has velocities.
    """
    held = np.clip(times, asked.times[0], asked.times[-1])
    row = np.clip(np.searchsorted(asked.times, held, side="right") - 1, 0, asked.n_steps - 2)
    length = (asked.times[row + 1] - asked.times[row])[:, None]
    share = (held - asked.times[row])[:, None] / length
    step = at_samples[row + 1] - at_samples[row]
    if rates is None:
        return np.asarray(at_samples[row] + share * step)
    ends = length[..., None] * rates[np.stack([row, row + 1], axis=1)]
    cubics = Cubics(at_samples[row], step, ends[:, 0] - step, ends[:, 1] - step)
    return np.asarray(position_on(cubics, share))

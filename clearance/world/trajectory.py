"""What a robot is asked to do: joint positions over time."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np


@dataclass(frozen=True, eq=False)
class Trajectory:
    """Samples of joint positions; between samples the joints move linearly.

    Attributes:
        times: (n,) [s], strictly increasing.
        joint_names: (k,) of the robot's moving joints, in column order.
        positions: (n, k) [rad] or [m].
    """

    times: np.ndarray
    joint_names: tuple[str, ...]
    positions: np.ndarray

    @property
    def n_steps(self) -> int:
        """Number of samples."""
        return len(self.times)

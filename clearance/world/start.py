"""Adds a start at 0 s to a trajectory. Not for: reading the start from a file (`formats`)."""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from clearance.world.quintic import with_accelerations
from clearance.world.trajectory import Points, Trajectory


def started(
    asked: Trajectory, positions: np.ndarray, velocities: np.ndarray | None = None
) -> Trajectory:
    """The trajectory with a sample at 0 s added; joints go to its first sample as between samples.

    Args:
        positions: (k,) [rad] or [m]. velocities: (k,) where it has some; at rest if not given.

    Raises:
        BadTime: it begins at 0 s or before.
    """
    own, at_rest = asked.written, np.zeros_like(positions)
    rates = own.velocities
    if rates is not None:
        rates = np.vstack([at_rest if velocities is None else velocities, rates])
    times = np.concatenate(([0.0], own.times))
    made = replace(
        asked, times=times, positions=np.vstack([positions, own.positions]), velocities=rates,
        path_error=0.0, points=None, has_way_in=False, start_off="",
        starts_before_file=True,
    )  # fmt: skip
    if not isinstance(own, Points):
        return made
    return with_accelerations(made, np.vstack([at_rest, own.accelerations]))

"""More steps of a run, without another motion: samples between those of a table, on its lines or cubics.

Where bodies meet between two steps at which they are far apart, only a moment between tells what parts them. Not
for: which moments are needed (`shortfalls`).
"""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from clearance.gains.between_samples import rates_between, values_between
from clearance.world.case import Case, PlacedRobot


def with_moments(case: Case, moments: np.ndarray) -> Case:
    """The case with steps at some times (k,) [s of the run] too, as far as the path of a robot reaches.

    Exactness: the new samples lie on the old lines and cubics within rounding.
    """
    if not len(moments):
        return case
    robots = list(case.robots)
    for i, placed in enumerate(robots):
        if (
            placed.trajectory is None
            or placed.given_trajectory.n_steps < 2
            or placed.timing.after == "loop"
        ):
            continue
        start, end = placed.timing.run_times(placed.given_trajectory.times)[[0, -1]]
        own = moments[(moments > start) & (moments < end)]
        robots[i] = _with_samples(placed, (own - placed.timing.start) * placed.timing.rate)
        moments = np.setdiff1d(moments, own)
    return replace(case, robots=tuple(robots))


def _with_samples(placed: PlacedRobot, times: np.ndarray) -> PlacedRobot:
    """The robot with samples at some more times of its table [s]."""
    asked = placed.given_trajectory
    more = np.setdiff1d(times, asked.times)
    order = np.argsort(np.concatenate([asked.times, more]), kind="stable")
    at = values_between(asked, more, asked.positions, asked.velocities)
    velocities = None
    if asked.velocities is not None:
        rates = rates_between(asked, more)
        velocities = np.concatenate([asked.velocities, rates])[order]
    finer = replace(
        asked,
        times=np.concatenate([asked.times, more])[order],
        positions=np.concatenate([asked.positions, at])[order],
        velocities=velocities,
    )
    return replace(placed, trajectory=finer)

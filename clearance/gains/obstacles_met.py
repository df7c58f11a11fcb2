"""Obstacles that a change of place puts into each other: no run measures them against each other.

Not for: pairs that a run measures, whose rules the search keeps.
"""

from __future__ import annotations

from collections.abc import Iterator

import numpy as np

from clearance.record.record import Record
from clearance.simulate.answers.handling import gap_between
from clearance.world.forest import link_poses_at
from clearance.world.pairs import OBSTACLE, BodyIndex


def obstacles_met(before: Record, after: Record) -> Iterator[tuple[str, str]]:
    """The names of two obstacles that touch at the first step after the change, and did not before it.

    The one that the change moves comes first.
    """
    old, new = (_poses(record) for record in (before, after))
    moved = [not np.array_equal(*poses) for poses in zip(old, new, strict=True)]
    shapes = [obstacle.body.shape for obstacle in after.case.obstacles]
    names = [obstacle.name for obstacle in after.case.obstacles]
    for i in np.flatnonzero(moved):
        for k in np.flatnonzero(~np.array(moved)):
            gaps = (gap_between(shapes[i], at[i], shapes[k], at[k]) for at in (new, old))
            if next(gaps) <= 0.0 < next(gaps):
                yield names[i], names[k]


def _poses(record: Record) -> list[np.ndarray]:
    """(4, 4) `world_from_body` [m] of each obstacle at the first step."""
    phase = record.timeline.phases[0]
    links = link_poses_at(phase.case, phase.motions, slice(0, 1))
    bodies = [BodyIndex(OBSTACLE, i) for i in range(len(phase.case.obstacles))]
    return [body.poses_in(phase.case, links)[0] for body in bodies]

"""The bodies that a profile is swept by: links of the robots with their motions, and obstacles that stand.

Not for: sweeping them (`sweep`).
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Protocol

import numpy as np

from clearance.errors import UnknownLink, UnknownObstacle, nearest_name
from clearance.profiles.chords import Knots, knots_of, standing
from clearance.profiles.plane import Plane
from clearance.simulate.record import Samples
from clearance.world.body import Body
from clearance.world.case import Case
from clearance.world.motion import Motion, kinematic_motion


@dataclass(frozen=True, eq=False)
class MovingBody:
    """A body of one of the motions, or one that stands at a pose."""

    label: str
    body: Body
    motion: Motion | None
    pose: np.ndarray | None = None

    @property
    def n_steps(self) -> int:
        return 1 if self.motion is None else self.motion.n_steps

    def knots(self, plane: Plane, limit: float, *, solid: bool) -> Knots:
        """The instants at which it is looked at."""
        if self.motion is None:
            assert self.pose is not None, "what has no motion stands at a pose"
            return standing(self.pose)
        return knots_of(self.motion, self.body, plane, limit, solid=solid)


class RecordHolder(Protocol):
    """What has a record, as a run."""

    @property
    def record(self) -> Samples: ...


def motions_of(run: Case | Samples | RecordHolder) -> tuple[str, tuple[Motion, ...]]:
    if isinstance(run, Case):
        return run.name, tuple(kinematic_motion(placed) for placed in run.robots)
    record = run if isinstance(run, Samples) else run.record
    return record.case.name, record.motions


def chosen_links(motions: Sequence[Motion], links: Sequence[str] | None) -> list[MovingBody]:
    several = len(motions) > 1
    found = [
        MovingBody(
            f"{motion.placed.robot.name}/{body.name}" if several else body.name, body, motion
        )
        for motion in motions
        for body in motion.placed.robot.bodies
    ]
    if links is None:
        return found
    known = {one.label: one for one in found}
    for label in links:
        if label not in known:
            raise UnknownLink(
                f"unknown link {label!r}", where="links", valid=nearest_name(label, known)
            )
    return [one for one in found if one.label in set(links)]


def standing_obstacles(
    run: Case | Samples | RecordHolder, names: Sequence[str]
) -> list[MovingBody]:
    if isinstance(run, Case):
        case = run
    else:
        case = run.case if isinstance(run, Samples) else run.record.case
    known = {obstacle.name: obstacle for obstacle in case.obstacles}
    for name in names:
        if name not in known:
            raise UnknownObstacle(
                f"unknown obstacle {name!r}", where="obstacles", valid=nearest_name(name, known)
            )
    return [MovingBody(name, known[name].body, None, known[name].world_from_body) for name in names]

"""A case at one time of its run, and what of a case only its run decides. Not for: the whole run (`timeline`)."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import replace

import numpy as np

from clearance.errors import BadTime
from clearance.world.body import Obstacle
from clearance.world.case import Case
from clearance.world.knots import knots_of
from clearance.world.motion import kinematic_motion
from clearance.world.phase import Phase
from clearance.world.pose_table import PoseTable
from clearance.world.timeline import timeline_of
from clearance.world.timing import time_text


def phase_at(case: Case, time: float) -> Phase:
    """The phase of a run at a time [s], with obstacles where they are then; where two phases meet, the later one.

    Raises:
        BadTime: a time outside the run. NoTrajectory: nothing moves.
    """
    timeline = timeline_of(case, [kinematic_motion(placed) for placed in case.robots])
    start, end = timeline.times[[0, -1]].tolist()
    if not start <= time <= end:
        raise BadTime(
            f"{time_text(time)} s is outside the run",
            valid=f"a time from {time_text(start)} s to {time_text(end)} s",
        )
    phase = [one for one in timeline.phases if one.span[0] <= time][-1]
    obstacles = tuple(_obstacle_at(one, time) for one in phase.case.obstacles)
    return replace(phase, case=replace(phase.case, obstacles=obstacles))


def _obstacle_at(obstacle: Obstacle, time: float) -> Obstacle:
    if obstacle.moves is None:
        return obstacle
    table = obstacle.moves
    values = knots_of(table.times, table.columns, n_rotation=4).values_at(np.array([time]))
    return replace(obstacle, moves=PoseTable(np.array([time]), values[:, :3], values[:, 3:]))


def time_dependent_parts(case: Case) -> Iterator[str]:
    """What of a case is otherwise at other times of its run, in words: where it is taken to be without a time."""
    for name in dict.fromkeys(carry.part for carry in case.carries):
        yield f"part {name!r} is carried, and is measured where it lies before"
    for one in case.obstacles:
        if one.moves is not None:
            yield f"obstacle {one.name!r} moves, and is measured where its table begins"
    for i, row in enumerate(case.allow):
        if row.window.ends or row.while_carried:
            yield f"allow[{i}] holds for a time, and excuses nothing"
    for robot in case.robots:
        n_zones = 0 if robot.trajectory is None else len(robot.trajectory.corners)
        if n_zones:
            zones = f"corner zones of robot {robot.robot.name!r}"
            yield f"{zones} pad its links while they are passed, and are not counted"
    tables = [(f"robot {one.robot.name!r}", one.timing) for one in case.robots]
    tables += [(f"obstacle {o.name!r}", o.moves.timing) for o in case.obstacles if o.moves]
    for name, timing in tables:
        if timing.after == "absent":
            yield f"{name} comes and goes, and is measured"

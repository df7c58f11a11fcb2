"""What moves in a case, in the summary: actors, who carries what and when, who is not there, clock and paddings.

Not for: how that looks on the page (`cell_time`).
"""

from __future__ import annotations

import math
from collections.abc import Iterator
from typing import Any

from clearance.record.record import Record
from clearance.world.case import PlacedRobot
from clearance.world.mount import Mount
from clearance.world.timing import Timing
from clearance.world.trajectory import Trajectory

STRAIGHT = "straight, turning about one axis at constant speed"
"""How what follows a table of poses moves between its samples."""


def actors_of(record: Record) -> list[dict[str, Any]]:
    """All robots, and the obstacles that move, ride or are carried at some time."""
    case = record.case
    found = [
        _robot(placed) | {"absent": absent}
        for placed, absent in zip(case.robots, absences(record)[0], strict=True)
    ]
    carried = {carry.part for carry in case.carries}
    for obstacle, absent in zip(case.obstacles, absences(record)[1], strict=True):
        if obstacle.stands and obstacle.name not in carried:
            continue
        kind = "part" if obstacle.name in carried else "obstacle"
        told = {"name": obstacle.name, "kind": kind, "on": _on(obstacle.mount), "absent": absent}
        between = None if obstacle.moves is None else STRAIGHT
        timing = None if obstacle.moves is None else obstacle.moves.timing
        found.append(told | {"between_samples": between, "timing": _timing(timing)})
    return found


def _robot(placed: PlacedRobot) -> dict[str, Any]:
    trajectory = placed.trajectory
    return {
        "name": placed.robot.name,
        "kind": "robot",
        "on": _on(placed.mount),
        "self_clearance": placed.self_clearance is not None,
        "between_samples": None if trajectory is None else _law(trajectory),
        "timing": None if trajectory is None else _timing(placed.timing),
    }


def _law(trajectory: Trajectory) -> str:
    if trajectory.path_error:
        return "quintic"
    return "linear" if trajectory.velocities is None else "cubic"


def _on(mount: Mount | None) -> str | None:
    return None if mount is None else mount.on


def _timing(timing: Timing | None) -> dict[str, Any] | None:
    if timing is None:
        return None
    return {"start": timing.start, "rate": timing.rate, "after": timing.after}


def absences(record: Record) -> tuple[list[list[list[float]]], list[list[list[float]]]]:
    """For each robot, and for each obstacle, the stretches [s] in which it is not in the cell."""
    robots: list[list[list[float]]] = [[] for _ in record.case.robots]
    obstacles: list[list[list[float]]] = [[] for _ in record.case.obstacles]
    for phase in record.timeline.phases:
        for i in phase.absent_robots:
            _lengthen(robots[i], phase.span)
        for i in phase.absent_obstacles:
            _lengthen(obstacles[i], phase.span)
    return robots, obstacles


def _lengthen(spans: list[list[float]], span: tuple[float, float]) -> None:
    if spans and spans[-1][1] == span[0]:
        spans[-1][1] = span[1]
    else:
        spans.append([*span])


def carried_of(record: Record) -> list[dict[str, Any]]:
    """Who carries what, from when until when [s], in order of time; an end of the run is an end."""
    times, case = record.timeline.times, record.case
    found = [
        {
            "part": carry.part,
            "by": carry.by,
            "from": max(carry.window.start, float(times[0])),
            "until": min(carry.window.end, float(times[-1])),
            "touch": list(carry.touch),
            "grasp": "exact" if carry.exact_grasp else "as driven",
        }
        for carry in case.carries
    ]
    return sorted(found, key=lambda row: (row["from"], row["part"]))


def paddings_of(record: Record) -> dict[str, float]:
    """[m] By how much clearances of a body are lessened; bodies without padding are left out."""
    return {name: padding for name, padding in _paddings(record) if padding}


def _paddings(record: Record) -> Iterator[tuple[str, float]]:
    case = record.case
    for placed in case.robots:
        before = "" if len(case.robots) == 1 else f"{placed.robot.name}/"
        for body in placed.robot.bodies:
            asked = placed.padding.get(body.name, 0.0)
            yield before + body.name, asked + body.shape.shortfall
    for obstacle in case.obstacles:
        yield obstacle.name, obstacle.padding + obstacle.body.shape.shortfall


def clock_of(record: Record) -> dict[str, Any]:
    """How the actors' clocks hang together: "common", within a slack [s], or "unsynchronised"."""
    slack = record.case.clock.slack
    kind = "common" if slack == 0.0 else "unsynchronised" if math.isinf(slack) else "slack"
    return {"kind": kind, "slack": slack if math.isfinite(slack) else None}

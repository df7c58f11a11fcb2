"""YAML and JSON dumps of ROS's trajectory messages, as `ros2 topic echo` and `rostopic echo` write them, one
document a message, to a trajectory: positions [rad or m], times from its start [s], velocities and
accelerations where all points have them.

Not for: what a document is (`message.documents`), which trajectory of a file is meant (`joint_messages`), fields
beside the points (`message_fields`).
"""

from __future__ import annotations

import math
from collections.abc import Callable
from dataclasses import replace
from functools import partial
from typing import Any, NamedTuple

import numpy as np

from clearance.errors import (
    BadMotion,
    BadShape,
    BadSyntax,
    BadTime,
    MissingKey,
    NotFinite,
    at,
)
from clearance.formats.message.documents import (
    MOST_JSON,
    Fields,
    described,
    json_documents,
    yaml_documents,
)
from clearance.formats.message.values import NANO, header_of, nanoseconds_in, require_fields
from clearance.formats.motion.joint_messages import JointMessage, chosen, messages_in
from clearance.formats.motion.message_fields import start_of, with_start, with_unread
from clearance.formats.motion.requests import ReadTrajectory, TrajectoryRequest
from clearance.world.names import checked_name
from clearance.world.quintic import with_accelerations
from clearance.world.trajectory import Trajectory


def _read(documents_in: Callable[[bytes], list[Any]], request: TrajectoryRequest) -> ReadTrajectory:
    """The trajectory in a file.

    Raises:
        BadInput: with the keys that lead to what is wrong and, in YAML, the line.
    """
    request.choice.refuse_others({"which"}, "a trajectory message")
    with request.opened() as file:
        data = file.read(MOST_JSON + 1)
    message = chosen(messages_in(documents_in(data), len(data)), request.choice.which)
    return trajectory_of_message(message, len(data), request.joints_needed)


read_yaml_trajectory = partial(_read, yaml_documents)
read_json_trajectory = partial(_read, json_documents)

_VALUES = ("positions", "velocities", "accelerations", "effort")
_KEYS = (*_VALUES, "time_from_start")


class _Point(NamedTuple):
    time: float
    values: dict[str, list[float]]
    lacks_nanoseconds: bool = False


def trajectory_of_message(
    message: JointMessage, most: int, joints_needed: bool = True, received: int = 0
) -> ReadTrajectory:
    """The trajectory that a message holds.

    Args:
        most: how many numbers there may be, so that aliases do not make more of a file than it holds.
        received: [ns] when, by the clock of stamps; 0 if nobody says. A message without a stamp begins then.

    Raises:
        BadInput: with the line and the keys that lead to what is wrong.
    """
    given = message.trajectory
    for where, n_points in message.others.items():
        raise BadMotion(
            f"{n_points} points of joints with several degrees of freedom",
            where=_place(given, where),
            valid="robots have joints that turn or slide; a base that moves goes as a joint of the URDF",
        )
    with at(_place(given, message.place, "joint_names")):
        names = _names(given["joint_names"], joints_needed)
    listed = given["points"]
    where = _place(given, message.place, "points")
    if not isinstance(listed, list):
        raise BadSyntax(
            f"{described(listed)} is given", where=where, valid="a list of points is needed"
        )
    if len(listed) * (len(names) + 1) > most:
        raise BadShape("aliases repeat more than the file holds", where=where)
    points = []
    for i, one in enumerate(listed):
        with at(_place(one, message.place, f"points[{i}]")):
            points.append(_point(one, len(names)))
            if i:
                _refuse_standing(points[-2].time, points[-1].time)
    start = start_of(message)
    with at(where):
        trajectory = _assembled(names, points)
    trajectory, on_start = with_start(trajectory, start, message)
    trajectory, on_unread = with_unread(trajectory, message, start)
    if stamp := nanoseconds_in(header_of(given).get("stamp")) or received:
        trajectory = replace(trajectory, began=stamp / NANO, is_message=True)
    return ReadTrajectory(trajectory, (*_notes(points, trajectory), *on_start, *on_unread))


def _place(nearest: Any, *keys: str) -> str:
    """Keys, and the line of the mapping that they are in, if that is known."""
    path = ".".join(key for key in keys if key)
    line = nearest.line if isinstance(nearest, Fields) else None
    return f"line {line}: {path}" if line else path


def _names(given: Any, joints_needed: bool) -> tuple[str, ...]:
    if not isinstance(given, list):
        raise BadSyntax(f"{described(given)} is given", valid="a list of joint names is needed")
    for i, name in enumerate(given):
        if not isinstance(name, str) or not name:
            raise BadSyntax(
                f"{described(name)} is given", where=f"[{i}]", valid="a name, in quotes if need be"
            )
        checked_name(name)
    if joints_needed and not given:
        raise BadShape("there is no joint", valid="at least one joint is needed")
    return tuple(given)


def _point(given: Any, n_joints: int) -> _Point:
    if not isinstance(given, Fields):
        raise BadSyntax(
            f"{described(given)} is given", valid=_WHOLE if given == "..." else "a point is needed"
        )
    require_fields(given, *_KEYS)
    values = {key: _numbers(given[key], key, n_joints) for key in _VALUES if given.get(key)}
    if "positions" not in values and n_joints:
        raise MissingKey("'positions' is missing or empty", valid="a position of each joint")
    if "time_from_start" not in given:
        raise MissingKey("'time_from_start' is missing")
    with at("time_from_start"):
        time = given["time_from_start"]
        return _Point(_seconds(time), values, isinstance(time, Fields) and len(time) == 1)


def _numbers(given: Any, key: str, n_joints: int) -> list[float]:
    if not isinstance(given, list):
        raise BadSyntax(
            f"{described(given)} is given", where=key, valid="a list of numbers is needed"
        )
    for i, value in enumerate(given):
        if type(value) not in (int, float):
            raise BadSyntax(
                f"{described(value)} is given",
                where=f"{key}[{i}]",
                valid=_WHOLE if value == "..." else "a number is needed",
            )
        if not math.isfinite(value):
            raise NotFinite(f"{value} is given", where=f"{key}[{i}]", valid="a finite number")
    if len(given) != n_joints:
        raise BadShape(f"{len(given)} {key}", where=key, valid=f"there are {n_joints} joint_names")
    return given


def _seconds(given: Any) -> float:
    """[s] the nearest double to what a number, or seconds and nanoseconds, say; without nanoseconds these are 0,
    as for ROS's own commands.
    """
    if type(given) in (int, float):
        if not math.isfinite(given):
            raise NotFinite(f"{given} is given", valid="a finite number of seconds")
        return float(given)
    nanoseconds = nanoseconds_in(given)
    if nanoseconds is not None:
        return nanoseconds / NANO
    raise BadTime(
        f"{described(given)} is given",
        valid="seconds, {sec, nanosec} or {secs, nsecs}, whole and fewer than 1e9 nanoseconds",
    )


def _refuse_standing(before: float, time: float) -> None:
    if not time > before:
        raise BadTime(
            f"time {time} follows {before}",
            where="time_from_start",
            valid="times must increase from point to point; a path of a planner needs them first",
        )


def _assembled(names: tuple[str, ...], points: list[_Point]) -> Trajectory:
    for key in ("velocities", "accelerations"):
        without = [i for i, point in enumerate(points) if key not in point.values]
        if 0 < len(without) < len(points):
            raise BadShape(
                f"point {without[0]} has no {key}, others have",
                valid=f"{key} in all points, or in none",
            )
    first = points[0].values
    if "accelerations" in first and "velocities" not in first:
        raise MissingKey(
            "accelerations without velocities",
            valid="velocities in all points too, or no accelerations; alone they say no motion",
        )
    columns = {
        key: np.array([one.values[key] for one in points], dtype=np.float64)
        for key in ("positions", "velocities", "accelerations")
        if key in first
    }
    times = np.array([point.time for point in points], dtype=np.float64)
    positions = columns.get("positions", np.empty((len(points), len(names))))
    trajectory = Trajectory(times, names, positions, columns.get("velocities"))
    if "accelerations" in columns:
        trajectory = with_accelerations(trajectory, columns["accelerations"])
    return trajectory


def _notes(points: list[_Point], trajectory: Trajectory) -> list[str]:
    """What a reader could take to be otherwise."""
    notes = []
    first = points[0]
    if "accelerations" in first.values:
        followed = (
            f"; {len(points)} points become cubics through {trajectory.n_steps} samples, at most "
            f"{trajectory.path_error:.1g} rad or m off, and clearances are reduced to cover that"
        )
        notes.append(
            "joints move on the quintics through positions, velocities and accelerations, as in ROS's joint "
            f"trajectory controller{followed if trajectory.n_steps > 1 else ''}"
        )
    if any("effort" in point.values for point in points):
        notes.append("effort is not read")
    n_whole = sum(point.lacks_nanoseconds for point in points)
    if n_whole:
        notes.append(f"{n_whole} times are seconds without nanoseconds, which are taken as 0")
    return notes


_WHOLE = "all values; ros2 topic echo --full-length writes them"

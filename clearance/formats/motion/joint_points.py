"""YAML and JSON dumps of ROS's trajectory messages, as `ros2 topic echo` and `rostopic echo` write them, one
document a message, to a trajectory: positions [rad or m], times from its start [s], velocities and
accelerations where all points have them; and the fields beside the points: the start of the robot, and names of
fields not read.

Not for: what a document is (`message.documents`), which trajectory of a file is meant (`joint_messages`).
"""

from __future__ import annotations

import math
import re
from collections.abc import Callable, Iterator, Sequence
from dataclasses import replace
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
from clearance.formats.message.times import NANO, nanoseconds_in
from clearance.formats.message.values import header_of, require_fields, require_spelt
from clearance.formats.motion.joint_messages import READ, JointMessage, chosen, messages_in
from clearance.formats.motion.trajectory_file import ReadTrajectory, TrajectoryRequest
from clearance.world.names import checked_name
from clearance.world.notice import listed
from clearance.world.quintic import with_accelerations
from clearance.world.start import started
from clearance.world.trajectory import Trajectory


def read_yaml_trajectory(request: TrajectoryRequest) -> ReadTrajectory:
    """The trajectory in a YAML file.

    Raises:
        BadInput: with the line and the keys that lead to what is wrong.
    """
    return _read(request, yaml_documents)


def read_json_trajectory(request: TrajectoryRequest) -> ReadTrajectory:
    """The trajectory in a JSON file.

    Raises:
        BadInput: with the keys that lead to what is wrong.
    """
    return _read(request, json_documents)


def _read(request: TrajectoryRequest, documents_in: Callable[[bytes], list[Any]]) -> ReadTrajectory:
    request.choice.refuse_others({"which"}, "a trajectory message")
    with request.opened() as file:
        data = file.read(MOST_JSON + 1)
    message = chosen(messages_in(documents_in(data), len(data)), request.choice.which)
    return trajectory_of_message(message, len(data), request.joints_needed)


_VALUES = ("positions", "velocities", "accelerations", "effort")
_KEYS = (*_VALUES, "time_from_start")


class _Point(NamedTuple):
    time: float
    values: dict[str, list[float]]
    lacks_nanoseconds: bool = False


def trajectory_of_message(
    message: JointMessage, most: int, joints_needed: bool = True
) -> ReadTrajectory:
    """The trajectory that a message holds.

    Args:
        most: how many numbers there may be, so that aliases do not make more of a file than it holds.

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
    trajectory, on_start = with_start(trajectory, start)
    unread = _all_unread(message, start)
    grave = tuple(path for path in unread if _GRAVE & {*path.split(".")})
    notes = (*_notes(points, trajectory), *on_start, *_notes_on_unread(unread))
    return ReadTrajectory(replace(trajectory, unread=grave), notes)


_GRAVE = {"attached_collision_objects", "multi_dof_joint_state"}
"""Fields that move a base, or that tell of parts which a link holds."""


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


_STARTS = ("trajectory_start", "start_state")
"""Keys of the robot's state at 0 s."""

_OF_MESSAGE = frozenset(
    ("seq", "stamp", "goal_id", "status", "event_type", "info", "error_code", "planning_time")
)
"""Keys about the message, not about a motion."""

_NAMES = frozenset(("name", "joint_names"))
"""Names that other fields refer to; alone they have no effect."""

_UNTURNED = {"x": 0, "y": 0, "z": 0, "w": 1}

NEAR = 1e-6
"""[rad or m] A start closer than this to a first point at 0 s is the same as the point."""


class StartState(NamedTuple):
    """Where joints are at 0 s.

    Attributes:
        place: the keys that lead to it. positions: [rad] or [m] by joint. velocities: the same a second, or empty.
    """

    place: str
    positions: dict[str, float]
    velocities: dict[str, float]


def start_of(message: JointMessage) -> StartState | None:
    """What the nearest message around a trajectory says of its start; None where none does.

    Raises:
        BadShape: names and numbers that do not go together.
    """
    for place, holder in reversed(message.around):
        if re.search(r"\[[1-9]", message.place[len(place) :]):
            return None  # a later segment begins where the one before ends
        for key in _STARTS:
            path = f"{place}.{key}".lstrip(".")
            joints = holder[key].get("joint_state") if isinstance(holder.get(key), Fields) else None
            if isinstance(joints, Fields) and joints.get("name"):
                with at(f"{path}.joint_state"):
                    require_fields(joints, "header", "name", "position", "velocity", "effort")
                    return StartState(
                        path, _by_name(joints, "position"), _by_name(joints, "velocity")
                    )
    return None


def _by_name(joints: Fields, key: str) -> dict[str, float]:
    names, values = joints["name"], joints.get(key) or []
    if key == "velocity" and not values:
        return {}
    fits = isinstance(names, list) and isinstance(values, list) and len(names) == len(values)
    if not fits or not all(type(one) in (int, float) and math.isfinite(one) for one in values):
        raise BadShape(f"{key} is {described(values)}", valid="a finite number for each name")
    return {str(name): float(value) for name, value in zip(names, values, strict=True)}


def with_start(
    trajectory: Trajectory, start: StartState | None
) -> tuple[Trajectory, tuple[str, ...]]:
    """The trajectory with a sample at 0 s added, if points begin later and the message has a start; and notes."""
    first = float(trajectory.times[0])
    if start is None:
        without = f"the first point is at {first:g} s; how the robot gets there is not in the file"
        return _with_way_in(trajectory), (without,) if first > 0.0 else ()
    names = trajectory.joint_names
    others = [f"{name}: {at_:g}" for name, at_ in start.positions.items() if name not in names]
    notes = [
        f"{start.place} also has joints that the trajectory does not move {{{listed(others, 8)}}}: not used, "
        "robot.joints of the case says where they rest"
    ] if others else []  # fmt: skip
    missing = [name for name in names if name not in start.positions]
    if missing:
        notes.append(f"{start.place} is not used: it has no position of {listed(missing, 8)}")
        return _with_way_in(trajectory), tuple(notes)
    positions = np.array([start.positions[name] for name in names])
    if first > 0.0:
        notes.append(
            f"joints start in {start.place} at 0 s and go to the first point at {first:g} s as between points"
        )
        rates = np.array([start.velocities.get(name, 0.0) for name in names])
        return started(trajectory, positions, rates), tuple(notes)
    off = np.abs(trajectory.positions[0] - positions)
    if (off > NEAR).any():
        i = int(np.argmax(off))
        said = f"{start.place} has joint {names[i]!r} {off[i]:.3g}"
        notes.append(f"{said} off the first point, at {first:g} s; the point is used")
        start_off, has_way_in = f"{said} rad or m off it", trajectory.n_steps > 1
        return replace(trajectory, has_way_in=has_way_in, start_off=start_off), tuple(notes)
    return trajectory, tuple(notes)


def _with_way_in(trajectory: Trajectory) -> Trajectory:
    return replace(
        trajectory, has_way_in=trajectory.n_steps > 1 and bool(trajectory.times[0] > 0.0)
    )


def _all_unread(message: JointMessage, start: StartState | None) -> list[str]:
    """The fields beside the points that have no effect here."""
    found = [*_unread(message.trajectory, message.place, ("joint_names", "points"))]
    for place, holder in message.around:
        for path in _unread(holder, place, READ):
            if start is None or path != start.place:
                found.append(path)
            else:
                key = path.rpartition(".")[2]
                found += _unread(holder[key], path, ("joint_state", "is_diff"))
    return found


def _notes_on_unread(unread: Sequence[str]) -> list[str]:
    return [f"fields beside the points, not read: {listed(unread, 8)}"] if unread else []


def _unread(fields: Fields, place: str, read: Sequence[str]) -> Iterator[str]:
    with at(place or "message"):
        require_spelt(fields, *read, *_STARTS, "header")
        header_of(fields)
    for key, value in fields.items():
        path = f"{place}.{key}".lstrip(".")
        if key == "header" and isinstance(value, Fields):
            if value.get("frame_id"):
                yield f"{path}.frame_id {described(value['frame_id'])}"
        elif key not in read and key not in _OF_MESSAGE and _says(value):
            yield f"{path} {described(value)}" if isinstance(value, str) else path


def _says(value: Any) -> bool:
    """True if a value differs from that of an empty message; each part is visited once."""
    waiting, seen = [value], set[int]()
    while waiting:
        one = waiting.pop()
        if not isinstance(one, Fields | list):
            if one:
                return True
        elif id(one) not in seen:  # aliases repeat parts
            seen.add(id(one))
            if isinstance(one, Fields) and (one == _UNTURNED or one.get("name") == []):
                continue
            if isinstance(one, Fields) and isinstance(one.get("name"), list):
                return True
            waiting += one if isinstance(one, list) else _values_in(one)
    return False


def _values_in(fields: Fields) -> Iterator[Any]:
    return (one for key, one in fields.items() if key not in _NAMES and key not in _OF_MESSAGE)

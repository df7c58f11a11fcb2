"""The fields of a trajectory's message beside its points: the start of the robot, and those that are not read.

Not for: the points (`joint_points`), nor which trajectory of a file is meant (`joint_messages`).
"""

from __future__ import annotations

import math
import re
from collections.abc import Iterator, Sequence
from dataclasses import replace
from typing import Any, NamedTuple

import numpy as np

from clearance.errors import BadShape, at
from clearance.formats.message.documents import Fields, described
from clearance.formats.message.values import header_of, require_fields, require_spelt
from clearance.formats.motion.joint_messages import READ, JointMessage
from clearance.world.notice import listed, naming
from clearance.world.quintic import started
from clearance.world.trajectory import Trajectory

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
        if (start := _start_in(place, holder)) is not None:
            return start
    return None


def _resting_in(message: JointMessage) -> dict[str, float]:
    """Where joints are all the time [rad] or [m] that the start of a message has and no other segment moves."""
    starts = (_start_in(place, holder) for place, holder in reversed(message.around))
    start = next((one for one in starts if one is not None), None)
    positions = {} if start is None else start.positions
    return {name: at_ for name, at_ in positions.items() if name not in message.moved}


def _start_in(place: str, holder: Fields) -> StartState | None:
    for key in _STARTS:
        path = f"{place}.{key}".lstrip(".")
        joints = holder[key].get("joint_state") if isinstance(holder.get(key), Fields) else None
        if isinstance(joints, Fields) and joints.get("name"):
            with at(f"{path}.joint_state"):
                require_fields(joints, "header", "name", "position", "velocity", "effort")
                return StartState(path, _by_name(joints, "position"), _by_name(joints, "velocity"))
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
    trajectory: Trajectory, start: StartState | None, message: JointMessage
) -> tuple[Trajectory, tuple[str, ...]]:
    """The trajectory with a sample at 0 s added, if points begin later and the message has a start; and notes."""
    first, names = float(trajectory.times[0]), trajectory.joint_names
    at_start = _resting_in(message) if start is None else start.positions
    elsewhere = tuple((name, at_) for name, at_ in at_start.items() if name not in names)
    trajectory = replace(trajectory, elsewhere=elsewhere)
    if start is None:
        without = f"the first point is at {first:g} s; how the robot gets there is not in the file"
        return _with_way_in(trajectory), (without,) if first > 0.0 else ()
    others = [f"{name}: {at_:g}" for name, at_ in elsewhere]
    notes = [
        f"{start.place} also has joints that the trajectory does not move {{{listed(others, 8)}}}: "
        "they rest where robot.joints of the case says"
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


_GRAVE = {"attached_collision_objects", "multi_dof_joint_state"}
"""Fields that move a base, or that tell of parts which a link holds."""


def with_unread(
    trajectory: Trajectory, message: JointMessage, start: StartState | None
) -> tuple[Trajectory, list[str]]:
    """The trajectory with the fields beside its points that bear on the motion and are not read; a note on all."""
    unread = [*message.left_out, *_all_unread(message, start)]
    grave = tuple(
        path for path in unread if path in message.left_out or _GRAVE & {*path.split(".")}
    )
    notes = [*naming("fields beside the points, not read", unread, 8)]
    if message.n_others:
        notes.append(f"trajectories in other messages, not read: {message.n_others}")
    return replace(trajectory, unread=grave), notes


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
            if isinstance(one, Fields):
                one = [value for key, value in one.items() if key not in _NAMES | _OF_MESSAGE]
            waiting += one
    return False

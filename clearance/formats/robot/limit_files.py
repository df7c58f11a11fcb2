"""The files of a robot that say how far, how fast and how exactly its joints go, held against the robot:
MoveIt's `joint_limits.yaml`, and `ros2_controllers.yaml` and its like of ROS 1.

As in MoveIt, a limit counts where its `has_…` is true. A tolerance of 0, or none, means that the controller
does not look. Not for: what is beyond the limits (`world.joint_speeds`), nor what a tolerance does to a
clearance.
"""

from __future__ import annotations

import math
import re
from collections.abc import Collection, Iterator, Mapping, Sequence
from dataclasses import dataclass, replace
from typing import NamedTuple, TypeVar

from clearance.errors import (
    BadDimension,
    BadRobot,
    BadSyntax,
    MissingKey,
    UnknownJoint,
    at,
    meant_name,
    nearest_name,
)
from clearance.formats.files.input_files import InputFiles
from clearance.formats.message.documents import Fields, described, yaml_documents
from clearance.formats.message.values import number, require_fields
from clearance.formats.plausibility import LimitBound, limit_notices
from clearance.formats.schema import case as schema
from clearance.world.joint_positions import turns
from clearance.world.names import checked_name
from clearance.world.notice import listed, naming
from clearance.world.placed_robot import NO_LIMIT, MotionLimit, PathTolerance
from clearance.world.robot import Joint, JointKind, Robot
from clearance.world.trajectory import Trajectory

_Value = TypeVar("_Value")


class LimitedRobot(NamedTuple):
    """A robot with the narrower limits, its other limits by joint, and a line each on what was taken.

    Limits that are wider, as in another unit, are among the robot's notices.
    """

    robot: Robot
    motion_limits: dict[str, MotionLimit]
    path_tolerances: dict[str, PathTolerance]
    notes: tuple[str, ...]


def limited(entry: schema.RobotEntry, robot: Robot, files: InputFiles) -> LimitedRobot:
    """The robot of an entry with what its limit files say.

    Raises:
        BadInput: with the field and the file. UnknownJoint: a file of no joint of the robot.
    """
    given, notes = entry.robot, []
    motion: dict[str, MotionLimit] = {}
    tolerances: dict[str, PathTolerance] = {}
    names = {joint.name for joint in robot.joints if joint.kind is not JointKind.FIXED}
    if given.joint_limits is not None:
        path = files.resolved(given.joint_limits)
        shown = files.shown(path)
        with at(f"{entry.field}.joint_limits"), at(shown):
            limits = parse_joint_limits(files.read(path))
            known = _of_robot(limits, names)
            joints = tuple(_narrowed(joint, known) for joint in robot.joints)
        notices = (*robot.notices, *limit_notices(_bounds(known, robot), shown))
        robot = replace(robot, joints=joints, notices=notices)
        motion = {name: one.motion for name, one in known.items() if one.motion != NO_LIMIT}
        notes += [f"{shown}: {note}" for note in _notes_on_limits(limits, known, robot)]
    if given.controllers is not None:
        path = files.resolved(given.controllers)
        shown = files.shown(path)
        with at(f"{entry.field}.controllers"), at(shown):
            controllers = parse_controllers(files.read(path))
            tolerances = _of_robot(widest(controllers), names)
        notes += [
            f"{shown}: {note}" for note in _notes_on_tolerances(controllers, tolerances, robot)
        ]
    return LimitedRobot(robot, motion, tolerances, tuple(notes))


def _of_robot(found: Mapping[str, _Value], names: Collection[str]) -> dict[str, _Value]:
    """What is of joints that the robot can move.

    Raises:
        UnknownJoint: nothing is, or one of them is misspelt.
    """
    without = [name for name in names if name not in found]
    for name in found:
        meant = "" if name in names else meant_name(name, without)
        if meant and _digits(meant) == _digits(name):
            raise UnknownJoint(f"unknown joint {name!r}", valid=f"did you mean {meant!r}?")
    known = {name: value for name, value in found.items() if name in names}
    if not known:
        first = next(iter(found), None)
        raise UnknownJoint(
            f"it speaks of no joint that the robot can move{'' if first is None else f', but of {first!r}'}",
            valid=nearest_name(first or "", names),
        )
    return known


def _digits(name: str) -> list[str]:
    return re.findall(r"\d+", name)


def _narrowed(joint: Joint, limits: Mapping[str, FileLimits]) -> Joint:
    """A joint with the narrower of both limits.

    Raises:
        BadInput: nothing is left between them.
    """
    given = limits.get(joint.name)
    if given is None:
        return joint
    lower, upper = max(joint.lower, given.lower), min(joint.upper, given.upper)
    if lower > upper:
        raise BadRobot(
            f"{given.lower:g} to {given.upper:g} lies outside the robot's {joint.lower:g} to {joint.upper:g}",
            where=f"joint_limits.{joint.name}",
        )
    return replace(joint, lower=lower, upper=upper)


def _notes_on_limits(
    limits: Mapping[str, FileLimits], known: Mapping[str, FileLimits], robot: Robot
) -> Iterator[str]:
    bounds = _bounds(known, robot)
    taken = [(one.kind, one.joint.name) for one in bounds if not one.is_wider]
    taken += [
        ("acceleration", name) for name, one in known.items() if one.motion.acceleration < math.inf
    ]
    yield f"limits taken: {_by_kind(taken, robot) or 'none'}"
    wider = _by_kind([(one.kind, one.joint.name) for one in bounds if one.is_wider], robot)
    if wider:
        yield f"wider than the robot file's, which stay: {wider}"
    yield from naming(_NOT_MOVED, [name for name in limits if name not in known], 8)
    unused = dict.fromkeys(key for one in known.values() for key in one.unused)
    yield from naming("not used", unused, 8)


_NOT_MOVED = "joints that the robot cannot move are left out"


def _joints(names: Collection[str], robot: Robot) -> str:
    """Joints by name, or that they are all."""
    moving = {joint.name for joint in robot.moving_joints}
    return "all joints" if len(moving) > 1 and moving <= {*names} else listed([*names], 8)


def _by_kind(found: Sequence[tuple[str, str]], robot: Robot) -> str:
    """Kinds of limits, each with the names of its joints."""
    names: dict[str, dict[str, None]] = {}
    for kind, name in found:
        names.setdefault(kind, {})[name] = None
    return "; ".join(f"{kind} of {_joints(one, robot)}" for kind, one in names.items())


def _bounds(known: Mapping[str, FileLimits], robot: Robot) -> list[LimitBound]:
    found = []
    for joint in robot.joints:
        if joint.name in known:
            one, speed = known[joint.name], known[joint.name].motion.velocity
            found += [
                LimitBound("position", joint, one.lower, joint.lower, one.lower < joint.lower),
                LimitBound("position", joint, one.upper, joint.upper, one.upper > joint.upper),
                LimitBound("velocity", joint, speed, joint.velocity, speed > joint.velocity),
            ]
    return [one for one in found if math.isfinite(one.given)]


def note_on_accelerations(
    limits: Mapping[str, MotionLimit], trajectory: Trajectory | None
) -> Iterator[str]:
    """That they are not looked at, where the trajectory is lines between samples, whose corners have none."""
    limited = any(limit.acceleration < math.inf for limit in limits.values())
    if limited and trajectory is not None and trajectory.velocities is None:
        yield "accelerations are not compared with their limits: the trajectory has no velocities"


def widest(controllers: list[Controller]) -> dict[str, PathTolerance]:
    """By joint; of several controllers of one, which of them runs is not known."""
    found: dict[str, PathTolerance] = {}
    for controller in controllers:
        for name, one in controller.tolerances.items():
            other = found.get(name, one)
            found[name] = PathTolerance(
                max(one.trajectory, other.trajectory), max(one.goal, other.goal)
            )
    return found


def _notes_on_tolerances(
    controllers: list[Controller], known: Mapping[str, PathTolerance], robot: Robot
) -> Iterator[str]:
    units = {joint.name: "rad" if turns(joint) else "m" for joint in robot.joints}
    bounded = [
        f"{name} {one.trajectory:g} {units[name]}"
        for name, one in known.items()
        if one.trajectory < math.inf
    ]
    free = [name for name, one in known.items() if one.trajectory == math.inf]
    loose = _joints(free, robot)
    text = f"controllers {listed([one.name for one in controllers], 4)} let joints leave the path: "
    text += f"{listed(bounded, 8)} at most" if bounded else ""
    text += ("; " if bounded and free else "") + (f"{loose} as far as they go" if free else "")
    yield f"{text}; no clearance is lessened by that"
    joints = [name for one in controllers for name in one.tolerances if name not in known]
    yield from naming(_NOT_MOVED, joints, 8)


_FACTORS = {"!degrees": math.pi / 180.0, "!radians": 1.0}
"""Units that xacro knows as tags, and files of limits use."""


def _parameters(data: bytes) -> Fields:
    """The one mapping in a file of parameters."""
    documents = yaml_documents(data, _FACTORS)
    if len(documents) != 1:
        raise BadSyntax(f"{len(documents)} documents are given", valid="one mapping")
    return _mapping(documents[0])


def _mapping(value: object) -> Fields:
    if not isinstance(value, Fields):
        raise BadRobot(f"{described(value)} is given", valid="a mapping")
    return value


def _truth(given: Fields, key: str) -> bool:
    """Whether true stands at a key; not where the key is not there."""
    value = given.get(key, "false")
    word = value.lower() if isinstance(value, str) else ""
    if word not in ("true", "false"):
        raise BadRobot(f"{described(value)} is given", where=key, valid="true or false")
    return word == "true"


_WRAPPED_IN = ("robot_description_planning", "ros__parameters")

_USED = {
    "has_position_limits": ("min_position", "max_position"),
    "has_velocity_limits": ("max_velocity",),
    "has_acceleration_limits": ("max_acceleration",),
}
_UNUSED = (
    "has_jerk_limits", "max_jerk", "has_effort_limits", "max_effort", "has_deceleration_limits",
    "max_deceleration", "min_velocity", "min_acceleration", "angle_wraparound", "has_soft_limits", "k_position",
    "k_velocity", "soft_lower_limit", "soft_upper_limit",
)  # fmt: skip

_KEYS = (*_USED, *(key for keys in _USED.values() for key in keys), *_UNUSED)


@dataclass(frozen=True)
class FileLimits:
    """What a file says of one joint.

    Attributes:
        lower, upper: [rad] or [m]; infinite where it says nothing.
        unused: keys that are there and say nothing here.
    """

    lower: float = -math.inf
    upper: float = math.inf
    motion: MotionLimit = NO_LIMIT
    unused: tuple[str, ...] = ()


def parse_joint_limits(data: bytes) -> dict[str, FileLimits]:
    """Limits by joint.

    Raises:
        BadInput: with the joint and the key.
    """
    found = list(_blocks(_parameters(data)))
    if not found:
        raise MissingKey("'joint_limits' is missing", valid="MoveIt's file of that name")
    if len(found) > 1:
        raise BadRobot(f"there are {len(found)} mappings 'joint_limits'", valid="one")
    limits = {}
    for name, given in _mapping(found[0]).items():
        with at(f"joint_limits.{name:.60}"):
            limits[checked_name(name)] = _limits(_mapping(given))
    return limits


def _blocks(given: Fields, depth: int = 0) -> Iterator[object]:
    """The values of `joint_limits`, at the top or in what ROS wraps parameters in: nodes, and their parameters."""
    if "joint_limits" in given:
        yield given["joint_limits"]
        return
    for key, value in given.items():
        if isinstance(value, Fields) and depth < 4 and (depth == 0 or key in _WRAPPED_IN):
            yield from _blocks(value, depth + 1)


def _limits(given: Fields) -> FileLimits:
    require_fields(given, *_KEYS)
    unused = [key for key in _UNUSED if key in given]
    values: dict[str, float] = {}
    for has, keys in _USED.items():
        if not _truth(given, has):
            unused += [key for key in keys if key in given]
            continue
        for key in keys:
            if key not in given:
                raise MissingKey(f"{has} is true, but {key!r} is missing")
            values[key] = number(given[key], key)
    lower, upper = values.get("min_position", -math.inf), values.get("max_position", math.inf)
    if lower > upper:
        raise BadRobot(f"min_position {lower:g} is above max_position {upper:g}")
    for key in ("max_velocity", "max_acceleration"):
        if values.get(key, 1.0) <= 0.0:
            raise BadDimension(f"{key} is {values[key]:g}", valid="above 0")
    motion = MotionLimit(
        values.get("max_velocity", math.inf), values.get("max_acceleration", math.inf)
    )
    return FileLimits(lower, upper, motion, tuple(unused))


_DEPTH = 4
"""Namespaces that a controller may be in."""

_TOLERANCES = ("trajectory", "goal")

_OF_ALL = ("goal_time", "stopped_velocity_tolerance")
"""Constraints that are of no joint."""


@dataclass(frozen=True)
class Controller:
    """A controller that follows trajectories, and the tolerances of its joints."""

    name: str
    tolerances: dict[str, PathTolerance]


def parse_controllers(data: bytes) -> list[Controller]:
    """The controllers in a file that have joints.

    Raises:
        MissingKey: none has. BadInput: with the controller and the key.
    """
    found = list(_controllers(_parameters(data)))
    if not found:
        raise MissingKey("no controller in it has 'joints' or 'constraints'")
    return found


def _controllers(given: Fields, depth: int = 0) -> Iterator[Controller]:
    for name, value in given.items():
        if not isinstance(value, Fields):
            continue
        body = value.get("ros__parameters", value)
        if not isinstance(body, Fields):
            continue
        with at(f"{name:.60}"):
            if "constraints" in body or isinstance(body.get("joints"), list):
                yield Controller(checked_name(name), _tolerances(body))
            elif depth < _DEPTH:
                yield from _controllers(body, depth + 1)


def _tolerances(body: Fields) -> dict[str, PathTolerance]:
    """Of each joint that the controller names."""
    joints = body.get("joints", [])
    if not isinstance(joints, list) or not all(isinstance(joint, str) for joint in joints):
        raise BadRobot(f"{described(joints)} is given", where="joints", valid="a list of names")
    found = {checked_name(joint): PathTolerance() for joint in joints}
    with at("constraints"):
        for name, given in _mapping(body.get("constraints", Fields())).items():
            if name in _OF_ALL:
                continue
            with at(f"{name:.60}"):
                found[checked_name(name)] = _tolerance(_mapping(given))
    return found


def _tolerance(given: Fields) -> PathTolerance:
    require_fields(given, *_TOLERANCES)
    return PathTolerance(*(_length(given, key) for key in _TOLERANCES))


def _length(given: Fields, key: str) -> float:
    value = number(given[key], key) if key in given else 0.0
    if value < 0.0:
        raise BadDimension(f"{value:g} is given", where=key, valid="0 or more")
    return value or math.inf

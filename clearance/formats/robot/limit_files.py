"""The files of a robot that say how far, how fast and how exactly its joints go, held against the robot.

Not for: their formats (`joint_limits_file`, `controllers_file`).
"""

from __future__ import annotations

import math
from collections.abc import Collection, Iterator, Mapping
from dataclasses import replace
from pathlib import Path
from typing import TYPE_CHECKING, NamedTuple, TypeVar

from clearance.errors import BadInput, UnknownJoint, at, nearest_name
from clearance.formats.files.input_files import InputFiles, resolved
from clearance.formats.robot.joint_limits_file import FileLimits, parse_joint_limits
from clearance.formats.schema import case as schema
from clearance.world.joint_positions import turns
from clearance.world.motion_limits import NO_LIMIT, MotionLimit, PathTolerance
from clearance.world.notice import listed
from clearance.world.robot import Joint, JointKind, Robot
from clearance.world.trajectory import Trajectory

if TYPE_CHECKING:
    from clearance.formats.robot.controllers_file import Controller

_Value = TypeVar("_Value")


class LimitedRobot(NamedTuple):
    """A robot with the narrower limits, its other limits by joint, and a line each on what was taken."""

    robot: Robot
    motion_limits: dict[str, MotionLimit]
    path_tolerances: dict[str, PathTolerance]
    notes: tuple[str, ...]


def limited(
    entry: schema.RobotEntry, robot: Robot, folder: Path, files: InputFiles
) -> LimitedRobot:
    """The robot of an entry with what its limit files say.

    Raises:
        BadInput: with the field and the file. UnknownJoint: a file of no joint of the robot.
    """
    given, notes = entry.robot, []
    motion: dict[str, MotionLimit] = {}
    tolerances: dict[str, PathTolerance] = {}
    names = {joint.name for joint in robot.joints if joint.kind is not JointKind.FIXED}
    if given.joint_limits is not None:
        path = resolved(given.joint_limits, folder)
        shown = files.shown(path)
        with at(f"{entry.field}.joint_limits"), at(shown):
            limits = parse_joint_limits(files.read(path))
            known = _of_robot(limits, names)
            joints = tuple(_narrowed(joint, known) for joint in robot.joints)
        robot = replace(robot, joints=joints)
        motion = {name: one.motion for name, one in known.items() if one.motion != NO_LIMIT}
        notes += [f"{shown}: {note}" for note in _notes_on_limits(limits, known, robot)]
    if given.controllers is not None:
        from clearance.formats.robot.controllers_file import parse_controllers

        path = resolved(given.controllers, folder)
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
        UnknownJoint: nothing is.
    """
    known = {name: value for name, value in found.items() if name in names}
    if not known:
        first = next(iter(found), None)
        raise UnknownJoint(
            f"it speaks of no joint that the robot can move{'' if first is None else f', but of {first!r}'}",
            valid=nearest_name(first or "", names),
        )
    return known


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
        raise BadInput(
            f"{given.lower:g} to {given.upper:g} lies outside the robot's {joint.lower:g} to {joint.upper:g}",
            where=f"joint_limits.{joint.name}",
        )
    return replace(joint, lower=lower, upper=upper)


def _notes_on_limits(
    limits: Mapping[str, FileLimits], known: Mapping[str, FileLimits], robot: Robot
) -> Iterator[str]:
    by_name = {joint.name: joint for joint in robot.joints}
    kinds = {
        "position": [name for name, one in known.items() if _has_position(one)],
        "velocity": [name for name, one in known.items() if one.motion.velocity < math.inf],
        "acceleration": [name for name, one in known.items() if one.motion.acceleration < math.inf],
    }
    taken = [f"{kind} of {_joints(names, robot)}" for kind, names in kinds.items() if names]
    yield f"limits taken: {'; '.join(taken) or 'none'}"
    wider = [name for name, one in known.items() if _is_wider(one, by_name[name])]
    if wider:
        yield f"wider than the robot file's, which stay: position of {listed(wider, 8)}"
    others = [name for name in limits if name not in known]
    if others:
        yield f"joints that the robot cannot move are left out: {listed(others, 8)}"
    unused = dict.fromkeys(key for one in known.values() for key in one.unused)
    if unused:
        yield f"not used: {listed([*unused], 8)}"


def _joints(names: Collection[str], robot: Robot) -> str:
    """Joints by name, or that they are all."""
    moving = {joint.name for joint in robot.moving_joints}
    return "all joints" if len(moving) > 1 and moving <= {*names} else listed([*names], 8)


def _has_position(limits: FileLimits) -> bool:
    return limits.lower > -math.inf or limits.upper < math.inf


def _is_wider(given: FileLimits, joint: Joint) -> bool:
    lower = given.lower > -math.inf and given.lower < joint.lower
    return lower or (given.upper < math.inf and given.upper > joint.upper)


def note_on_accelerations(
    limits: Mapping[str, MotionLimit], trajectory: Trajectory | None
) -> Iterator[str]:
    """That they are not looked at, where the trajectory is lines between samples, whose corners have none."""
    limited = any(limit.acceleration < math.inf for limit in limits.values())
    if limited and trajectory is not None and trajectory.velocities is None:
        yield "accelerations are not held against their limits: the trajectory gives no velocities"


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
    told = f"controllers {listed([one.name for one in controllers], 4)} let joints leave the path: "
    told += f"{listed(bounded, 8)} at most" if bounded else ""
    told += ("; " if bounded and free else "") + (f"{loose} as far as they go" if free else "")
    yield f"{told}; no clearance is lessened by that"
    joints = [name for one in controllers for name in one.tolerances if name not in known]
    if joints:
        yield f"joints that the robot cannot move are left out: {listed(joints, 8)}"

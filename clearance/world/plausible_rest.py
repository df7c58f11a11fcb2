"""Notices on joints that no trajectory moves and nobody else gives: they stay at 0; and on such bases."""

from __future__ import annotations

import math
from collections.abc import Iterable, Iterator, Mapping

import numpy as np

from clearance.world.notice import Notice, Severity, listed
from clearance.world.placed_robot import PlacedRobot
from clearance.world.robot import Joint, JointKind, Robot

NEAR_BASE = 1e-4
"""[m] and [-] How far a robot's base may be from where a file has it, whose numbers may be rounded."""


NEAR_REST = 1e-4
"""[rad] or [m] How far a joint may rest from where a message has it, whose numbers may be rounded."""


def notices_on_bases(placed: PlacedRobot) -> list[Notice]:
    """Notices on a base that a virtual joint moves: nobody says where it is, or states have it elsewhere."""
    found, about = [], placed.robot.name
    for joint, pose in placed.bases.items():
        if pose is not None:
            found += misplaced("a state of the SRDF", joint, pose, [placed.world_from_base])
        else:
            text = (
                f"virtual joint {joint!r} of the SRDF moves the base of robot {about!r}, and nobody says where "
                "it is: it stands at the origin of the world; robot: {base: …} says where"
            )
            found.append(Notice(Severity.WARNING, "rest", text, about))
    return found


def misplaced(
    said_by: str, joint: str, pose: np.ndarray, bases: Iterable[np.ndarray]
) -> list[Notice]:
    """Suspect input, if a file puts a robot's base elsewhere than the case puts any; its own origin says nothing.

    Args:
        joint: by which it does. pose: (4, 4) [m]. bases: those of the case, alike.
    """
    if any(np.allclose(pose, one, rtol=0.0, atol=NEAR_BASE) for one in (np.eye(4), *bases)):
        return []
    place = ", ".join(f"{one:g}" for one in pose[:3, 3])
    text = (
        f"CHECK FRAME: {said_by} has its robot at ({place}) m by joint {joint!r}, and the case does not; "
        "give it as the robot's base"
    )
    return [Notice(Severity.SUSPECT, "frame", text)]


def notices_on_rest(placed: PlacedRobot, before: str = "") -> list[Notice]:
    """A warning that names all that are left out, those between two that are given first: a column may be missing.

    Args:
        before: what stands before the names of joints.
    """
    asked, joints = placed.trajectory, placed.robot.moving_joints
    moved = set() if asked is None else {*asked.joint_names}
    given = moved | {*placed.fixed_positions}
    told = {} if asked is None else dict(asked.elsewhere)
    found = rests_otherwise(placed, told, before, "its message starts")
    resting = [joint for joint in joints if joint.name not in given and joint.name not in told]
    if not resting:
        return found
    between = _between(placed.robot, resting, moved)
    names = [repr(before + one.name) for one in sorted(resting, key=lambda one: one not in between)]
    are = "is given by nobody and stays" if len(resting) == 1 else "are given by nobody and stay"
    text = f"{len(resting)} of {len(joints)} joints {are} at 0: {listed(names, 4)}; "
    text += f"joints on both sides of {names[0]} are given, " if between else ""
    text += f"is {'a column' if moved else 'its trajectory'} missing? "
    text += f"{_in_case(placed, before, 'NAME: …')} says where they are"
    return [*found, Notice(Severity.WARNING, "rest", text, placed.robot.name)]


def rests_otherwise(
    placed: PlacedRobot, told: Mapping[str, float], before: str, said_by: str
) -> list[Notice]:
    """A warning on joints that rest elsewhere than a file has them.

    Args:
        told: [rad or m] where, by joints, which no trajectory moves. before: what stands before their names.
        said_by: the file, in words.
    """
    joints = [joint for joint in placed.robot.moving_joints if joint.name in told]
    rest = {joint.name: placed.fixed_positions.get(joint.name, 0.0) for joint in joints}
    odd = [
        joint.name
        for joint in joints
        if _apart(joint, rest[joint.name], told[joint.name]) > NEAR_REST
    ]
    if not odd:
        return []
    shown = listed(
        [f"joint {before + name!r} at {rest[name]:g}, and there at {told[name]:g}" for name in odd]
    )
    taken = ", ".join(f"{name}: {told[name]:g}" for name in odd)
    about = placed.robot.name
    text = f"robot {about!r} rests otherwise than {said_by}: {shown}"
    remedy = f"{_in_case(placed, before, taken)} has them as there"
    return [Notice(Severity.WARNING, "rest", f"{text}; {remedy}", about)]


def _apart(joint: Joint, one: float, other: float) -> float:
    """[rad] or [m] between two positions; whole turns of a continuous joint are none."""
    is_endless = joint.kind is JointKind.CONTINUOUS
    return abs(math.remainder(one - other, 2.0 * math.pi) if is_endless else one - other)


def _in_case(placed: PlacedRobot, before: str, joints: str) -> str:
    """The lines of a case that give a robot's joints; with several robots, `before` stands before their names."""
    given = f"joints: {{{joints}}}"
    return f"robots: [{{name: {placed.robot.name}, {given}}}]" if before else f"robot: {{{given}}}"


def _between(robot: Robot, resting: list[Joint], moved: set[str]) -> list[Joint]:
    """The resting joints that have one that is moved above them, and one below."""
    above = {joint.child: joint for joint in robot.joints}

    def chain(joint: Joint) -> Iterator[Joint]:
        while joint.parent in above:
            joint = above[joint.parent]
            yield joint

    carrying = {one.name for joint in robot.joints if joint.name in moved for one in chain(joint)}
    return [
        joint
        for joint in resting
        if joint.name in carrying and any(one.name in moved for one in chain(joint))
    ]

"""Notices on joints that a trajectory leaves out and nobody else gives: they stay at 0."""

from __future__ import annotations

from collections.abc import Iterator

from clearance.world.case import PlacedRobot
from clearance.world.notice import Notice, Severity, listed
from clearance.world.robot import Joint, Robot


def notices_on_rest(placed: PlacedRobot, before: str = "") -> list[Notice]:
    """A warning where most joints are left out, or one between two that are given: a column may be missing.

    Args:
        before: what stands before the names of joints.
    """
    asked, joints = placed.trajectory, placed.robot.moving_joints
    if asked is None:
        return []
    given = {*asked.joint_names, *placed.fixed_positions}
    resting = [joint for joint in joints if joint.name not in given]
    between = _between(placed.robot, resting, {*asked.joint_names})
    if not between and 2 * len(resting) <= len(joints):
        return []
    names = [repr(before + one.name) for one in sorted(resting, key=lambda one: one not in between)]
    text = f"{len(resting)} of {len(joints)} joints are given by nobody and stay at 0: {listed(names, 4)}; "
    if between:
        text += f"joints on both sides of {names[0]} are given, is its column missing? "
    text += "robot: {joints: {NAME: …}} says where they are"
    return [Notice(Severity.WARNING, "rest", text, placed.robot.name)]


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

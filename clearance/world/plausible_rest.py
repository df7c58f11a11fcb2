"""Notices on joints that a trajectory leaves out and nobody else gives: they stay at 0."""

from __future__ import annotations

from collections.abc import Iterator

from clearance.world.notice import Notice, Severity, listed
from clearance.world.placed_robot import PlacedRobot
from clearance.world.robot import Joint, Robot


def notices_on_rest(placed: PlacedRobot, before: str = "") -> list[Notice]:
    """A warning that names all that are left out, those between two that are given first: a column may be missing.

    Args:
        before: what stands before the names of joints.
    """
    asked, joints = placed.trajectory, placed.robot.moving_joints
    if asked is None:
        return []
    given = {*asked.joint_names, *placed.fixed_positions}
    resting = [joint for joint in joints if joint.name not in given]
    if not resting:
        return []
    between = _between(placed.robot, resting, {*asked.joint_names})
    names = [repr(before + one.name) for one in sorted(resting, key=lambda one: one not in between)]
    are = "is given by nobody and stays" if len(resting) == 1 else "are given by nobody and stay"
    text = f"{len(resting)} of {len(joints)} joints {are} at 0: {listed(names, 4)}; "
    text += f"joints on both sides of {names[0]} are given, " if between else ""
    text += "is a column missing? robot: {joints: {NAME: …}} says where they are"
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

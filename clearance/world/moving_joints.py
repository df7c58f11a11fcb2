"""Joint names that are given values, compared with the robot's. Not for: the values (`joint_limits`, `reach`)."""

from __future__ import annotations

from collections.abc import Iterable

from clearance.errors import UnknownJoint, nearest_name
from clearance.world.robot import JointKind, Robot


def require_moving_joints(robot: Robot, names: Iterable[str]) -> None:
    """Nothing, if all are names of joints that can be set.

    Raises:
        UnknownJoint: not there, with the nearest name; or fixed, or a mimic of another joint.
    """
    by_name = {joint.name: joint for joint in robot.joints}
    moving = [joint.name for joint in robot.moving_joints]
    for name in names:
        if name not in by_name:
            raise UnknownJoint(f"unknown joint {name!r}", valid=nearest_name(name, moving))
        joint = by_name[name]
        if joint.kind is JointKind.FIXED:
            raise UnknownJoint(
                f"joint {name!r} is fixed", valid=f"moving joints: {', '.join(moving)}"
            )
        if joint.mimic is not None:
            raise UnknownJoint(
                f"joint {name!r} mimics {joint.mimic.joint!r} and cannot be set",
                valid=f"leave it out or give {joint.mimic.joint!r}",
            )

"""Joint names given by trajectory and case, held against the robot. Not for: values."""

from __future__ import annotations

from collections.abc import Iterable

from clearance.errors import DuplicateName, UnknownJoint, nearest_name
from clearance.world.notice import listed
from clearance.world.robot import JointKind, Robot


def check_joint_names(given: Iterable[str], robot: Robot) -> None:
    """Refuses names that cannot be set.

    Raises:
        UnknownJoint: not there, with the nearest name; or fixed, or a mimic of another joint.
    """
    by_name = {joint.name: joint for joint in robot.joints}
    moving = [joint.name for joint in robot.moving_joints]
    for name in given:
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


def check_not_given_twice(in_case: Iterable[str], in_trajectory: Iterable[str]) -> None:
    """Refuses a fixed value for a joint that the trajectory moves.

    Raises:
        DuplicateName: with the joint.
    """
    columns = set(in_trajectory)
    for name in in_case:
        if name in columns:
            raise DuplicateName(
                f"joint {name!r} is also a column of the trajectory", valid="give it in one place"
            )


def note_on_joints_at_zero(robot: Robot, given: Iterable[str]) -> list[str]:
    """A note naming the moving joints that nobody gives a value; they stay at 0."""
    known = set(given)
    left = [joint.name for joint in robot.moving_joints if joint.name not in known]
    if not left:
        return []
    return [f"joints given neither by the trajectory nor by robot.joints stay at 0: {listed(left, 8)}"]

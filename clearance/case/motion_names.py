"""Joints that trajectory and case of a file give twice, or not at all. Not for: names (`world.moving_joints`)."""

from __future__ import annotations

from collections.abc import Iterable

from clearance.errors import DuplicateName
from clearance.world.notice import listed
from clearance.world.robot import Robot


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


def note_on_joints_at_zero(robot: Robot, given: Iterable[str], field: str) -> list[str]:
    """A note naming the moving joints that nobody gives a value; they stay at 0.

    Args:
        field: where a case file could give them one.
    """
    known = set(given)
    left = [joint.name for joint in robot.moving_joints if joint.name not in known]
    if not left:
        return []
    return [f"joints given neither by the trajectory nor by {field} stay at 0: {listed(left, 8)}"]

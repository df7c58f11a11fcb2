"""CSV to a trajectory: a `time` column [s] and one column a joint, by name, in any order.

A column `<joint>/velocity` [rad/s or m/s], named as ros2_control names its interfaces, gives the joint's velocity;
all joints have one or none. Not for: which joints the robot has (`motion_names`), nor how a table is parsed
(`csv_table`).
"""

from __future__ import annotations

from clearance.errors import BadShape, MissingKey, nearest_name
from clearance.load.csv_table import TIME, columns_of, header_of, refuse_standing_time
from clearance.load.trajectory_request import ReadTrajectory, TrajectoryRequest
from clearance.world.trajectory import Trajectory

_VELOCITY = "/velocity"


def read_csv(request: TrajectoryRequest) -> ReadTrajectory:
    """The samples in a CSV file; joints in the order of their position columns.

    Raises:
        BadSyntax, BadShape, MissingKey, DuplicateName, NotFinite, BadTime: with the line in the
        file. BadDimension: a velocity that no joint can have.
    """
    request.choice.refuse_others((), "a CSV table")
    opened = request.opened
    names = header_of(opened, "joint names")
    _refuse_unmatched_velocities(names)
    if request.joints_needed and len(names) == 1:
        raise BadShape("there is no joint column", valid="time and at least one joint are needed")
    joints = tuple(name for name in names if name != TIME and not name.endswith(_VELOCITY))
    parts = [[TIME], joints]
    if len(joints) < len(names) - 1:
        parts.append([joint + _VELOCITY for joint in joints])
    times, *moving = columns_of(opened, request.n_bytes, names, parts)
    refuse_standing_time(times[:, 0], opened)
    return ReadTrajectory(Trajectory(times[:, 0], joints, *moving))


def _refuse_unmatched_velocities(names: list[str]) -> None:
    joints = [name for name in names if name != TIME and not name.endswith(_VELOCITY)]
    given = [name.removesuffix(_VELOCITY) for name in names if name.endswith(_VELOCITY)]
    known, moving = frozenset(joints), frozenset(given)
    for joint in given:
        if joint not in known:
            raise MissingKey(
                f"column {joint + _VELOCITY!r} is the velocity of {joint!r}, which has no column",
                valid=nearest_name(joint, joints),
            )
    without = [joint for joint in joints if joint not in moving]
    if given and without:
        raise MissingKey(
            f"joint {without[0]!r} has no column {without[0] + _VELOCITY!r}, joint {given[0]!r} has one",
            valid="velocities of all joints or of none",
        )

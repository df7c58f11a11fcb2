"""What a table's columns say of the joints of a robot: which are joints, which follow others, which are to be left
out. Not for: reading the table (`trajectory_csv`).
"""

from __future__ import annotations

import re
from collections.abc import Sequence

import numpy as np

from clearance.errors import BadInput, UnknownJoint
from clearance.load.table.column_units import VELOCITY, Column
from clearance.load.table.csv_table import TIME
from clearance.load.text.yaml_text import flow
from clearance.world.joint_positions import turns
from clearance.world.mimics import Follower, followers
from clearance.world.moving_joints import require_moving_joints
from clearance.world.notice import listed
from clearance.world.robot import Robot
from clearance.world.trajectory import Trajectory

TURN_AGREES, SLIDE_AGREES = 1e-3, 1e-4
"""[rad], [m] How far a joint that follows another may be logged off where it follows: 1 mm at 1 m, as fine as
certificates are."""

_NUMBERED = re.compile(r"(.*?)(\d+)")


def require_joints(robot: Robot, joints: Sequence[str], columns: Sequence[Column]) -> None:
    """Nothing, if all are joints that move, or follow one that is given too.

    Args:
        columns: all of the table, for the remedy.

    Raises:
        UnknownJoint: with the nearest name, and the `columns` that leave out what is no joint.
    """
    following = {one.joint.name for one in _following(robot, joints)}
    try:
        require_moving_joints(robot, [name for name in joints if name not in following])
    except UnknownJoint as error:
        error.valid += f"; {_remedy(robot, columns)}"
        raise


def without_followers(robot: Robot, found: Trajectory) -> tuple[Trajectory, list[str]]:
    """The trajectory without joints that follow others that it gives as well, and a note.

    Raises:
        BadInput: one is not where it follows.
    """
    following = _following(robot, found.joint_names)
    for one in following:
        _require_agreed(found, one)
    if not following:
        return found, []
    names = [one.joint.name for one in following]
    kept = [i for i, name in enumerate(found.joint_names) if name not in names]
    told = listed([repr(name) for name in names], 8)
    return found.of_columns(kept), [
        f"columns of joints that follow others agree with these: {told}"
    ]


def _following(robot: Robot, joints: Sequence[str]) -> list[Follower]:
    """The joints that follow others of the given ones."""
    given = set(joints)
    return [
        one
        for one in followers(robot)
        if one.joint.mimic is not None and {one.joint.name, one.master} <= given
    ]


def _require_agreed(found: Trajectory, one: Follower) -> None:
    joint, master = one.joint, one.master
    own, lead = (found.positions[:, found.joint_names.index(n)] for n in (joint.name, master))
    off = np.abs(own - (one.factor * lead + one.offset))
    agrees, unit = (TURN_AGREES, "rad") if turns(joint) else (SLIDE_AGREES, "m")
    if (off > agrees).any():
        worst = int(np.argmax(off))
        raise BadInput(
            f"joint {joint.name!r} follows {master!r}, and is {off[worst]:.3g} {unit} off that at "
            f"{found.times[worst]:g} s",
            valid=f"within {agrees:g} {unit}, or leave {joint.name!r} out: it goes with {master!r}",
        )


def _remedy(robot: Robot, columns: Sequence[Column]) -> str:
    """The `columns` of a case that take what is meant out of a header."""
    joints = [joint.name for joint in robot.moving_joints]
    times = {one.name: one.header for one in columns if one.name == TIME}
    own = [one.header for one in columns if one.name.removesuffix(VELOCITY) in joints]
    if own:
        return f"columns: {flow([*times.values(), *own])} takes these columns alone (--columns)"
    groups: dict[str, list[str]] = {}
    for one in columns:
        numbered = _NUMBERED.fullmatch(one.header)
        if numbered:
            groups.setdefault(numbered[1], []).append(one.header)
    alike = [names for names in groups.values() if len(names) == len(joints) > 1]
    alike.sort(key=lambda names: "actual_q_" not in names[0])  # as robots of UR log where they are
    taken = alike[0] if alike else [f"column of {joint}" for joint in joints]
    told = flow(times | dict(zip(joints, taken, strict=True)))
    return f"columns: {told} says which column is whose (--columns)"

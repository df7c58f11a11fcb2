"""Which columns of a table are joints of a robot, which are mimic joints, and which to leave out; and columns
that hold a quaternion, for a joint that turns by yaw, pitch and roll.

A free base is logged as `base/qx` to `base/qw` where its joint `base` goes by `base/yaw`, `base/pitch` and
`base/roll`. Not for: reading the table (`trajectory_csv`), nor tables of poses (`pose_table_file`), which keep
their quaternions.
"""

from __future__ import annotations

import re
from collections.abc import Mapping, Sequence
from difflib import get_close_matches

import numpy as np

from clearance.errors import BadMotion, UnknownJoint
from clearance.formats.motion.pose_table_file import refuse_off_length_one
from clearance.formats.table.column_units import VELOCITY, Column
from clearance.formats.table.csv_table import TIME, UNNAMED, TextTable, line_of_row
from clearance.formats.text.notes import note_on_rounded
from clearance.formats.text.yaml_text import flow
from clearance.geometry.quaternions import of_unit_length, yaw_pitch_roll
from clearance.world.joint_positions import turns
from clearance.world.mimics import Follower, followers
from clearance.world.moving_joints import require_moving_joints
from clearance.world.notice import listed
from clearance.world.robot import Robot
from clearance.world.trajectory import Trajectory

TURN_AGREES, SLIDE_AGREES = 1e-3, 1e-4
"""[rad], [m] How far a logged mimic joint may be off the position that it should follow: 1 mm at 1 m."""

ALIKE = 0.85
"""[-] Names that are misspelt agree by so much; a joint's with `_effort` behind it do not."""

_NUMBERED = re.compile(r"(.*?)(\d+)")
_LIKE_TIME = re.compile(rf"time|stamp|zeit|sec|^{re.escape(UNNAMED)}", re.IGNORECASE)


def require_joints(robot: Robot, joints: Sequence[str], columns: Sequence[Column]) -> None:
    """Checks that all are moving joints, or mimic joints whose master is given too.

    Args:
        columns: all of the table, for the remedy.

    Raises:
        UnknownJoint: with the nearest name, and the `columns` that leave out what is no joint.
    """
    following = {one.joint.name for one in _following(robot, joints)}
    try:
        require_moving_joints(robot, [name for name in joints if name not in following])
    except UnknownJoint as error:
        error.valid += f"; {remedy(robot, columns)}"
        raise


def without_followers(robot: Robot, found: Trajectory) -> tuple[Trajectory, list[str]]:
    """The trajectory without mimic joints whose master it gives as well, and a note.

    Raises:
        BadInput: a mimic joint is off the position that it should follow.
    """
    following = _following(robot, found.joint_names)
    for one in following:
        _require_agreed(found, one)
    if not following:
        return found, []
    names = [one.joint.name for one in following]
    columns = [i for i, name in enumerate(found.joint_names) if name not in names]
    joints = listed([repr(name) for name in names], 8)
    return found.of_columns(columns), [
        f"columns of mimic joints agree with the joints that they follow: {joints}"
    ]


def _following(robot: Robot, joints: Sequence[str]) -> list[Follower]:
    """The mimic joints among the given ones whose master is given too."""
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
        raise BadMotion(
            f"joint {joint.name!r} follows {master!r}, and is {off[worst]:.3g} {unit} off that at "
            f"{found.times[worst]:g} s",
            valid=f"within {agrees:g} {unit}, or leave {joint.name!r} out: it goes with {master!r}",
        )


def remedy(robot: Robot, columns: Sequence[Column]) -> str:
    """The line `columns: …` to add to a case, so that only joints of the robot are read."""
    joints = [joint.name for joint in robot.moving_joints]
    own = [one for one in columns if one.name.removesuffix(VELOCITY) in joints]
    times = [one.header for one in columns if one.name == TIME]
    found = {one.name: one.header for one in own}
    unfound = [joint for joint in joints if joint not in found]
    renamed = _misspelt(unfound, columns, own) if own else {}
    if own and times and not renamed:
        mapping = flow([*times, *(one.header for one in own)])
        return f"columns: {mapping} reads these columns only (--columns)"
    found = found | renamed or _joints_alike(joints, columns)
    mapping = flow({TIME: times[0] if times else _time_alike(columns)} | found)
    return f"columns: {mapping} maps each joint to its column (--columns)"


def _misspelt(
    joints: Sequence[str], columns: Sequence[Column], own: Sequence[Column]
) -> dict[str, str]:
    """The column for each joint that has none but is spelt nearly like one, with the same numbers."""
    headers, found = [one.header for one in columns if one not in own], {}
    for joint in joints:
        near = get_close_matches(joint, headers, 1, ALIKE)
        if near and re.findall(r"\d+", near[0]) == re.findall(r"\d+", joint):
            found[joint] = near[0]
    return found


def _time_alike(columns: Sequence[Column]) -> str:
    """The column whose name is most like a time, or that has no name."""
    headers = [one.header for one in columns]
    return next((one for one in headers if _LIKE_TIME.search(one)), "column of times")


def _joints_alike(joints: Sequence[str], columns: Sequence[Column]) -> dict[str, str]:
    """A column for each joint: one whose name has the joint's in it, or one of as many numbered ones."""
    found = {joint: _column_alike(joint, columns) for joint in joints}
    if any(found.values()):
        return {joint: header for joint, header in found.items() if header}
    groups: dict[str, list[str]] = {}
    for one in columns:
        numbered = _NUMBERED.fullmatch(one.header)
        if numbered:
            groups.setdefault(numbered[1], []).append(one.header)
    alike = [names for names in groups.values() if len(names) == len(joints) > 1]
    alike.sort(key=lambda names: "actual_q_" not in names[0])  # as robots of UR log where they are
    columns_of = alike[0] if alike else [f"column of {joint}" for joint in joints]
    return dict(zip(joints, columns_of, strict=True))


def _column_alike(joint: str, columns: Sequence[Column]) -> str | None:
    """The column whose name contains the joint's, alone or with a word for position."""
    part = re.compile(rf"(?:.*[^a-z0-9])?{re.escape(joint)}(?:[^a-z0-9].*)?", re.IGNORECASE)
    headers = [one.header for one in columns if part.fullmatch(one.header)]
    positions = [one for one in headers if "pos" in one.lower().replace(joint.lower(), "")]
    headers = positions or [one for one in headers if one.lower().endswith(joint.lower())]
    return headers[0] if len(headers) == 1 else None


PARTS, ANGLES = ("/qx", "/qy", "/qz", "/qw"), ("/yaw", "/pitch", "/roll")

STEEPEST = np.radians(85.0)
"""[rad] Beyond this pitch yaw and roll jump between two samples though the body turns little."""


def turned_joints(names: Sequence[str], turns: Mapping[str, bool]) -> list[str]:
    """The joints with all four columns that the robot, if known, moves by yaw, pitch and roll."""
    stems = dict.fromkeys(name[: -len(PARTS[0])] for name in names if name.endswith(PARTS))
    return [
        stem
        for stem in stems
        if all(stem + part in names for part in PARTS)
        and (not turns or all(stem + angle in turns for angle in ANGLES))
    ]


def joints_by_angles(names: Sequence[str], turned: Sequence[str]) -> tuple[str, ...]:
    """The names, angles in place of the quaternions of some joints."""
    found: list[str] = []
    for name in names:
        stem = name[: -len(PARTS[0])] if name.endswith(PARTS) else ""
        if stem not in turned:
            found.append(name)
        elif name.endswith(PARTS[0]):
            found += [stem + angle for angle in ANGLES]
    return tuple(found)


def by_angles(
    values: np.ndarray, names: Sequence[str], turned: Sequence[str], table: TextTable
) -> tuple[np.ndarray, list[str]]:
    """(n, k) the values for the names of `joints_by_angles`, from the values for `names`; and notes.

    Angles go the shortest way from one sample to the next.

    Raises:
        BadPose: a quaternion that is not of length one, with its line. BadInput: a pitch of nearly a quarter turn.
    """
    columns = {name: values[:, i] for i, name in enumerate(names)}
    notes, n_rounded = [], 0
    for stem in turned:
        given = np.column_stack([columns[stem + part] for part in PARTS])
        refuse_off_length_one(given, table)
        unit, n_own = of_unit_length(given)
        angles = yaw_pitch_roll(unit)
        steep = np.flatnonzero(np.abs(angles[:, 1]) > STEEPEST)
        if len(steep):
            raise BadMotion(
                f"{stem!r} is pitched by {np.degrees(angles[steep[0], 1]):.1f} degrees, where yaw and roll are "
                "not distinct",
                where=f"line {line_of_row(table, int(steep[0]))}",
                valid="an obstacle that `moves` by a table of poses, and the robot's base on it",
            )
        columns |= zip((stem + angle for angle in ANGLES), np.unwrap(angles, axis=0).T, strict=True)
        n_rounded += n_own
    if turned:
        stems = listed([repr(stem) for stem in turned])
        notes.append(
            f"quaternions of {stems} are read as yaw, pitch and roll, each interpolated on its own"
        )
    found = [columns[name] for name in joints_by_angles(names, turned)]
    return np.column_stack(found), [*notes, *note_on_rounded(n_rounded)]

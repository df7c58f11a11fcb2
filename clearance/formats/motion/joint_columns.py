"""Which columns of a table are joints of a robot, which are mimic joints, and which to leave out; and columns
that hold a quaternion, for a joint that turns by yaw, pitch and roll.

A free base is logged as `base/qx` to `base/qw` where its joint `base` goes by `base/yaw`, `base/pitch` and
`base/roll`. Not for: reading the table (`tables`), nor tables of poses, which keep their quaternions.
"""

from __future__ import annotations

import re
from collections import defaultdict
from collections.abc import Collection, Mapping, Sequence
from difflib import get_close_matches

import numpy as np

from clearance.errors import BadMotion, BadPose, UnknownJoint
from clearance.formats.table.column_units import UNITS, VELOCITY, Column
from clearance.formats.table.csv_table import TIME, UNNAMED, TextTable, line_of_row
from clearance.formats.text.notes import note_on_rounded
from clearance.formats.text.yaml_text import flow
from clearance.geometry.quaternions import of_unit_length, yaw_pitch_roll
from clearance.tolerance import ROUNDED_ROTATION
from clearance.world.joint_positions import turns
from clearance.world.mimics import Follower, followers
from clearance.world.notice import listed
from clearance.world.robot import Robot, require_moving_joints
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
        known = {joint.name for joint in robot.joints}
        moving = [joint.name for joint in robot.moving_joints]
        unknown = next((name for name in joints if name not in known), "")
        meant = quantity(unknown, moving)
        said = f"did you mean {meant!r}?" if meant else error.valid
        if meant == unknown != "":
            said = "tables have positions and velocities of joints"
        error.valid = f"{said}; {remedy(robot, columns)}"
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
    others = [one.header for one in columns if one not in own]
    chosen = found | (_renamed(joints, found, others) if own else {})
    chosen = chosen or _joints_alike(joints, columns)
    chosen |= _rates(chosen, _by_quantity(others, joints))
    if own and times and chosen == found:
        mapping = flow([*times, *(one.header for one in own)])
        return f"columns: {mapping} reads these columns only (--columns)"
    mapping = flow({TIME: times[0] if times else _time_alike(columns)} | chosen)
    return f"columns: {mapping} maps each joint to its column (--columns)"


def left_out(robot: Robot, header: Sequence[str], columns: Sequence[Column]) -> list[str]:
    """Columns that are not read though they look like motion of the robot, each with what it looks like.

    Args:
        columns: those that are read.
    """
    joints = [joint.name for joint in robot.moving_joints]
    read = {one.name for one in columns}
    others = [name for name in header if name not in {one.header for one in columns}]
    alike = _by_quantity(others, joints) | _renamed(joints, read, others)
    missed = {name: given for name, given in alike.items() if name not in read}
    found = [f"{given!r} ({name})" for name, given in missed.items()]
    return found + [f"{name!r} (a base)" for name in _of_bases(others)]


_PLACES = ({"x", "y", "theta"}, {"x", "y", "yaw"}, {"trans_x", "trans_y", "trans_z"})
"""Variables of a planar or floating joint, by MoveIt's names and by those of this package."""


def _of_bases(headers: Sequence[str]) -> list[str]:
    """Columns of planar or floating joints, such as `world_joint/theta`."""
    own = defaultdict[str, set[str]](set)
    for joint, _, variable in (header.rpartition("/") for header in headers):
        own[joint].add(variable)
    bases = [
        joint for joint, found in own.items() if joint and any(one <= found for one in _PLACES)
    ]
    return [header for header in headers if header.rpartition("/")[0] in bases]


ACCELERATION = "/acceleration"

_ENDINGS = {"pos": "", "ang": "", "vel": VELOCITY, "speed": VELOCITY, "acc": ACCELERATION}
"""Of a joint's name, by how words of such columns begin."""

_OTHER = ("eff", "torque", "force", "curr", "temp", "target", "err", "status", "mode")
"""How words begin that say what is no motion."""


def quantity(header: str, joints: Sequence[str]) -> str:
    """What a column's name looks like: `j1`, `j1/velocity` or `j1/acceleration` of a joint; nothing for others."""
    for joint in sorted(joints, key=len, reverse=True):
        part = rf"(.*[^a-z0-9]|[dv])?{re.escape(joint)}([^a-z0-9].*|d|dot)?"
        found = re.fullmatch(part, header, re.IGNORECASE)
        if found:
            before, behind = (re.findall("[a-z]+", (one or "").lower()) for one in found.groups())
            words = [*before, *behind]
            endings = {VELOCITY for word in words if word in ("d", "v", "dot")}
            endings |= {_ENDINGS[one] for one in _ENDINGS for word in words if word.startswith(one)}
            if any(word.startswith(_OTHER) for word in words) or len(endings) > 1:
                return ""
            is_said = bool(endings) or UNITS.keys() >= {*behind}
            return joint + "".join(endings) if is_said else ""
    return ""


def _by_quantity(headers: Sequence[str], joints: Sequence[str]) -> dict[str, str]:
    """The column of each quantity that only one looks like."""
    said = [(quantity(header, joints), header) for header in headers]
    names = [name for name, _ in said]
    return {name: header for name, header in said if name and names.count(name) == 1}


def _renamed(
    joints: Sequence[str], found: Collection[str], others: Sequence[str]
) -> dict[str, str]:
    """The column of each joint that has none, but one that looks like it or is misspelt."""
    unfound = [joint for joint in joints if joint not in found]
    alike = _by_quantity(others, joints)
    return _misspelt(unfound, others) | {one: alike[one] for one in unfound if one in alike}


def _rates(chosen: Mapping[str, str], alike: Mapping[str, str]) -> dict[str, str]:
    """The columns of velocities, if all joints that are chosen have one."""
    rates = [name + VELOCITY for name in chosen if not name.endswith(VELOCITY)]
    if not all(name in alike or name in chosen for name in rates):
        return {}
    return {name: alike[name] for name in rates if name not in chosen}


def _misspelt(joints: Sequence[str], headers: Sequence[str]) -> dict[str, str]:
    """The column for each joint that has none but is spelt nearly like one, with the same numbers."""
    found = {}
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
    alike = _by_quantity([one.header for one in columns], joints)
    found = {joint: alike[joint] for joint in joints if joint in alike}
    if found:
        return found
    groups: dict[str, list[str]] = {}
    for one in columns:
        numbered = _NUMBERED.fullmatch(one.header)
        if numbered:
            groups.setdefault(numbered[1], []).append(one.header)
    numbers = [names for names in groups.values() if len(names) == len(joints) > 1]
    numbers.sort(
        key=lambda names: "actual_q_" not in names[0]
    )  # as robots of UR log where they are
    columns_of = numbers[0] if numbers else [f"column of {joint}" for joint in joints]
    return dict(zip(joints, columns_of, strict=True))


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


def refuse_off_length_one(quaternions: np.ndarray, table: TextTable) -> None:
    """Nothing, if quaternions (n, 4) are of length one, or rounded to three digits or so.

    Raises:
        BadPose: with the line of the table.
    """
    with np.errstate(over="ignore"):
        lengths = np.linalg.norm(quaternions, axis=1)
    rows = np.flatnonzero(~(np.abs(lengths - 1.0) <= ROUNDED_ROTATION))
    if len(rows):
        row = int(rows[0])
        raise BadPose(
            f"the quaternion {quaternions[row].tolist()} has length {lengths[row]:.9g}",
            where=f"line {line_of_row(table, row)}",
            valid=f"qx,qy,qz,qw of length 1 within {ROUNDED_ROTATION:g}, the scalar last",
        )

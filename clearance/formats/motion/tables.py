"""CSV to a trajectory: a `time` column [s] and one column a joint, by name, in any order. And to a pose table:
columns `time` [s], `x,y,z` [m] and `qx,qy,qz,qw`.

A column `<joint>/velocity` [rad/s or m/s], named as ros2_control names its interfaces, gives the joint's velocity;
all joints have one or none. What is written otherwise (units, separators, no header, no times) is told in a note.
Not for: which joints the robot has (`case.motion_notes`), how a table is parsed (`csv_table`), nor where between
its rows a body is (`world.pose_table`).
"""

from __future__ import annotations

import re
from collections.abc import Sequence
from dataclasses import replace

import numpy as np

from clearance.errors import (
    BadMotion,
    BadPose,
    BadShape,
    BadSyntax,
    BadTime,
    MissingKey,
    UnknownKey,
    nearest_name,
)
from clearance.formats.motion.joint_columns import (
    by_angles,
    joints_by_angles,
    left_out,
    refuse_off_length_one,
    remedy,
    require_joints,
    turned_joints,
)
from clearance.formats.motion.requests import (
    PoseRequest,
    PoseSamples,
    ReadSamples,
    ReadTrajectory,
    TrajectoryRequest,
    samples_of,
)
from clearance.formats.schema.timed import Choice
from clearance.formats.table.column_units import (
    VELOCITY,
    Column,
    chosen_columns,
    columns_in,
    in_own_units,
    note_on_endings,
    note_on_units,
    notes_on_names,
    odd_degrees,
    with_time,
)
from clearance.formats.table.csv_table import (
    TIME,
    UNNAMED,
    TextTable,
    columns_of,
    first_row,
    header_of,
    line_of_row,
    refuse_standing_time,
    require_time,
)
from clearance.formats.table.table_start import as_written, notes_on_writing
from clearance.formats.text.file_start import POSE_COLUMNS
from clearance.tolerance import LARGEST
from clearance.world.trajectory import Trajectory


def read_csv(request: TrajectoryRequest) -> ReadTrajectory:
    """The samples in a CSV file; joints in the order of their position columns.

    Raises:
        BadSyntax, BadShape, MissingKey, DuplicateName, NotFinite, BadTime: with the line in the
        file. BadDimension: a velocity that no joint can have. BadInput: a unit that a joint cannot have.
    """
    choice = request.choice
    choice.refuse_others({"units", "joints", "period", "gaps", "columns"}, "a CSV table")
    table = as_written(request.opened, _names_given(choice))
    _refuse_numbers(table)
    header = header_of(table, "joint names")
    columns = _columns(header, request)
    if choice.period is None:
        _refuse_half_times(header, columns)
    joints = _joints(columns, request)
    turned = turned_joints(joints, request.turns)
    by_name = {column.name: column for column in columns}
    parts = [[TIME] * (choice.period is None), joints]
    if any(name.endswith(VELOCITY) for name in by_name):
        parts.append([joint + VELOCITY for joint in joints])
    wanted = [[by_name[name] for name in part] for part in parts]
    times, *moving = _values(table, header, wanted)
    if choice.period is not None:
        with np.errstate(over="ignore"):
            times = choice.period * np.arange(len(times), dtype=np.float64)[:, None]
    refuse_standing_time(times[:, 0], table)
    notes = [*_notes(table, choice), *notes_on_names(header, columns), *note_on_units(columns)]
    notes += note_on_endings([by_name[name] for name in joints], request.turns)
    odd = odd_degrees(moving[0][:, [by_name[name].unit == "deg" for name in joints]])
    if turned:
        moving[0], on_angles = by_angles(moving[0], joints, turned, table)
        joints, notes = joints_by_angles(joints, turned), [*notes, *on_angles]
    velocities = moving[1] if len(moving) > 1 else None
    trajectory = Trajectory(times[:, 0], joints, moving[0], velocities, odd=odd)
    if choice.columns is not None and request.robot is not None:
        unread = left_out(request.robot, header, columns)
        trajectory = replace(trajectory, unread=tuple(unread))
    return ReadTrajectory(trajectory, tuple(notes))


def _joints(columns: list[Column], request: TrajectoryRequest) -> tuple[str, ...]:
    """The names of the columns that are positions.

    Raises:
        MissingKey, BadInput: times or velocities that are missing, or are there twice. UnknownJoint: as
            `require_joints`. BadShape: no joint.
    """
    names = [column.name for column in columns]
    try:
        _require_times(names, request.choice)
    except MissingKey as error:
        if request.robot is not None and request.choice.columns is None:
            error.valid = (
                f"{remedy(request.robot, columns)}; or period: the seconds from row to row"
            )
        raise
    joints = tuple(name for name in names if name != TIME and not name.endswith(VELOCITY))
    if request.robot is not None:
        turned = turned_joints(joints, request.turns)
        require_joints(request.robot, joints_by_angles(joints, turned), columns)
    _refuse_unmatched_velocities(names)
    if request.joints_needed and not joints:
        raise BadShape("there is no joint column", valid="time and at least one joint are needed")
    return joints


def _columns(header: list[str], request: TrajectoryRequest) -> list[Column]:
    """What is meant of a header."""
    choice = request.choice
    if choice.columns is not None:
        return chosen_columns(header, choice.columns, request.turns, choice.unit_pair)
    nameless = [i for i, name in enumerate(header) if name.startswith(UNNAMED)]
    if request.robot is None and nameless:
        raise BadSyntax(f"column {nameless[0] + 1} of the header has no name")
    return with_time(columns_in(header, request.turns, choice.unit_pair), request.turns)


_PART_OF_SECOND = re.compile(r"(?:nano|n|micro|u|milli|m)s(?:ec(?:ond)?s?)?$")


def _refuse_half_times(header: Sequence[str], columns: Sequence[Column]) -> None:
    """Nothing, unless whole seconds and the rest of them are two columns, and no other one is the time."""
    times = {one.header for one in columns if one.name == TIME}
    plain = {re.sub(r"\s*[\[(].*", "", one).lower(): one for one in header}
    for name, rest in plain.items():
        stem = _PART_OF_SECOND.sub("", name)
        wholes = [plain.get(stem + ending) for ending in ("sec", "secs", "second", "seconds")]
        for whole in wholes if stem != name else ():
            if whole is not None and times <= {whole, rest}:
                raise BadTime(
                    f"columns {whole!r} and {rest!r} are a time together",
                    valid="a column time [s] in their place: their sum, as seconds + nanoseconds / 1e9",
                )


def _refuse_numbers(table: TextTable) -> None:
    """Nothing, if the first row does not begin with a number, or names are given."""
    row = first_row(table)
    if table.names is None and row and table.float_of(row[0]) is not None:
        raise MissingKey(
            f"the first row, {','.join(row)!r:.80}, begins with a number: there is no header",
            valid="joints: [the names of the columns beside time, in order] (--joints)",
        )


def _names_given(choice: Choice) -> tuple[str, ...] | None:
    """The columns of a table without a header; time comes first where nothing else is said."""
    if choice.joints is None:
        return None
    has_time = choice.period is not None or any(
        column.name == TIME for column in columns_in(choice.joints, {}, None)
    )
    return tuple(choice.joints) if has_time else (TIME, *choice.joints)


def _require_times(names: list[str], choice: Choice) -> None:
    if choice.period is None and choice.columns is not None and TIME not in names:
        raise MissingKey(f"`columns` names no {TIME!r}", valid=f"{TIME}: the column of times [s]")
    if choice.period is None:
        require_time(names, "joint names")
    elif TIME in names:
        raise BadMotion(
            f"there is a column {TIME!r}, and a period of {choice.period:g} s", valid="one of them"
        )


def _values(
    table: TextTable, header: list[str], parts: Sequence[Sequence[Column]]
) -> list[np.ndarray]:
    read = columns_of(table, header, [[one.header for one in part] for part in parts])
    for values, part in zip(read, parts, strict=True):
        in_own_units(values, part)
    return read


def _notes(table: TextTable, choice: Choice) -> list[str]:
    notes = notes_on_writing(table)
    if choice.joints is not None:
        notes.append(f"no header; the columns are {', '.join(table.names or ())}")
    if choice.period is not None:
        notes.append(f"no times; rows follow each other every {choice.period:g} s, from 0")
    return notes


def _refuse_unmatched_velocities(names: list[str]) -> None:
    joints = [name for name in names if name != TIME and not name.endswith(VELOCITY)]
    given = [name.removesuffix(VELOCITY) for name in names if name.endswith(VELOCITY)]
    known, moving = frozenset(joints), frozenset(given)
    for joint in given:
        if joint not in known:
            raise MissingKey(
                f"column {joint + VELOCITY!r} is the velocity of {joint!r}, which has no column",
                valid=nearest_name(joint, joints),
            )
    without = [joint for joint in joints if joint not in moving]
    if given and without:
        raise MissingKey(
            f"joint {without[0]!r} has no column {without[0] + VELOCITY!r}, joint {given[0]!r} has one",
            valid="velocities of all joints or of none",
        )


_POSITION, _QUATERNION = POSE_COLUMNS[1:4], POSE_COLUMNS[4:]
_SLIDES = dict.fromkeys(_POSITION, False)
"""Which columns are lengths, as `column_units` asks of joints: none turns."""


def read_csv_poses(request: PoseRequest) -> ReadSamples:
    """The samples in a CSV file.

    Raises:
        BadSyntax, BadShape, MissingKey, UnknownKey, DuplicateName, NotFinite, BadTime, BadPose: with the line.
        BadInput: a unit that a column cannot have.
    """
    table = as_written(request.opened)
    header = header_of(table, ", ".join(POSE_COLUMNS[1:]))
    columns = with_time(columns_in(header, _SLIDES, ("rad", request.length or "m")), _SLIDES)
    names = [column.name for column in columns]
    require_time(names, ", ".join(POSE_COLUMNS[1:]))
    _require_columns(names)
    by_name = {column.name: column for column in columns}
    for name in _QUATERNION:
        if by_name[name].unit is not None:
            fault = f"column {by_name[name].header!r} names a unit"
            raise BadMotion(fault, valid="a quaternion has none")
    parts = [[by_name[name] for name in part] for part in ([TIME], _POSITION, _QUATERNION)]
    times, positions, quaternions = _values(table, header, parts)
    refuse_standing_time(times[:, 0], table)
    _refuse_far(positions, table)
    refuse_off_length_one(quaternions, table)
    notes = (*notes_on_writing(table), *notes_on_names(header, columns), *note_on_units(columns))
    return samples_of(PoseSamples(times[:, 0], positions, quaternions), notes)


def _require_columns(names: list[str]) -> None:
    for name in POSE_COLUMNS:
        if name not in names:
            raise MissingKey(
                f"there is no column {name!r} in the header {','.join(names)!r:.80}",
                valid=f"a table of poses has the columns {','.join(POSE_COLUMNS)}",
            )
    for name in names:
        if name not in POSE_COLUMNS:
            raise UnknownKey(
                f"column {name!r} is not of a table of poses",
                valid=nearest_name(name, POSE_COLUMNS),
            )


def _refuse_far(positions: np.ndarray, table: TextTable) -> None:
    far = np.abs(positions).max(axis=1)
    rows = np.flatnonzero(far > LARGEST)
    if len(rows):
        raise BadPose(
            f"a position is {far[rows[0]]:g} m away",
            where=f"line {line_of_row(table, int(rows[0]))}",
            valid=f"{LARGEST:g} m or less",
        )

"""CSV to a pose table: columns `time` [s], `x,y,z` [m] and `qx,qy,qz,qw`, by name, in any order.

What is written otherwise (units, semicolons, decimal commas) is told in a note.
Not for: how a table is parsed (`csv_table`), nor where between its rows a body is (`world.pose_table`).
"""

from __future__ import annotations

import numpy as np

from clearance.errors import BadMotion, BadPose, MissingKey, UnknownKey, nearest_name
from clearance.formats.motion.requests import (
    PoseRequest,
    PoseSamples,
    ReadSamples,
    samples_of,
)
from clearance.formats.table.column_units import (
    columns_in,
    in_own_units,
    note_on_units,
    notes_on_names,
    with_time,
)
from clearance.formats.table.csv_table import (
    TIME,
    TextTable,
    columns_of,
    header_of,
    line_of_row,
    refuse_standing_time,
    require_time,
)
from clearance.formats.table.table_start import as_written, notes_on_writing
from clearance.formats.text.file_start import POSE_COLUMNS
from clearance.tolerance import LARGEST, ROUNDED_ROTATION

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
    wanted = [[column.header for column in part] for part in parts]
    times, positions, quaternions = columns_of(table, header, wanted)
    for values, part in zip((times, positions), parts, strict=False):
        in_own_units(values, part)
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

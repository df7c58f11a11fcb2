"""CSV to a pose table: columns `time` [s], `x,y,z` [m] and `qx,qy,qz,qw`, by name, in any order.

Not for: how a table is parsed (`csv_table`), nor where between its rows a body is (`world.pose_table`).
"""

from __future__ import annotations

import io

import numpy as np

from clearance.errors import BadPose, MissingKey, UnknownKey, at, nearest_name
from clearance.load.csv_table import (
    TIME,
    Opener,
    TextTable,
    columns_of,
    header_of,
    line_of_row,
    refuse_standing_time,
    require_time,
)
from clearance.tolerance import LARGEST, ROTATION
from clearance.world.pose_table import PoseTable

_POSITION, _QUATERNION = ("x", "y", "z"), ("qx", "qy", "qz", "qw")
COLUMNS = (TIME, *_POSITION, *_QUATERNION)


def read_pose_table(opened: Opener, n_bytes: int, shown: str) -> PoseTable:
    """The samples in a file.

    Args:
        opened: opens the file, `n_bytes` long, again and again.
        shown: the file's name, in errors too.

    Raises:
        BadSyntax, BadShape, MissingKey, UnknownKey, DuplicateName, NotFinite, BadTime, BadPose: with the line.
    """
    with at(shown):
        table = TextTable(opened)
        names = header_of(table, ", ".join(COLUMNS[1:]))
        require_time(names, ", ".join(COLUMNS[1:]))
        _require_columns(names)
        parts = [[TIME], _POSITION, _QUATERNION]
        times, positions, quaternions = columns_of(table, n_bytes, names, parts)
        refuse_standing_time(times[:, 0], table)
        _refuse_far(positions, table)
        _refuse_off_length_one(quaternions, table)
        return PoseTable(times[:, 0], positions, quaternions)


def parse_pose_table(data: bytes, shown: str) -> PoseTable:
    """The samples in the content of a file, as `read_pose_table` finds them in the file."""
    return read_pose_table(lambda: io.BytesIO(data), len(data), shown)


def _require_columns(names: list[str]) -> None:
    for name in COLUMNS:
        if name not in names:
            raise MissingKey(
                f"there is no column {name!r} in the header {','.join(names)!r:.80}",
                valid=f"a table of poses has the columns {','.join(COLUMNS)}",
            )
    for name in names:
        if name not in COLUMNS:
            raise UnknownKey(
                f"column {name!r} is not of a table of poses", valid=nearest_name(name, COLUMNS)
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


def _refuse_off_length_one(quaternions: np.ndarray, table: TextTable) -> None:
    with np.errstate(over="ignore"):
        lengths = np.linalg.norm(quaternions, axis=1)
    rows = np.flatnonzero(~(np.abs(lengths - 1.0) <= ROTATION))
    if len(rows):
        row = int(rows[0])
        raise BadPose(
            f"the quaternion {quaternions[row].tolist()} has length {lengths[row]:.9g}",
            where=f"line {line_of_row(table, row)}",
            valid=f"qx,qy,qz,qw of length 1 within {ROTATION:g}, the scalar last",
        )

"""CSV to a trajectory: a `time` column [s] and one column a joint, by name, in any order.

A column `<joint>/velocity` [rad/s or m/s], named as ros2_control names its interfaces, gives the joint's velocity;
all joints have one or none.

The table is parsed by pyarrow in one pass; only when something is wrong is the text gone through
again, slowly, to name the line. Not for: which joints the robot has (`trajectory_check`).
"""

from __future__ import annotations

import csv
import io
from collections.abc import Iterable, Iterator

import numpy as np

from clearance.errors import (
    BadShape,
    BadSyntax,
    BadTime,
    ClearanceError,
    DuplicateName,
    MissingKey,
    NotFinite,
    at,
    nearest_name,
)
from clearance.world.trajectory import Trajectory

_TIME = "time"
_VELOCITY = "/velocity"


def parse_trajectory(data: bytes, shown: str) -> Trajectory:
    """The samples in a CSV file; joints in the order of their position columns.

    Args:
        shown: the file's name in errors.

    Raises:
        BadSyntax, BadShape, MissingKey, DuplicateName, NotFinite, BadTime: with the line in the
        file. BadDimension: a velocity that no joint can have.
    """
    with at(shown):
        names = _header(data)
        table = _table(data, names)
        _refuse_not_finite(table, names, data)
        i_time = names.index(_TIME)
        times = np.ascontiguousarray(table[:, i_time])
        _refuse_standing_time(times, data)
        joints = tuple(name for name in names if name != _TIME and not name.endswith(_VELOCITY))
        positions = _columns(table, names, joints)
        velocities = None
        if len(joints) < len(names) - 1:
            velocities = _columns(table, names, [joint + _VELOCITY for joint in joints])
        return Trajectory(times, joints, positions, velocities)


def _columns(table: np.ndarray, names: list[str], wanted: Iterable[str]) -> np.ndarray:
    """(n, len(wanted)) the columns of these names."""
    return np.ascontiguousarray(table[:, [names.index(name) for name in wanted]])


def _header(data: bytes) -> list[str]:
    if not data.strip():
        raise BadSyntax(
            "the file is empty", valid=f"a header with {_TIME!r} and joint names is needed"
        )
    _, cells = next(_rows(data))
    names = [cell.strip() for cell in cells]
    for i, name in enumerate(names):
        if not name:
            raise BadSyntax(f"column {i + 1} of the header has no name")
        if name in names[:i]:
            raise DuplicateName(f"column {name!r} is there twice", valid="each column once")
    if _TIME not in names:
        raise MissingKey(
            f"there is no column {_TIME!r} in the header {','.join(names)!r:.80}",
            valid="the header names the columns, separated by commas: time and joint names",
        )
    if len(names) == 1:
        raise BadShape("there is no joint column", valid="time and at least one joint are needed")
    _refuse_unmatched_velocities(names)
    return names


def _refuse_unmatched_velocities(names: list[str]) -> None:
    joints = [name for name in names if name != _TIME and not name.endswith(_VELOCITY)]
    given = [name.removesuffix(_VELOCITY) for name in names if name.endswith(_VELOCITY)]
    for joint in given:
        if joint not in joints:
            raise MissingKey(
                f"column {joint + _VELOCITY!r} is the velocity of {joint!r}, which has no column",
                valid=nearest_name(joint, joints),
            )
    without = [joint for joint in joints if joint not in given]
    if given and without:
        raise MissingKey(
            f"joint {without[0]!r} has no column {without[0] + _VELOCITY!r}, joint {given[0]!r} has one",
            valid="velocities of all joints or of none",
        )


def _table(data: bytes, names: list[str]) -> np.ndarray:
    """(n, k) all cells, columns as in the header."""
    import pyarrow as pa
    from pyarrow import csv as arrow_csv

    keys = [str(i) for i in range(len(names))]
    types = arrow_csv.ConvertOptions(
        column_types=dict.fromkeys(keys, pa.float64()), null_values=[], strings_can_be_null=False
    )
    try:
        read = arrow_csv.read_csv(
            pa.py_buffer(data),
            arrow_csv.ReadOptions(column_names=keys, skip_rows=_header_line(data)),
            convert_options=types,
        )
    except pa.ArrowException as error:
        raise _fault_in_rows(data, names) or BadSyntax(f"not a table of numbers: {error}") from None
    if not len(read):
        raise BadShape("there are no rows below the header", valid="at least one row is needed")
    table = np.empty((len(read), len(names)))
    for i, column in enumerate(read.columns):
        table[:, i] = column.to_numpy()
    return table


def _fault_in_rows(data: bytes, names: list[str]) -> ClearanceError | None:
    """The first row that is not as many numbers as the header has names."""
    rows = _rows(data)
    next(rows)
    n_rows = 0
    for line, cells in rows:
        n_rows += 1
        where = f"line {line}"
        if len(cells) != len(names):
            return BadShape(
                f"{len(cells)} columns", where=where, valid=f"the header has {len(names)}"
            )
        for name, cell in zip(names, cells, strict=True):
            if not _is_number(cell):
                return BadSyntax(
                    f"{cell.strip()!r} in column {name!r} is not a number", where=where
                )
    if n_rows == 0:
        return BadShape("there are no rows below the header", valid="at least one row is needed")
    return None


def _is_number(cell: str) -> bool:
    try:
        float(cell)
    except ValueError:
        return False
    return "_" not in cell


def _refuse_not_finite(table: np.ndarray, names: list[str], data: bytes) -> None:
    finite = np.isfinite(table)
    if finite.all():
        return
    i_row, i_column = (int(i) for i in np.argwhere(~finite)[0])
    raise NotFinite(
        f"{table[i_row, i_column]} in column {names[i_column]!r}",
        where=f"line {_line_of_row(data, i_row)}",
        valid="a finite number is needed",
    )


def _refuse_standing_time(times: np.ndarray, data: bytes) -> None:
    late = np.flatnonzero(np.diff(times) <= 0)
    if not len(late):
        return
    i_row = int(late[0]) + 1
    raise BadTime(
        f"time {float(times[i_row])} follows {float(times[i_row - 1])}",
        where=f"line {_line_of_row(data, i_row)}",
        valid="time must increase from row to row",
    )


def _rows(data: bytes) -> Iterator[tuple[int, list[str]]]:
    """(line number, cells) of every row that is not blank; lines count from 1."""
    text = io.TextIOWrapper(io.BytesIO(data), encoding="utf-8-sig", newline="")
    reader = csv.reader(text)
    try:
        for cells in reader:
            if cells:
                yield reader.line_num, cells
    except UnicodeDecodeError:
        raise BadSyntax("the file is not UTF-8 text", valid="a CSV file is needed") from None
    except csv.Error as error:
        raise BadSyntax(f"not CSV: {error}", where=f"line {reader.line_num}") from None


def _header_line(data: bytes) -> int:
    """Number of lines up to and with the header."""
    line, _ = next(_rows(data))
    return line


def _line_of_row(data: bytes, i_row: int) -> int:
    rows = _rows(data)
    next(rows)
    for i, (line, _) in enumerate(rows):
        if i == i_row:
            return line
    raise AssertionError("a row that was parsed is gone")

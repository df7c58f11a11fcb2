"""Points as text: a row each, x, y, z and whatever else, with or without a header. CSV, XYZ and their like.

Cells are parted by commas, semicolons (then decimals may have commas) or blanks, as the first row shows. A row
that is longer or shorter than the first is refused; no count is stated, so that a file cut off between two rows
cannot be distinguished from a shorter one. Not for: how a table is parsed (`csv_table`).
"""

from __future__ import annotations

import io
import re
from collections.abc import Sequence

import numpy as np

from clearance.errors import BadInput, BadShape
from clearance.formats.cloud.formats import Points
from clearance.formats.table.column_units import Column, columns_in, in_own_units, note_on_units
from clearance.formats.table.csv_table import TextTable, columns_of, first_row, header_of
from clearance.formats.table.table_start import blanks_as_tabs
from clearance.formats.text.notes import counted

_LENGTHS = dict.fromkeys("xyz", False)
"""What has a length, for the units of columns."""


def read_points_text(data: bytes) -> Points:
    """The points in a table, those that are not finite too.

    Raises:
        BadSyntax, BadShape, DuplicateName, BadInput: with the line.
    """
    content = _without_remarks(data)
    table = _as_written(content)
    first = first_row(table)
    if not first:
        raise BadShape("there are no rows", valid="at least one: x, y, z")
    has_header = table.float_of(first[0]) is None
    if not has_header:
        others = (f"column {i}" for i in range(4, len(first) + 1))
        table = table._replace(names=(*"xyz"[: len(first)], *others))
    header = header_of(table, "y, z")
    if len(header) < 3:
        line = 1 + next(i for i, row in enumerate(content.splitlines()) if row.strip())
        raise BadShape(
            counted(len(header), "column"),
            where=f"line {line}",
            valid="three or more: x, y, z; remove a line that is the count of points",
        )
    of_axes = _axes(header)
    chosen = [header[i] for i, _ in of_axes]
    (places,) = columns_of(table, header, [chosen], finite=False)
    columns = [column for _, column in of_axes]
    in_own_units(places, columns)
    notes = note_on_units(columns)
    if not has_header and len(header) > 3:  # some tables begin with a number of the point
        _refuse_counter(places[:, 0])
        guess = "the first three are taken for x, y and z"
        notes = [f"no header names its {len(header)} columns: {guess}", *notes]
    return Points(places, tuple(notes), columns[0].unit is not None)


def _refuse_counter(first: np.ndarray) -> None:
    """Refuses x of a table without a header that are numbers of its rows."""
    if len(first) > 2 and (np.diff(first) == 1.0).all():
        raise BadInput(
            "no header names its columns, and its first column counts the rows",
            valid="a header that names x, y and z, as 'number x y z'",
        )


_REMARKS = b"#", b"//"

_AXIS = re.compile(rb"([xyz])(?:[^a-z].*)?", re.IGNORECASE)


def _header_in_remark(lines: Sequence[bytes]) -> tuple[int, bytes] | None:
    """The remark above the first row, if it names as many columns, x, y and z among them; with these names."""
    rows = ((i, line.strip()) for i, line in enumerate(lines) if line.strip())
    last, first = None, b""
    for i, line in rows:
        if not line.startswith(_REMARKS):
            first = line
            break
        last = i
    if last is None:
        return None
    names = _cells(lines[last].strip().lstrip(b"#/"))
    axes = {found[1].lower() for name in names if (found := _AXIS.fullmatch(name))}
    if len(axes) < 3 or len(names) != len(_cells(first)):
        return None
    mark = next((mark for mark in (b";", b",") if mark in first), b" ")
    return last, mark.join(names)


def _cells(row: bytes) -> list[bytes]:
    """The cells of a row, whatever is between them."""
    parts = re.split(rb"[;\t]" if b";" in row else rb"[,\t]", row.strip())
    return [one.strip() for one in parts] if len(parts) > 1 else row.split()


def _without_remarks(data: bytes) -> bytes:
    """The content, each line that is a remark empty in its place, but for one that names the columns; labels of
    any encoding are text.
    """
    lines = data.removeprefix(b"\xef\xbb\xbf").splitlines()
    header = _header_in_remark(lines)
    lines = [b"" if line.lstrip().startswith(_REMARKS) else line for line in lines]
    if header is not None:
        lines[header[0]] = header[1]
    content = b"\n".join(lines)
    return content.decode("utf-8", errors="replace").encode()


def _as_written(content: bytes) -> TextTable:
    """The table with the separators that its first row shows."""
    first = content.lstrip().partition(b"\n")[0]

    def opened() -> io.BytesIO:
        return io.BytesIO(content)

    if b";" in first:
        return TextTable(opened, ";", "," if b"," in content else ".")
    return (
        TextTable(opened) if b"," in first or not first else TextTable(blanks_as_tabs(opened), "\t")
    )


def _axes(header: Sequence[str]) -> list[tuple[int, Column]]:
    """The columns of x, y and z, and where they are.

    Raises:
        BadShape: one is missing. BadInput: some name a unit, or one that no length has.
    """
    names = [name.lower() if name.lower() in _LENGTHS else name for name in header]
    columns = columns_in(names, _LENGTHS, None)
    found = [_axis(columns, axis) for axis in "xyz"]
    if len({column.unit is None for _, column in found}) > 1:
        raise BadInput("some of x, y and z name a unit", valid="units of all three, or of none")
    return found


def _axis(columns: Sequence[Column], axis: str) -> tuple[int, Column]:
    for i, column in enumerate(columns):
        if column.name.lower() == axis:
            return i, column
    shown = ",".join(column.header for column in columns)
    raise BadShape(f"there is no column {axis!r} in the header {shown!r:.80}", valid="x, y and z")

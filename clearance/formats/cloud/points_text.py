"""Points as text: a row each, x, y, z and whatever else, with or without a header. CSV, XYZ and their like.

Cells are parted by commas, semicolons (then decimals may have commas) or blanks, as the first row shows. A row
that is longer or shorter than the first is refused; no count is stated, so that a file cut off between two rows
cannot be told from a shorter one. Not for: tables over time (`csv_table`).
"""

from __future__ import annotations

import itertools
from collections.abc import Iterator, Sequence
from typing import NamedTuple

import numpy as np

from clearance.errors import BadInput, BadShape, BadSyntax, at
from clearance.formats.cloud.points import Points
from clearance.formats.table.column_units import Column, columns_in, in_own_units, note_on_units
from clearance.formats.text.numbers import floats

AT_ONCE = 1 << 16
"""Rows that are taken apart together."""

_LENGTHS = dict.fromkeys("xyz", False)
"""What has a length, for the units of columns."""


class _RowFormat(NamedTuple):
    """How the rows are written: what parts the cells (None for blanks), and whether decimals have commas."""

    delimiter: bytes | None
    has_commas: bool

    def cells(self, line: bytes) -> list[bytes]:
        """Those of a row."""
        cells = line.split(self.delimiter)
        if self.delimiter is not None:
            cells = [cell.strip() for cell in cells]
        if not self.has_commas:
            return cells
        if any(b"." in cell for cell in cells):
            raise BadSyntax("a point among decimal commas", valid="one of both in a file")
        return [cell.replace(b",", b".") for cell in cells]


def read_points_text(data: bytes) -> Points:
    """The points in a table.

    Raises:
        BadSyntax, BadShape, DuplicateName, BadInput: with the line.
    """
    lines = _lines(data)
    first = next(lines, None)
    if first is None:
        raise BadShape("there are no rows", valid="at least one: x, y, z")
    i_line, line = first
    written = _written(line, data)
    header = _header(written, line)
    columns = _columns(header) if header else [Column(name, name) for name in "xyz"]
    if header is None:
        lines = itertools.chain([first], lines)
    n_cells = len(written.cells(line)) if header is None else len(header)
    if n_cells < 3:
        raise BadShape(f"{n_cells} columns", where=f"line {i_line}", valid="three or more: x, y, z")
    names = [name.header for name in columns]
    chosen = [names.index(_of(columns, axis).header) for axis in "xyz"]
    places = np.concatenate([np.empty((0, 3)), *_blocks(lines, written, n_cells, chosen)])
    if not len(places):
        raise BadShape("there are no rows below the header", valid="at least one: x, y, z")
    of_axes = [_of(columns, axis) for axis in "xyz"]
    in_own_units(places, of_axes)
    notes = [*_on_more_columns(header, n_cells), *note_on_units(of_axes)]
    return Points(places, tuple(notes), of_axes[0].unit is not None)


def _on_more_columns(header: list[str] | None, n_cells: int) -> Iterator[str]:
    """A note where it is a guess which columns are x, y and z: some tables begin with a number of the point."""
    if header is None and n_cells > 3:
        yield f"no header names its {n_cells} columns: the first three are taken for x, y and z"


def _lines(data: bytes) -> Iterator[tuple[int, bytes]]:
    """Number and content of each line that is not blank and no remark."""
    for i, line in enumerate(data.removeprefix(b"\xef\xbb\xbf").splitlines(), start=1):
        stripped = line.strip()
        if stripped and not stripped.startswith((b"#", b"//")):
            yield i, stripped


def _written(first: bytes, data: bytes) -> _RowFormat:
    if b";" in first:
        return _RowFormat(b";", b"," in data)
    return _RowFormat(b"," if b"," in first else None, False)


def _header(written: _RowFormat, line: bytes) -> list[str] | None:
    """The names in the first row, if it has names."""
    cells = line.split(written.delimiter)
    try:
        floats(written.cells(line)[:1])
        return None
    except BadSyntax:
        return [cell.decode("utf-8", errors="replace").strip().strip('"') for cell in cells]


def _columns(header: Sequence[str]) -> list[Column]:
    columns = columns_in(
        [name.lower() if name.lower() in _LENGTHS else name for name in header], _LENGTHS, None
    )
    if len({_of(columns, axis).unit is None for axis in "xyz"}) > 1:
        raise BadInput("some of x, y and z name a unit", valid="units of all three, or of none")
    return columns


def _of(columns: Sequence[Column], axis: str) -> Column:
    for column in columns:
        if column.name.lower() == axis:
            return column
    shown = ",".join(column.header for column in columns)
    raise BadShape(f"there is no column {axis!r} in the header {shown!r:.80}", valid="x, y and z")


def _blocks(
    lines: Iterator[tuple[int, bytes]], written: _RowFormat, n_cells: int, chosen: Sequence[int]
) -> Iterator[np.ndarray]:
    while block := list(itertools.islice(lines, AT_ONCE)):
        rows = [_row(line, where, written, n_cells) for where, line in block]
        try:
            yield np.stack([floats([row[i] for row in rows]) for i in chosen], axis=1)
        except BadSyntax:
            for (where, _), row in zip(block, rows, strict=True):
                with at(f"line {where}"):
                    floats([row[i] for i in chosen])
            raise


def _row(line: bytes, where: int, written: _RowFormat, n_cells: int) -> list[bytes]:
    with at(f"line {where}"):
        cells = written.cells(line)
        if len(cells) != n_cells:
            raise BadShape(f"{len(cells)} columns", valid=f"the first row has {n_cells}")
        return cells

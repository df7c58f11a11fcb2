"""CSV tables of numbers: a header with a `time` column [s] and others, by name, in any order.

The table is parsed by numpy in one pass, block by block, so that memory holds its numbers and never
its text; only when something is wrong is the text gone through again, slowly, to name the line. Not
for: what the columns are (`motion.tables`).
"""

from __future__ import annotations

import csv
import io
from codecs import BOM_UTF8
from collections.abc import Callable, Iterable, Iterator, Sequence
from itertools import chain, islice
from typing import BinaryIO, NamedTuple

import numpy as np

from clearance.errors import (
    BadShape,
    BadSyntax,
    BadTime,
    ClearanceError,
    DuplicateName,
    MissingKey,
    NotFinite,
)
from clearance.world.names import checked_name

TIME = "time"

EMPTY = ""
"""The name of a column behind a separator at the end of each row, which holds nothing."""

Opener = Callable[[], BinaryIO]
"""Opens a file for reading from its start."""

BLOCK = 16_384
"""Rows that are parsed at a time."""

UNNAMED = "(column "
"""How the name of a column without one begins; its place follows."""


_NO_BLANKS = dict.fromkeys(map(ord, "\v\f\x1c\x1d\x1e\x1f"), "\0")
"""Blanks round a number to numpy and Python; in a table they are none, and a number with one is refused."""


class TextTable(NamedTuple):
    """A file with a table, and how it is written.

    Attributes:
        opened: opens it, again and again. names: of its columns, where it has no header.
        above: the lines above the table, which are passed over.
    """

    opened: Opener
    delimiter: str = ","
    decimal: str = "."
    names: tuple[str, ...] | None = None
    above: tuple[bytes, ...] = ()

    def float_of(self, cell: str) -> float | None:
        """The number in a cell, or None."""
        if "_" in cell or not cell.isascii() or (self.decimal != "." and "." in cell):
            return None
        try:
            return float(cell.translate(_NO_BLANKS).replace(self.decimal, "."))
        except ValueError:
            return None


def first_row(table: TextTable) -> list[str]:
    """The cells of the first row that is not blank, none where there is none."""
    return [cell.strip() for cell in next(_rows(table), (0, []))[1]]


def header_of(table: TextTable, others: str) -> list[str]:
    """The names of the columns, each once; `EMPTY` last where each row ends with a separator.

    One without a name, as that of a row's number, is called `(column 1)` by its place, and a joint of that name
    is none.

    Args:
        others: what the columns beside `time` are, for errors.

    Raises:
        BadSyntax, DuplicateName: with the column.
    """
    if table.names is not None:
        return _as_the_first_row(table, table.names)
    names = first_row(table)
    if not any(names):
        raise BadSyntax("the file is empty", valid=f"a header with {TIME!r} and {others} is needed")
    names[0] = names[0].lstrip("#%").lstrip()  # as programs write that mark what is no number
    if len(names) > 1 and not names[-1]:
        names.pop()
    seen: set[str] = set()
    for i, name in enumerate(names):
        if not name:
            name = names[i] = f"{UNNAMED}{i + 1})"
        if name in seen:
            raise DuplicateName(f"column {name!r} is there twice", valid="each column once")
        seen.add(name)
        checked_name(name)
    return _as_the_first_row(table, names)


def _as_the_first_row(table: TextTable, names: Sequence[str]) -> list[str]:
    """The names, and that of an empty column where the first row of numbers ends with one more."""
    _, cells = next(_data_rows(table), (0, []))
    ends_empty = len(cells) == len(names) + 1 and not cells[-1].strip()
    return [*names, EMPTY] if ends_empty else [*names]


def require_time(names: Sequence[str], others: str) -> None:
    """Nothing, if one of the columns is `time`.

    Raises:
        MissingKey: none is.
    """
    if TIME not in names:
        raise MissingKey(
            f"there is no column {TIME!r} in the header {','.join(names)!r:.80}",
            valid=f"the first line names the columns, separated by commas: time and {others}",
        )


def columns_of(
    table: TextTable,
    names: list[str],
    parts: Sequence[Sequence[str]],
    *,
    finite: bool = True,
) -> list[np.ndarray]:
    """For each of `parts` the (n, len(part)) columns of its names.

    Args:
        names: of all columns of the file. finite: False to take NaN and infinity too.

    Raises:
        BadShape, BadSyntax, NotFinite: with the line in the file.
    """
    wanted = list(dict.fromkeys(name for part in parts for name in part))
    blocks: list[list[np.ndarray]] = [[] for _ in parts]
    for block in _blocks(table, names, wanted):
        for arrays, part in zip(blocks, parts, strict=True):
            columns = [block[str(names.index(name))] for name in part]
            arrays.append(np.stack(columns, axis=1) if part else np.empty((len(block), 0)))
    if not blocks[0]:
        raise _no_rows()
    found = [np.concatenate(arrays) for arrays in blocks]
    if finite:
        _refuse_not_finite(found, parts, names, table)
    return found


def _blocks(table: TextTable, names: list[str], wanted: list[str]) -> Iterator[np.ndarray]:
    """All rows, so many at a time; columns are fields, called by their places. Those wanted are numbers."""
    kinds = [(str(i), "f8" if name in wanted else "U1") for i, name in enumerate(names)]
    swap = _NO_BLANKS | (str.maketrans(",.", ".,") if table.decimal == "," else {})
    try:
        with table.opened() as file:
            if file.read(3) != BOM_UTF8:
                file.seek(0)
            text = io.TextIOWrapper(file, "ascii", "surrogateescape", newline="")  # as numbers are
            rows = _closed_quotes(text, _n_above(table))
            lines = (line.translate(swap) for line in rows if line.strip("\r\n"))
            for first in lines:
                block = chain([first], islice(lines, BLOCK - 1))
                yield np.loadtxt(
                    block, kinds, comments=None, delimiter=table.delimiter, quotechar='"', ndmin=1
                )
    except ClearanceError:
        raise
    except ValueError as error:
        raise _fault_in_rows(table, names, wanted) or BadSyntax(
            f"not a table of numbers: {error}"
        ) from None


def _closed_quotes(text: Iterable[str], n_above: int) -> Iterator[str]:
    """The lines below the header.

    Raises:
        BadSyntax: a quotation mark is not closed in its line, so that the rows below would be part of one cell.
    """
    for number, line in enumerate(islice(text, n_above, None), n_above + 1):
        if line.count('"') % 2:
            raise BadSyntax(
                "a quotation mark is not closed",
                where=f"line {number}",
                valid="two marks round a cell, in one line",
            )
        yield line


def _no_rows() -> ClearanceError:
    return BadShape("there are no rows below the header", valid="at least one row is needed")


def _fault_in_rows(
    table: TextTable, names: list[str], wanted: Sequence[str]
) -> ClearanceError | None:
    """The first row that is not as many cells as the header has names, with numbers where they are wanted."""
    rows = _data_rows(table)
    has_header = table.names is None
    given = "the header has" if has_header else "there are"
    n_rows = 0
    for line, cells in rows:
        n_rows += 1
        where = f"line {line}"
        if len(cells) != len(names):
            return BadShape(
                f"{len(cells)} columns",
                where=where,
                valid=f"{given} {len(names)}{'' if has_header else ' names'}",
            )
        for name, cell in zip(names, cells, strict=True):
            if name in wanted and table.float_of(cell) is None:
                valid = "decimals have commas in this file" if table.decimal == "," else ""
                return BadSyntax(
                    f"{cell.strip(' ')!r} in column {name!r} is not a number",
                    where=where,
                    valid=valid,
                )
    return None if n_rows else _no_rows()


def _refuse_not_finite(
    found: list[np.ndarray], parts: Sequence[Sequence[str]], names: list[str], table: TextTable
) -> None:
    bad = []
    for columns, part in zip(found, parts, strict=True):
        least = np.flatnonzero(~np.isfinite(columns).all(axis=1))[:1].tolist()
        bad += [
            (row, names.index(part[i]), columns[row, i]) for row in least for i in range(len(part))
        ]
    wrong = [(row, column, value) for row, column, value in bad if not np.isfinite(value)]
    if not wrong:
        return
    i_row, i_column, value = min(wrong, key=lambda cell: cell[:2])
    raise NotFinite(
        f"{value} in column {names[i_column]!r}",
        where=f"line {line_of_row(table, i_row)}",
        valid="a finite number is needed",
    )


def refuse_standing_time(times: np.ndarray, table: TextTable) -> None:
    """Nothing, if times increase from row to row.

    Raises:
        BadTime: with the line in the file.
    """
    late = np.flatnonzero(np.diff(times) <= 0)
    if not len(late):
        return
    i_row = int(late[0]) + 1
    raise BadTime(
        f"time {float(times[i_row])} follows {float(times[i_row - 1])}",
        where=f"line {line_of_row(table, i_row)}",
        valid="time must increase from row to row",
    )


def _rows(table: TextTable) -> Iterator[tuple[int, list[str]]]:
    """(line number, cells) of every row that is not blank; lines count from 1."""
    with table.opened() as file:
        text = io.TextIOWrapper(file, encoding="utf-8-sig", newline="")
        n_above = len(table.above)
        reader = csv.reader(islice(text, n_above, None), delimiter=table.delimiter)
        try:
            for cells in reader:
                if cells:
                    yield n_above + reader.line_num, cells
        except UnicodeDecodeError:
            raise BadSyntax("the file is not UTF-8 text", valid="a CSV file is needed") from None
        except csv.Error as error:
            raise BadSyntax(
                f"not CSV: {error}", where=f"line {n_above + reader.line_num}"
            ) from None


def _data_rows(table: TextTable) -> Iterator[tuple[int, list[str]]]:
    """Those below the header."""
    rows = _rows(table)
    if table.names is None:
        next(rows)
    return rows


def _n_above(table: TextTable) -> int:
    """Number of lines up to and with the header."""
    return len(table.above) if table.names is not None else next(_rows(table))[0]


def line_of_row(table: TextTable, i_row: int) -> int:
    """The line of the file that a row, counted from 0, is on."""
    for i, (line, _) in enumerate(_data_rows(table)):
        if i == i_row:
            return line
    raise AssertionError("a row that was parsed is gone")

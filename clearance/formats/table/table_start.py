"""How a table is written, by its first lines: comments above, a header or none, separators and decimals.

Not for: its rows (`csv_table`), nor what its columns are (`column_units`).
"""

from __future__ import annotations

import io
import re
from codecs import BOM_UTF8

from clearance.formats.table.csv_table import Opener, TextTable
from clearance.world.notice import listed

_SEPARATORS = {";": "semicolons", "\t": "tabs or blanks"}
"""Beside commas."""


def as_written(opened: Opener, names: tuple[str, ...] | None = None) -> TextTable:
    """The table with the separators that it shows: semicolons, or else tabs, where the first row has some and, in
    a header, no commas; then decimal commas where there is any comma. Without any of these, blanks are tabs.

    Args:
        names: of the columns, where there is no header.
    """
    above = _above(opened, names)
    with opened() as file:
        file.seek(sum(map(len, above)))
        start = file.read(65536).removeprefix(BOM_UTF8).lstrip().partition(b"\n")[0]
        if _is_of_blanks(start):
            return as_written(blanks_as_tabs(opened, len(above)), names)._replace(above=above)
        others = [mark for mark in _SEPARATORS if mark.encode() in start]
        if not others or (names is None and b"," in start):
            return TextTable(opened, names=names, above=above)
        file.seek(sum(map(len, above)))
        has_comma = any(b"," in chunk for chunk in iter(lambda: file.read(1 << 20), b""))
    return TextTable(opened, others[0], "," if has_comma else ".", names, above)


MARKS = b"#", b"%"
"""How a comment begins, and the header of programs that mark what is no number."""


def _above(opened: Opener, names: tuple[str, ...] | None) -> tuple[bytes, ...]:
    """The lines to pass over: those that are marked, above a header; the last one is the header itself where
    numbers follow it.
    """
    lines: list[bytes] = []
    last = 0
    with opened() as file:
        for line in iter(lambda: file.readline(65536), b""):
            row = line.removeprefix(b"" if lines else BOM_UTF8).strip()
            if row and not row.startswith(MARKS):
                is_header = names is not None or not _has_number(row)
                any_marked = any(one.strip() for one in lines)
                return tuple(lines if is_header and any_marked else lines[:last])
            last = len(lines) if row else last
            lines.append(line)
    return tuple(lines[:last])


def _has_number(row: bytes) -> bool:
    """True if a cell is a number, as in no header."""
    cells = re.split(rb"[,;\t]", row)
    plain = TextTable(io.BytesIO)
    words = cells if len(cells) > 1 else row.split()
    return any(
        plain.float_of(word.decode("ascii", "replace").strip()) is not None for word in words
    )


def _is_of_blanks(start: bytes) -> bool:
    """True for a first row of words without any separator; `time [s]` is one column."""
    words = start.split()
    marked = any(mark in start.rstrip() for mark in (b",", b";", b"\t"))
    return (
        len(words) > 1 and not marked and not any(word.startswith((b"[", b"(")) for word in words)
    )


def blanks_as_tabs(opened: Opener, n_comments: int = 0) -> Opener:
    """The same file, a tab for each stretch of blanks; comments above are blank lines, and the mark of one stays
    out of the first row.
    """
    with opened() as file:
        for _ in range(n_comments):
            file.readline()
        lines = b"\n" * n_comments + file.read().replace(b"\r\n", b"\n").replace(b"\r", b"\n")
    content = re.sub(rb"[ \t]+", b"\t", re.sub(rb"(?m)^[ \t]+|[ \t]+$", b"", lines))
    marked = re.match(rb"(\s*)[#%]\t", content)
    if marked:
        content = marked[1] + content[marked.end() :]
    return lambda: io.BytesIO(content)


def notes_on_writing(table: TextTable) -> list[str]:
    """Lines on comments above, and on columns that are separated otherwise than by commas."""
    said = [line.decode("utf-8", "replace").strip("\ufeff#% \t\r\n") for line in table.above]
    shown = listed([f"{one!r:.60}" for one in said if one])
    notes = [f"above the header, passed over: {shown}"] if shown else []
    if table.delimiter == ",":
        return notes
    decimals = ", decimals written with commas" if table.decimal == "," else ""
    return [*notes, f"columns are separated by {_SEPARATORS[table.delimiter]}{decimals}"]

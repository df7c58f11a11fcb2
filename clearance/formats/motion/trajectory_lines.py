"""The line of a trajectory file that a sample is on. Not for: reading the file (`trajectory_file`)."""

from __future__ import annotations

from pathlib import Path

from clearance.formats.known_formats import Kind, format_of
from clearance.formats.table.csv_table import as_written, first_row, line_of_row


def line_of_sample(path: str, sample: int) -> int | None:
    """The line, from 1, of a sample, from 0; None in a file that is no table, or has no such row any more."""
    known = format_of(Kind.TRAJECTORY, path)
    if known is None or known.name != "CSV" or not Path(path).is_file():
        return None
    table = as_written(lambda: open(path, "rb"))
    try:
        if table.float_of("".join(first_row(table)[:1])) is not None:
            table = table._replace(names=("",))  # the first row is numbers: there is no header
        return line_of_row(table, sample)
    except (AssertionError, ValueError):  # it was written anew since it was read
        return None

"""The rows of one part of the benchmark of gains, by case, in a file: what is in it is not done again.

Not for: what the rows come to (`gain_summary`).
"""

from __future__ import annotations

import csv
from collections.abc import Iterator, Sequence
from pathlib import Path
from typing import Any

from rows import write_csv

Row = dict[str, Any]


class Journal:
    """Rows by the number of their case; each that is added is on disk at once, in place of what was there of it.

    Args:
        columns: of which "case" is one.
    """

    def __init__(self, file: Path, columns: Sequence[str]) -> None:
        self.file, self.columns = file, columns
        self.rows: dict[int, Row] = {}
        if file.exists():
            with file.open(encoding="utf-8", newline="") as lines:
                found = [{k: _value(v) for k, v in row.items()} for row in csv.DictReader(lines)]
            self.rows = {int(row["case"]): row for row in found}

    def add(self, row: Row) -> None:
        """Keeps a row."""
        self.rows[int(row["case"])] = row
        beside = self.file.with_suffix(".new")
        write_csv([*self], self.columns, beside)
        beside.replace(self.file)

    def __iter__(self) -> Iterator[Row]:
        return (self.rows[number] for number in sorted(self.rows))


def _value(text: str) -> Any:
    """What a cell stands for: nothing, a truth, a number, or its text."""
    if text in ("", "True", "False"):
        return {"": None, "True": True, "False": False}[text]
    try:
        return float(text)
    except ValueError:
        return text

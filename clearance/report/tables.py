"""The steps as files: one row a step, every float written so that reading it gives the same float
again."""

from __future__ import annotations

from pathlib import Path

import pyarrow as pa


def write_parquet(steps: pa.Table, path: Path) -> None:
    """Writes the steps table as Parquet."""
    import pyarrow.parquet

    pyarrow.parquet.write_table(steps, path)


def write_csv(steps: pa.Table, path: Path) -> None:
    """Writes the steps table as CSV with a header; names are quoted only where one of them needs
    it."""
    try:
        _write_csv(steps, path, "none")
    except pa.ArrowInvalid:  # a name with a comma, a quote or a line break
        _write_csv(steps, path, "needed")


def _write_csv(steps: pa.Table, path: Path, quoting: str) -> None:
    import pyarrow.csv

    body = pyarrow.csv.WriteOptions(include_header=False, quoting_style=quoting)
    with path.open("wb") as file:
        file.write((",".join(steps.column_names) + "\n").encode())
        pyarrow.csv.write_csv(steps, file, body)

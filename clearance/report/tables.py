"""The steps as files: one row a step, every float written so that reading it gives the same float
again."""

from __future__ import annotations

from pathlib import Path

import pyarrow as pa

from clearance.simulate.record import Record


def contact_table(record: Record) -> pa.Table:
    """One row for each pair in contact at each step; lengths in metres, directions of the link, world frame."""
    rows = record.contacts
    found = [row.found for row in rows]
    columns = {
        "step": pa.array([row.step for row in rows], pa.int64()),
        "time": pa.array([row.time for row in rows], pa.float64()),
        "link": pa.array([row.link for row in rows], pa.string()),
        "obstacle": pa.array([row.obstacle for row in rows], pa.string()),
    }
    for name in ("penetration", "penetration_at_least", "volume", "volume_at_least"):
        columns[name] = pa.array([getattr(one, name) for one in found], pa.float64())
    for name in ("direction", "centroid"):
        for i, axis in enumerate("xyz"):
            values = [float(getattr(one, name)[i]) for one in found]
            columns[f"{name}_{axis}"] = pa.array(values, pa.float64())
    return pa.table(columns)


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

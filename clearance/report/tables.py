"""The tables of a report as files, every float written so that reading it gives the same float again.

There is a row a step, a pair in contact at a step, and an error of a moment at which the tolerances leave least.
Moments of a rule stand together, what takes most first. Lengths in metres.
"""

from __future__ import annotations

from collections.abc import Callable, Iterable, Iterator, Mapping, Sequence
from contextlib import ExitStack
from pathlib import Path
from typing import Any, NamedTuple

from clearance.budget.columns import with_proven_between
from clearance.record.budget import BudgetMoment, ErrorSource, RuleBudget
from clearance.record.contact import StepContact
from clearance.record.contact_columns import with_contact_columns
from clearance.record.names import LINK_AND_OBSTACLE, SIDES
from clearance.record.record import Record
from clearance.record.rows.blocks import blocks
from clearance.record.rows.resumable import IN_MEMORY, MeasuredRows
from clearance.record.table import pa

CONTACTS = 10_000
"""Overlaps that are written at a time."""


def contact_batches(record: Record) -> Iterator[pa.Table]:
    """One row for each pair in contact at each step, under the names of bodies that the steps have; lengths in
    metres, directions of the first body, world frame; null where the run has not worked out a pair at a step."""
    for start in range(0, max(1, len(record.contacts)), CONTACTS):
        yield _contact_table(record.contacts[start : start + CONTACTS], record.sides[:2])


def _contact_table(rows: Sequence[StepContact], sides: Sequence[str]) -> pa.Table:
    found = [row.known for row in rows]
    names = [
        pa.array([getattr(row, side) for row in rows], pa.string()) for side in LINK_AND_OBSTACLE
    ]
    columns = {
        "step": pa.array([row.step for row in rows], pa.int64()),
        "time": pa.array([row.time for row in rows], pa.float64()),
        sides[0]: names[0],
        sides[1]: names[1],
    }
    for name in ("penetration", "penetration_at_least", "volume", "volume_at_least"):
        columns[name] = pa.array([getattr(one, name, None) for one in found], pa.float64())
    for name in ("direction", "centroid"):
        for i, axis in enumerate("xyz"):
            values = [None if one is None else float(getattr(one, name)[i]) for one in found]
            columns[f"{name}_{axis}"] = pa.array(values, pa.float64())
    return pa.table(columns | dict(zip(SIDES, names, strict=True)))


def write_parquet(batches: Iterable[pa.Table], path: Path) -> None:
    """Writes a table that comes in parts as Parquet, a row group of each part."""
    import pyarrow.parquet

    with ExitStack() as opened:
        writer = None
        for batch in batches:
            if writer is None:
                writer = opened.enter_context(pyarrow.parquet.ParquetWriter(path, batch.schema))
            writer.write_table(batch)


def write_csv(batches: Callable[[], Iterable[pa.Table]], path: Path) -> None:
    """Writes a table that comes in parts as CSV with a header; names are quoted only where one of them needs
    it."""
    try:
        _write_csv(batches(), path, "none")
    except pa.ArrowInvalid:  # a name with a comma, a quote or a line break
        _write_csv(batches(), path, "needed")


def _write_csv(batches: Iterable[pa.Table], path: Path, quoting: str) -> None:
    import pyarrow.csv

    body = pyarrow.csv.WriteOptions(include_header=False, quoting_style=quoting)
    with path.open("wb") as file:
        for i, batch in enumerate(batches):
            if i == 0:
                file.write((",".join(batch.column_names) + "\n").encode())
            pyarrow.csv.write_csv(batch, file, body)


def step_batches(record: Record, measured: MeasuredRows = IN_MEMORY) -> Iterator[pa.Table]:
    """The steps of a record, a block at a time; what a block took of memory is let go after it."""
    for block in blocks(record.rows.n_rows):
        rows = with_contact_columns(record.rows.at(block), record.contacts, block.start)
        yield with_proven_between(rows, record.budget, block.start).arrow()
        measured.let_go()


def pair_batches(record: Record, measured: MeasuredRows = IN_MEMORY) -> Iterator[pa.Table]:
    """Every pair at every step of a record that has them, in the same way."""
    assert record.every_pair is not None
    for batch in record.every_pair.batches():
        yield batch
        measured.let_go()


BUDGET = "budget.csv"


class _Taken(NamedTuple):
    """What one error takes of a moment of a rule; a frame has two tolerances, [m] and [rad], all else has one."""

    rule: RuleBudget
    at: BudgetMoment
    source: ErrorSource

    @property
    def second(self) -> tuple[float | None, str | None]:
        """The second tolerance with its unit, if it has one."""
        return self.source.tolerances[1] if len(self.source.tolerances) > 1 else (None, None)

    @property
    def largest(self) -> tuple[float | None, ...]:
        """As `ErrorSource.largest`, None where not asked for."""
        return (*self.source.largest, None, None)


_BUDGET_COLUMNS: tuple[tuple[str, str, Callable[[_Taken], Any]], ...] = (
    ("rule", "string", lambda row: row.rule.rule),
    ("step", "int64", lambda row: row.at.moment.step),
    ("time", "float64", lambda row: row.at.moment.time),
    ("between", "bool", lambda row: row.at.moment.between),
    ("body_a", "string", lambda row: row.at.moment.link),
    ("body_b", "string", lambda row: row.at.moment.obstacle),
    ("clearance", "float64", lambda row: row.at.moment.clearance),
    ("proven", "float64", lambda row: row.at.proven),
    ("expected", "float64", lambda row: row.at.expected),
    ("owner", "string", lambda row: row.source.owner),
    ("kind", "string", lambda row: row.source.kind),
    ("part", "string", lambda row: row.source.part),
    ("moment", "string", lambda row: row.source.moment),
    ("tolerance", "float64", lambda row: row.source.tolerances[0][0]),
    ("unit", "string", lambda row: row.source.tolerances[0][1]),
    ("second_tolerance", "float64", lambda row: row.second[0]),
    ("second_unit", "string", lambda row: row.second[1]),
    ("takes", "float64", lambda row: row.source.proven),
    ("deviation", "float64", lambda row: row.source.expected),
    ("at_most", "float64", lambda row: row.largest[0]),
    ("second_at_most", "float64", lambda row: row.largest[1]),
)
"""Names, types in pyarrow, and what stands in each row."""


def budget_table(least_left: Mapping[RuleBudget, Sequence[BudgetMoment]]) -> pa.Table:
    """The table of a run with tolerances; `least_left` as in `ReportModel`."""
    rows = [
        _Taken(one, at, source)
        for one, moments in least_left.items()
        for at in moments
        for source in at.sources
    ]
    columns = {
        name: pa.array(map(of, rows), pa.type_for_alias(kind)) for name, kind, of in _BUDGET_COLUMNS
    }
    return pa.table(columns)

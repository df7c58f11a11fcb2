"""The tables of a report as files, every float written so that reading it gives the same float again.

There is a row a step, a pair in contact at a step, and an error of a moment at which the tolerances leave least.
Moments of a rule stand together, what takes most first. Lengths in metres.
"""

from __future__ import annotations

from collections.abc import Callable, Iterable, Iterator, Mapping, Sequence
from contextlib import ExitStack
from pathlib import Path
from typing import Any

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

BUDGET_COLUMNS = {
    "rule": "string",
    "step": "int64",
    "time": "float64",
    "between": "bool",
    "body_a": "string",
    "body_b": "string",
    "clearance": "float64",
    "proven": "float64",
    "expected": "float64",
    "owner": "string",
    "kind": "string",
    "part": "string",
    "moment": "string",
    "tolerance": "float64",
    "unit": "string",
    "second_tolerance": "float64",
    "second_unit": "string",
    "takes": "float64",
    "deviation": "float64",
    "at_most": "float64",
    "second_at_most": "float64",
}
"""Types in pyarrow. A frame has two tolerances, an offset [m] and an angle [rad]; all else has one."""


def budget_table(least_left: Mapping[RuleBudget, Sequence[BudgetMoment]]) -> pa.Table:
    """The table of a run with tolerances; `least_left` as in `ReportModel`."""
    rows = [row for one, moments in least_left.items() for at in moments for row in _rows(one, at)]
    schema = [(name, pa.type_for_alias(kind)) for name, kind in BUDGET_COLUMNS.items()]
    return pa.Table.from_pylist(rows, schema=pa.schema(schema))


def _rows(one: RuleBudget, worst: BudgetMoment) -> Iterator[dict[str, Any]]:
    moment = worst.moment
    head = {
        "rule": one.rule,
        "step": moment.step,
        "time": moment.time,
        "between": moment.between,
        "body_a": moment.link,
        "body_b": moment.obstacle,
        "clearance": moment.clearance,
        "proven": worst.proven,
        "expected": worst.expected,
    }
    for source in worst.sources:
        yield head | _of_source(source)


def _of_source(source: ErrorSource) -> dict[str, Any]:
    (first, unit), *others = source.tolerances
    second, second_unit = others[0] if others else (None, None)
    largest = (*source.largest, None, None)
    return {
        "owner": source.owner,
        "kind": source.kind,
        "part": source.part,
        "moment": source.moment,
        "tolerance": first,
        "unit": unit,
        "second_tolerance": second,
        "second_unit": second_unit,
        "takes": source.proven,
        "deviation": source.expected,
        "at_most": largest[0],
        "second_at_most": largest[1],
    }

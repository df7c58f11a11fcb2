"""`budget.csv`: what each error takes of the clearance, at the moments at which the tolerances leave least.

A row for each error of each such moment, the moments of a rule together, what takes most first. Lengths in metres.
Not for: the page (`tolerance_section`).
"""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from typing import Any

import pyarrow as pa

from clearance.record.budget import BudgetMoment, ErrorSource, RuleBudget
from clearance.record.record import Record

FILE_NAME = "budget.csv"

SCHEMA = pa.schema(
    [
        ("rule", pa.string()),
        ("step", pa.int64()),
        ("time", pa.float64()),
        ("between", pa.bool_()),
        ("body_a", pa.string()),
        ("body_b", pa.string()),
        ("clearance", pa.float64()),
        ("proven", pa.float64()),
        ("expected", pa.float64()),
        ("owner", pa.string()),
        ("kind", pa.string()),
        ("part", pa.string()),
        ("moment", pa.string()),
        ("tolerance", pa.float64()),
        ("unit", pa.string()),
        ("second_tolerance", pa.float64()),
        ("second_unit", pa.string()),
        ("takes", pa.float64()),
        ("deviation", pa.float64()),
        ("at_most", pa.float64()),
        ("second_at_most", pa.float64()),
    ]
)
"""A frame has two tolerances, an offset [m] and an angle [rad]; everything else has one."""


def budget_table(record: Record, left: Mapping[str, Sequence[BudgetMoment]]) -> pa.Table:
    """The table of a record with tolerances; `left` as in `RunDetails`."""
    rows = [
        row for one in record.budget or () for worst in left[one.rule] for row in _rows(one, worst)
    ]
    return pa.Table.from_pylist(rows, schema=SCHEMA)


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

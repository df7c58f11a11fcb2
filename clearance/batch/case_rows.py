"""The rows of all cases of a batch in their order, some at a time: from the store, or from the table of an answer.

Not for: what they come to (`answer`).
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Protocol

import pyarrow as pa
import pyarrow.parquet as pq

from clearance.batch.cases import SomeCases, SomeOrAll
from clearance.batch.digest_table import NONE
from clearance.batch.outcome import Outcome
from clearance.batch.rows import VERDICT, error_row
from clearance.batch.store import Store

PART = 512
"""Rows that are read at a time."""

FAULT = 70
"""The exit code where this program is at fault, as of `clearance check`."""

VIOLATED, BAD_INPUT = 1, 2

TABLE = pa.schema([("case", pa.string()), ("key", pa.string()), *VERDICT])
"""Columns of a case: its name, its key, and what follows from it."""


class CaseRows(Protocol):
    """Rows of cases, in order."""

    def __len__(self) -> int: ...

    def parts(self, columns: Sequence[str]) -> Iterator[pa.Table]:
        """Some columns of `TABLE`, in the order asked for, at most `PART` rows at a time."""
        ...


@dataclass(frozen=True, eq=False)
class StoredRows:
    """The rows of the cases that were tried; one of a fault is made of it.

    Attributes:
        strict: a case that cannot be read or answered is bad input of the batch.
    """

    outcome: Outcome
    store: Store
    items: SomeOrAll
    strict: bool = False

    def __len__(self) -> int:
        return len(self.items)

    def parts(self, columns: Sequence[str]) -> Iterator[pa.Table]:
        """As `CaseRows.parts`."""
        for start in range(0, len(self.items), PART):
            yield self._part(self.items[start : start + PART], columns)

    def _part(self, items: SomeCases, columns: Sequence[str]) -> pa.Table:
        """Some columns of a few cases."""
        asked = [name for name in columns if name != "case"]
        rows = [self.outcome.row(number) for number in items.numbers]
        known = [row for row in rows if row != NONE]
        table = self.store.rows(known, asked)
        if len(known) < len(rows):
            pairs = zip(items.numbers, rows, strict=True)
            errors = [self._error(number) for number, row in pairs if row == NONE]
            schema = pa.schema([TABLE.field(name) for name in asked])
            both = pa.concat_tables([table, pa.Table.from_pylist(errors, schema=schema)])
            of_known, of_error = iter(range(len(known))), iter(range(len(known), len(rows)))
            order = [next(of_error if row == NONE else of_known) for row in rows]
            table = both.take(pa.array(order, type=pa.int64()))
        if "case" in columns:
            names = pa.array(items.names(), type=pa.string())
            found = dict(zip(asked, table.columns, strict=True)) | {"case": names}
            return pa.table([found[name] for name in columns], names=[*columns])
        return table.select(columns)

    def _error(self, number: int) -> dict[str, object]:
        fault = self.outcome.faults[number]
        of_input = BAD_INPUT if self.strict else VIOLATED
        return error_row(fault.text, FAULT if fault.trace else of_input)


@dataclass(frozen=True, eq=False)
class WrittenRows:
    """The rows of a table of cases, without the findings."""

    path: Path
    n_rows: int

    def __len__(self) -> int:
        return self.n_rows

    def parts(self, columns: Sequence[str]) -> Iterator[pa.Table]:
        """As `CaseRows.parts`."""
        with pq.ParquetFile(self.path) as file:
            for batch in file.iter_batches(PART, columns=[*columns], use_threads=False):
                yield _completed(pa.Table.from_batches([batch]), columns)


def _completed(part: pa.Table, columns: Sequence[str]) -> pa.Table:
    """The columns of some rows; null those that an older version did not write."""
    for name in set(columns) - set(part.column_names):
        part = part.append_column(name, pa.nulls(part.num_rows, TABLE.field(name).type))
    return part.select(columns)

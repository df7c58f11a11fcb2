"""The tables of an answer as parquet files, written some thousand rows at a time. Not for: when (`output`)."""

from __future__ import annotations

import json
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path

import pyarrow as pa
import pyarrow.compute as pc
import pyarrow.parquet as pq

from clearance.batch.answer import BatchAnswer
from clearance.batch.case_rows import TABLE, WrittenRows
from clearance.batch.rows import FINDING
from clearance.report.folder import written_file

CASES, FINDINGS = "cases.parquet", "findings.parquet"

GROUP = 1024
"""Rows that a table is written by."""

_STALE = b"stale waivers"
"""Key of the table of cases under which its metadata holds what is wrong with shared waivers, as JSON."""


def _as_read(field: pa.Field) -> pa.Field:
    """A field as a parquet file gives it back: entries of lists have another name there."""
    if pa.types.is_list(field.type):
        return field.with_type(pa.list_(pa.field("element", field.type.value_type)))
    return field


_CASE = pa.schema([_as_read(field) for field in TABLE if field.name != "findings"])
_FINDING = pa.schema([pa.field("case", pa.string()), *map(_as_read, FINDING)])


def write_tables(answer: BatchAnswer, place: Path) -> None:
    """Writes one row a case and one row a finding, the worst of a case first.

    Raises:
        Unwritable: there is no way or no room.
    """
    marked = _CASE.with_metadata({_STALE: json.dumps(answer.stale)})
    with _table(place / CASES, marked) as cases, _table(place / FINDINGS, _FINDING) as findings:
        for part in answer.rows.parts(TABLE.names):
            cases.add(part.select(_CASE.names).replace_schema_metadata(marked.metadata))
            findings.add(_findings(part))


def written_answer(place: Path) -> BatchAnswer | None:
    """The answer that the tables hold; None where they are not there."""
    if not (place / CASES).is_file():
        return None
    found = pq.read_metadata(place / CASES)
    stale = (found.metadata or {}).get(_STALE, b"[]")
    return BatchAnswer(WrittenRows(place / CASES, found.num_rows), tuple(json.loads(stale)))


@contextmanager
def _table(path: Path, schema: pa.Schema) -> Iterator[_Table]:
    """A parquet file that is there once it is whole."""
    with written_file(path) as file, pq.ParquetWriter(file, schema, compression="zstd") as writer:
        table = _Table(writer, schema)
        yield table
        table.end()


class _Table:
    """Rows that go into a file by groups of `GROUP` or somewhat more."""

    def __init__(self, writer: pq.ParquetWriter, schema: pa.Schema) -> None:
        self._writer, self._schema = writer, schema
        self._waiting: list[pa.Table] = []
        self._n_waiting, self._is_begun = 0, False

    def add(self, rows: pa.Table) -> None:
        """Adds rows after those before."""
        self._waiting.append(rows)
        self._n_waiting += rows.num_rows
        if self._n_waiting >= GROUP:
            self._write()

    def end(self) -> None:
        """Writes what waits, an empty group where there is nothing at all."""
        if self._n_waiting or not self._is_begun:
            self._write()

    def _write(self) -> None:
        table = pa.concat_tables([self._schema.empty_table(), *self._waiting]).combine_chunks()
        self._writer.write_table(table, row_group_size=2**16)
        self._waiting, self._n_waiting, self._is_begun = [], 0, True


def _findings(part: pa.Table) -> pa.Table:
    """The findings of some cases, a row each."""
    column = part["findings"].combine_chunks()
    if isinstance(column, pa.ChunkedArray):
        column = pa.concat_arrays(column.chunks)
    whose = pc.list_parent_indices(column)
    flat = pa.Table.from_struct_array(pc.list_flatten(column))
    return flat.add_column(0, "case", part["case"].combine_chunks().take(whose))

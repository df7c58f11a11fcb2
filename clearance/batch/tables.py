"""The tables of an answer as parquet files. Not for: when they are written (`output`)."""

from __future__ import annotations

import json
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path
from typing import Any

import pyarrow as pa
import pyarrow.parquet as pq

from clearance.batch.answer import CASE, PART, BatchAnswer
from clearance.batch.rows import FINDING
from clearance.batch.store import Store
from clearance.batch.store_files import CASES, FINDINGS
from clearance.codes import codes
from clearance.errors import BadBatch
from clearance.files import written_file

_WAIVER_FAULTS = b"unused waivers"
"""Key of the table of cases under which its metadata holds what is wrong with shared waivers, as JSON."""

_FINDING = pa.schema([("case", pa.string()), *FINDING, ("code", pa.string())])


def write_tables(answer: BatchAnswer, store: Store) -> None:
    """Writes one row a case and one row a finding, the worst of a case first.

    Raises:
        Unwritable: there is no way or no room.
    """
    marked = answer.rows.replace_schema_metadata({_WAIVER_FAULTS: json.dumps(answer.waiver_faults)})
    with _writer(store.place / CASES, marked.schema) as cases:
        cases.write_table(marked)
    with _writer(store.place / FINDINGS, _FINDING) as findings:
        for part in _finding_parts(answer, store):
            findings.write_table(pa.Table.from_pylist(part, schema=_FINDING))


def written_answer(place: Path) -> BatchAnswer | None:
    """The answer that the tables hold; None where they are not there.

    Raises:
        BadInput: it is of another version.
    """
    if not (place / CASES).is_file():
        return None
    rows = pq.read_table(place / CASES)
    if rows.column_names != CASE.names:
        raise BadBatch(
            "an answer of another version",
            where=str(place),
            valid="the same `clearance batch` writes it anew",
        )
    waiver_faults = (rows.schema.metadata or {}).get(_WAIVER_FAULTS, b"[]")
    return BatchAnswer(rows, tuple(json.loads(waiver_faults)))


@contextmanager
def _writer(path: Path, schema: pa.Schema) -> Iterator[pq.ParquetWriter]:
    """A parquet file that is there once it is whole."""
    with written_file(path) as file, pq.ParquetWriter(file, schema, compression="zstd") as writer:
        yield writer


def _finding_parts(answer: BatchAnswer, store: Store) -> Iterator[list[dict[str, Any]]]:
    """The findings of some cases after others, a row each; at least one part, which may be empty."""
    names, keys = answer.column("case"), answer.column("key")
    known = [(name, key) for name, key in zip(names, keys, strict=True) if key is not None]
    for start in range(0, max(1, len(known)), PART):
        some = known[start : start + PART]
        rows = zip(some, store.rows(key for _, key in some), strict=True)
        yield [
            {"case": name, "code": codes().get(one["kind"], "")} | one
            for (name, _), row in rows
            for one in row["findings"]
        ]

"""The files that a store holds of its last batch: tables, JUnit and the page, each written in one step.

Not for: what is in them (`answer`, `junit`, `page`).
"""

from __future__ import annotations

import pyarrow as pa
import pyarrow.parquet as pq

from clearance.batch.answer import BatchAnswer
from clearance.batch.store import Store
from clearance.report.folder import write_file

CASES, FINDINGS = "cases.parquet", "findings.parquet"
PAGE, JUNIT = "batch.html", "junit.xml"


def write_answer(answer: BatchAnswer, store: Store) -> None:
    """Writes the answer into the store's folder.

    Raises:
        Unwritable: there is no way or no room; what is there of an older answer stays, file by file.
    """
    from clearance.batch.junit import junit_of
    from clearance.batch.page import page_of

    with store.locked():
        write_file(store.place / CASES, _parquet(answer.cases))
        write_file(store.place / FINDINGS, _parquet(answer.findings))
        write_file(store.place / JUNIT, junit_of(answer, store.place.name))
        write_file(store.place / PAGE, page_of(answer, store.place).encode())


def _parquet(table: pa.Table) -> bytes:
    sink = pa.BufferOutputStream()
    pq.write_table(table.combine_chunks(), sink, compression="zstd", row_group_size=2**16)
    return sink.getvalue().to_pybytes()


def rewrite_page(store: Store) -> None:
    """Writes the page of the last answer once more, with links to the pages of cases that are there by now.

    Raises:
        Unwritable: there is no way or no room.
    """
    from clearance.batch.page import page_of

    with store.locked():
        tables = [store.place / name for name in (CASES, FINDINGS)]
        if all(path.is_file() for path in tables):
            answer = BatchAnswer(*(pq.read_table(path, partitioning=None) for path in tables))
            write_file(store.place / PAGE, page_of(answer, store.place).encode())

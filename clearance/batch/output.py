"""The files that a store holds of its last batch: tables, JUnit and the page, each written in one step.

While a batch is not finished the answer of an older one does not stand there: its tables are gone, which the rows
give again, and JUnit and page say what is missing.

Not for: what is in them (`answer`, `junit`, `page`).
"""

from __future__ import annotations

import json

import pyarrow as pa
import pyarrow.parquet as pq

from clearance.batch.answer import BatchAnswer
from clearance.batch.store import Store
from clearance.errors import unwritable
from clearance.report.folder import write_file
from clearance.report.wording import count

CASES, FINDINGS = "cases.parquet", "findings.parquet"
PAGE, JUNIT = "batch.html", "junit.xml"
ANSWER = (CASES, FINDINGS, PAGE, JUNIT)


_STALE = b"stale waivers"
"""Key of the table of cases under which its metadata holds what is wrong with shared waivers, as JSON."""

UNFINISHED = "this batch is not finished"


def withdraw_answer(store: Store, n_cases: int) -> None:
    """Takes the answer of an older batch away, before one of so many cases is begun.

    Raises:
        Unwritable: there is no way or no room; what is there of the older answer is gone all the same.
    """
    from clearance.batch.junit import clean
    from clearance.batch.page import unfinished_page
    from clearance.report.unfinished_junit import unfinished_junit

    told = (
        f"{UNFINISHED}: of {count(n_cases, 'case')} some are not measured; the same command goes on"
    )
    with store.locked():
        with unwritable(store.place):
            for name in ANSWER:
                (store.place / name).unlink(missing_ok=True)
        write_file(store.place / JUNIT, unfinished_junit(clean(store.place.name), told))
        write_file(store.place / PAGE, unfinished_page(store.place.name, told).encode())


def write_answer(answer: BatchAnswer, store: Store) -> None:
    """Writes the answer into the store's folder.

    Raises:
        Unwritable: there is no way or no room.
    """
    from clearance.batch.junit import junit_of
    from clearance.batch.page import page_of

    with store.locked():
        marked = answer.cases.replace_schema_metadata({_STALE: json.dumps(answer.stale)})
        write_file(store.place / CASES, _parquet(marked))
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
            cases, findings = (pq.read_table(path, partitioning=None) for path in tables)
            stale = (cases.schema.metadata or {}).get(_STALE, b"[]")
            answer = BatchAnswer(cases, findings, tuple(json.loads(stale)))
            write_file(store.place / PAGE, page_of(answer, store.place).encode())

"""The files that a store holds of its last batch: tables, JUnit and the page, each written in one step.

While a batch is not finished the answer of an older one does not stand there: its tables are gone, which the rows
give again, and JUnit and page say what is missing.

Not for: what is in them (`answer`, `tables`, `junit`, `page`).
"""

from __future__ import annotations

from pathlib import Path

from clearance.batch.answer import BatchAnswer
from clearance.batch.store import Store
from clearance.batch.store_files import CASES, FINDINGS
from clearance.batch.tables import write_tables, written_answer
from clearance.errors import unwritable
from clearance.files import write_file

PAGE, JUNIT = "batch.html", "junit.xml"
ANSWER = (CASES, FINDINGS, PAGE, JUNIT)

UNFINISHED = "this batch is not finished: {} not measured; the same command goes on"


def withdraw_answer(place: Path, text: str, fault: str = "Incomplete") -> None:
    """Takes the answer of an older batch away from a store: JUnit and page say why there is none.

    Raises:
        Unwritable: there is no way or no room; what is there of the older answer is gone all the same.
    """
    from clearance.batch.page import unfinished_page
    from clearance.report.junit import write_unfinished

    with unwritable(place):
        for name in ANSWER:
            (place / name).unlink(missing_ok=True)
    write_unfinished(place.name, text, place / JUNIT, fault)
    write_file(place / PAGE, unfinished_page(place.name, text).encode())


def write_answer(answer: BatchAnswer, store: Store) -> None:
    """Writes the answer into the store's folder.

    Raises:
        Unwritable: there is no way or no room.
    """
    from clearance.batch.junit import write_batch_junit

    write_tables(answer, store)
    write_batch_junit(answer, store.place.name, store.place / JUNIT)
    _write_page(answer, store.place)


def rewrite_page(place: Path) -> None:
    """Writes the page of the last answer once more, with links to the pages of cases that are there by now.

    Raises:
        Unwritable: there is no way or no room.
    """
    written = written_answer(place)
    if written is not None:
        _write_page(written, place)


def _write_page(answer: BatchAnswer, place: Path) -> None:
    from clearance.batch.page import page_of

    write_file(place / PAGE, page_of(answer, place).encode())

"""The files that a store holds of its last batch: tables, JUnit and the page, each written in one step.

While a batch is not finished the answer of an older one does not stand there: its tables are gone, which the rows
give again, and JUnit and page say what is missing.

JUnit has one test case for each case of the batch, under its own name, and waivers that should go before them.

Not for: what is in the others (`answer`, `tables`, `page`), one case in detail (`report.junit_cases`).
"""

from __future__ import annotations

from collections.abc import Iterator
from pathlib import Path
from typing import Any

from clearance.batch.answer import FAULT, BatchAnswer
from clearance.batch.rows import ERROR
from clearance.batch.store import Store
from clearance.batch.store_files import CASES, FINDINGS
from clearance.batch.tables import write_tables, written_answer
from clearance.errors import unwritable
from clearance.files import write_file
from clearance.report.junit import TestResult, write_junit, write_unfinished

PAGE, JUNIT = "batch.html", "junit.xml"
ANSWER = (CASES, FINDINGS, PAGE, JUNIT)

_RESULT = ["case", "status", "exit_code", "text", "reasons", "reservations"]
"""Columns that JUnit is made of."""

UNFINISHED = "this batch is not finished: {} not measured; the same command goes on"


def withdraw_answer(place: Path, text: str, fault: str = "Incomplete") -> None:
    """Takes the answer of an older batch away from a store: JUnit and page say why there is none.

    Raises:
        Unwritable: there is no way or no room; what is there of the older answer is gone all the same.
    """
    from clearance.batch.page import unfinished_page

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
    write_tables(answer, store)
    properties = {"exit_code": str(answer.exit_code)}
    write_junit(store.place.name, [*_results(answer)], store.place / JUNIT, properties)
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


def _results(answer: BatchAnswer) -> Iterator[TestResult]:
    yield from (TestResult("waiver", text, text, "UnusedWaiver") for text in answer.waiver_faults)
    yield from map(_of_case, answer.rows.select(_RESULT).to_pylist())


def _of_case(row: dict[str, Any]) -> TestResult:
    if not row["exit_code"]:
        return TestResult("batch", row["case"], _text(row))
    kind = {ERROR: "BadInput", "suspect": "SuspectInput"}.get(row["status"], "NotPassed")
    kind = "Fault" if row["exit_code"] == FAULT else kind
    return TestResult("batch", row["case"], _text(row), kind, errs=row["status"] == ERROR)


def _text(row: dict[str, Any]) -> str:
    """The headline, why, and what a reader must know beside it, each once."""
    lines = (row["text"], *(row["reasons"] or ()), *(row["reservations"] or ()))
    return "; ".join(dict.fromkeys(lines))

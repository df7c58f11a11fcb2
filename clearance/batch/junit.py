"""The test cases that a batch is to a build server: one for each case of the batch, under its own name.

Not for: one case in detail (`report.junit_cases`), nor writing them (`report.junit`).
"""

from __future__ import annotations

from collections.abc import Iterator
from pathlib import Path
from typing import Any

from clearance.batch.answer import FAULT, BatchAnswer
from clearance.batch.rows import ERROR
from clearance.report.junit import TestResult, write_junit

_COLUMNS = ["case", "status", "exit_code", "text", "reasons", "reservations"]


def write_batch_junit(answer: BatchAnswer, name: str, path: Path) -> None:
    """Writes the cases of a batch, waivers that should go before them.

    Args:
        name: of the suite.

    Raises:
        Unwritable: there is no way or no room.
    """
    write_junit(name, [*_results(answer)], path, {"exit_code": str(answer.exit_code)})


def _results(answer: BatchAnswer) -> Iterator[TestResult]:
    yield from (TestResult("waiver", text, text, "UnusedWaiver") for text in answer.waiver_faults)
    yield from map(_of_case, answer.rows.select(_COLUMNS).to_pylist())


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

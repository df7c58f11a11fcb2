"""Two batches compared, case by case: what is new, worse, better, gone or not comparable.

Each case's findings are compared as those of two runs are (`findings.comparison`); beside them stand cases that
only one of the batches has, and cases without an answer. Not for: how it is shown (`report.comparison`).
"""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any

import numpy as np
import pyarrow as pa
import pyarrow.compute as pc
import pyarrow.parquet as pq

from clearance.batch.answer import BatchAnswer
from clearance.batch.rows import ERROR
from clearance.batch.store_files import FINDINGS, is_store
from clearance.batch.tables import written_answer
from clearance.errors import BadBatch, Incomplete
from clearance.findings.comparison import BatchComparison, ComparedCase, compared
from clearance.findings.doubts import Doubt
from clearance.findings.finding import AppliedWaiver, Finding
from clearance.findings.findings_file import FindingList, conditions_in


def require_answer(place: Path) -> BatchAnswer:
    """The answer of a store that can be compared with another's.

    Raises:
        BadInput: that is no store, or of another version. Incomplete: it has no answer.
    """
    if not is_store(place):
        raise BadBatch(
            "not a store", where=str(place), valid="the folder that a `clearance batch --out` wrote"
        )
    answer = written_answer(place)
    if answer is None or not (place / FINDINGS).is_file():
        raise Incomplete(
            "this batch has no answer yet",
            where=str(place),
            valid="`clearance batch` without --shard writes it once all cases are tried",
        )
    return answer


def compared_batches(before: Path, now: Path) -> BatchComparison:
    """The answer of a store, compared with that of another.

    Raises:
        Incomplete: one has no answer. BadInput, Unwritable: one is of another version.
    """
    old, new = _Answer.of(before), _Answer.of(now)
    cases = [_compared_case(name, old, new) for name in new.numbers]
    gone = [
        ComparedCase(name, None, "gone: the batch has no such case any more", True)
        for name in old.numbers
        if name not in new.numbers
    ]
    waiver_faults = tuple(
        line for line in new.answer.waiver_faults if line not in old.answer.waiver_faults
    )
    return BatchComparison((*cases, *gone), waiver_faults)


def _compared_case(name: str, old: _Answer, new: _Answer) -> ComparedCase:
    now = new.row(name)
    before = old.row(name) if name in old.numbers else None
    fails = bool(now["exit_code"])
    if now["status"] == ERROR:
        is_known = (
            before is not None and before["status"] == ERROR and before["text"] == now["text"]
        )
        what = "no answer, as before" if is_known else "no answer"
        return ComparedCase(name, None, f"{what}: {now['text']}", not is_known)
    if before is None:
        return ComparedCase(name, None, f"new case: {now['text']}", fails)
    if before["status"] == ERROR:
        return ComparedCase(name, None, f"answered, and was not before: {now['text']}", fails)
    return ComparedCase(name, compared(old.list_of(before), new.list_of(now)))


@dataclass(frozen=True, eq=False)
class _Answer:
    """The tables of a store.

    Attributes:
        numbers: of the cases, by name. begins: of each case's findings, and the end of the last.
    """

    answer: BatchAnswer
    findings: pa.Table
    numbers: dict[str, int] = field(default_factory=dict)
    begins: np.ndarray = field(default_factory=lambda: np.zeros(1, dtype=np.int64))

    @staticmethod
    def of(place: Path) -> _Answer:
        """That of a store's folder."""
        answer = require_answer(place)
        findings = pq.read_table(place / FINDINGS)
        names = answer.column("case")
        whose = pc.index_in(findings["case"], pa.array(names, type=pa.string())).to_numpy()
        begins = np.searchsorted(whose, np.arange(len(names) + 1))
        return _Answer(answer, findings, {name: i for i, name in enumerate(names)}, begins)

    def row(self, name: str) -> dict[str, Any]:
        """The columns of a case."""
        return self.answer.row(self.numbers[name])

    def list_of(self, row: dict[str, Any]) -> FindingList:
        """The findings of a case that has an answer, by its row, and what is needed to compare them."""
        number = self.numbers[row["case"]]
        begin, end = int(self.begins[number]), int(self.begins[number + 1])
        findings = tuple(_findings(self.findings.slice(begin, end - begin).to_pylist()))
        return FindingList(
            case=row["case"],
            incomplete=row["incomplete"],
            not_listed=row["n_findings"] - len(findings),
            measured=conditions_in(row["conditions"]),
            doubts=tuple(Doubt(**one) for one in row["doubts"]),
            findings=findings,
            duration=row["end"] - row["start"],
        )


def _findings(rows: list[dict[str, Any]]) -> Iterator[Finding]:
    for row in rows:
        waived = row.pop("waived")
        of = {key: tuple(row[key]) if row[key] else None for key in ("point_a", "point_b")}
        values = {key: value for key, value in row.items() if key not in ("case", "code")} | of
        excuse = None if waived is None else AppliedWaiver(at_least=0.0, reason=waived, by="")
        yield Finding(**values, waived=excuse)

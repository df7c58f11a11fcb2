"""What a batch comes to: the rows of all cases in their order, what is counted of them, and the exit code.

It is made of the rows alone, so that it is the same however often the batch was interrupted, and by whomever its
cases were measured. Not for: the files that are written of it (`output`).
"""

from __future__ import annotations

from collections import Counter, defaultdict
from collections.abc import Iterable, Iterator, Sequence
from dataclasses import dataclass
from functools import cached_property
from itertools import islice, zip_longest
from typing import Any

import pyarrow as pa

from clearance.batch.item import Item
from clearance.batch.outcome import Outcome
from clearance.batch.rows import ERROR, TABLE, error_row
from clearance.batch.shared_waivers import (
    any_of_cells,
    expired_waivers,
    failing_waivers,
    failing_waivers_of_cells,
)
from clearance.batch.store import Store
from clearance.codes import coded_of
from clearance.findings.doubts import UNUSED_WAIVER, WARNING
from clearance.findings.finding import NOT_PROVEN

STATUSES = (
    "clear", "near", WARNING, UNUSED_WAIVER, NOT_PROVEN, "violated", "contact", "suspect", ERROR,
)  # fmt: skip
"""As a case's status can be, the better before the worse."""

BASES = {
    "motion": "proven for the motion",
    "samples": "measured at the samples only",
    "pose": "of a single pose",
}
"""What verdicts can rest on, in words."""

MOST_WORST = 10
"""Failing cases that a summary names."""

PART = 512
"""Rows that are read from a store at a time."""

FAULT = 70
"""The exit code where this program is at fault, as of `clearance check`."""

VIOLATED, BAD_INPUT = 1, 2

CASE = pa.schema([field for field in TABLE if field.name != "findings"])
"""The columns of an answer; the findings stay in the store."""


def reach_of(clearance: float | None, penetration: float | None) -> float | None:
    """[m] The clearance of a case, less how deep its bodies are in contact, as far as that is known."""
    return None if clearance is None else clearance - (penetration or 0.0)


@dataclass(frozen=True, eq=False)
class BatchAnswer:
    """All cases of a batch.

    Attributes:
        rows: of the cases, in order, with the columns of `CASE`. Where a case has no answer, its status is
            "error", its text says why, and most columns are null.
        waiver_faults: what is wrong with waivers that the cases share, one line each.
    """

    rows: pa.Table
    waiver_faults: tuple[str, ...] = ()

    def column(self, name: str) -> list[Any]:
        """A column, a value a case."""
        found: list[Any] = self.rows[name].to_pylist()
        return found

    def row(self, i: int) -> dict[str, Any]:
        """The columns of a case."""
        found: list[dict[str, Any]] = self.rows.slice(i, 1).to_pylist()
        return found[0]

    @property
    def n_cases(self) -> int:
        """How many there are."""
        return int(self.rows.num_rows)

    @cached_property
    def reached(self) -> list[float | None]:
        """[m] Of each case `reach_of`."""
        return [*map(reach_of, self.column("clearance"), self.column("penetration"))]

    @cached_property
    def counts(self) -> dict[str, int]:
        """How many cases have each status that occurs, the better before the worse."""
        found = Counter(self.column("status"))
        return {status: found[status] for status in STATUSES if found[status]}

    @property
    def exit_code(self) -> int:
        """The greatest of all cases, and 1 for a waiver that should go."""
        return max([0, *self.column("exit_code"), VIOLATED if self.waiver_faults else 0])

    @property
    def status(self) -> str:
        """The worst of all cases; "unused waiver" where that is all that fails."""
        worst = next(reversed(self.counts), "clear")
        return UNUSED_WAIVER if self.waiver_faults and worst in ("clear", "near") else worst

    @cached_property
    def bases(self) -> dict[str, int]:
        """What verdicts rest on: how many on the motion, on the samples only, on a single pose."""
        found = Counter(self.column("basis"))
        return {basis: found[basis] for basis in BASES if found[basis]}

    @property
    def n_waived(self) -> int:
        """How many cases have something that a waiver lets pass."""
        return sum(map(bool, self.column("waived")))

    @property
    def warned(self) -> list[str]:
        """The cases that have warnings."""
        rows = zip(self.column("case"), self.column("warnings"), strict=True)
        return [case for case, warnings in rows if warnings]

    @property
    def n_failing(self) -> int:
        """How many cases do not pass."""
        return sum(map(bool, self.column("exit_code")))

    @property
    def least(self) -> dict[str, Any] | None:
        """The first case of least clearance, or deepest in contact, as columns of its row; None where none is
        measured."""
        known = [(reach, i) for i, reach in enumerate(self.reached) if reach is not None]
        return self.row(min(known)[1]) if known else None

    @cached_property
    def worst(self) -> list[dict[str, Any]]:
        """Some of the cases that do not pass: the first of each status in turn, so that none hides another; the
        worst status first, then by clearance, the deepest contact first.
        """
        by_status = defaultdict[str, list[int]](list)
        failing = zip(self.column("status"), self.column("exit_code"), strict=True)
        for i, (status, code) in enumerate(failing):
            if code:
                by_status[status].append(i)
        order = [status for status in reversed(STATUSES) if status in by_status]
        turns = zip_longest(*(self._worst_first(by_status[status]) for status in order))
        worst_first = islice((i for turn in turns for i in turn if i is not None), MOST_WORST)
        rows = [self.row(i) for i in worst_first]
        return sorted(rows, key=lambda row: order.index(row["status"]))

    def _worst_first(self, cases: Iterable[int]) -> list[int]:
        return sorted(cases, key=lambda i: (self.reached[i] or 0.0, i))


def answer_of(outcome: Outcome, store: Store, *, strict: bool = False) -> BatchAnswer:
    """The answer of a batch of which every case has a row or a fault.

    Args:
        strict: a case that cannot be read or answered is bad input of the batch.
    """
    items = outcome.tried
    parts = [
        pa.Table.from_pylist([*_rows(some, outcome, store, strict)], schema=CASE)
        for some in in_parts(items)
    ]
    rows = pa.concat_tables([CASE.empty_table(), *parts]).combine_chunks()
    faults = _waiver_faults(outcome, items, rows) if outcome.whole else ()
    return BatchAnswer(rows, tuple(coded_of(fault, UNUSED_WAIVER) for fault in faults))


def in_parts(values: Sequence[Item]) -> Iterator[Sequence[Item]]:
    """The cases, `PART` at a time."""
    return (values[start : start + PART] for start in range(0, len(values), PART))


def _rows(
    items: Sequence[Item], outcome: Outcome, store: Store, strict: bool
) -> Iterator[dict[str, Any]]:
    known = store.rows(outcome.keys[one.number] for one in items if one.number in outcome.keys)
    for item in items:
        if item.number in outcome.keys:
            yield next(known) | {"case": item.name}
        else:
            fault = outcome.faults[item.number]
            of_input = BAD_INPUT if strict else VIOLATED
            row = error_row(fault.text, FAULT if fault.trace else of_input)
            yield row | {"case": item.name, "key": None}


def _waiver_faults(outcome: Outcome, items: Sequence[Item], rows: pa.Table) -> tuple[str, ...]:
    """What is wrong with waivers that cases share. While a case has no row it may be the one that needs a waiver:
    then only those that are expired are wrong.
    """
    if not outcome.is_answered:
        return expired_waivers(outcome.items, outcome.waivers)
    if not outcome.waivers and not any_of_cells(items):
        return ()
    needed = [tuple(own or ()) for own in rows["waivers"].to_pylist()]
    among, complaints = failing_waivers_of_cells(items, needed)
    if not outcome.waivers:
        return tuple(complaints)
    return (*complaints, *failing_waivers(items, outcome.waivers, among, items[0].options.day))

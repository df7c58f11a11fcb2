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
from clearance.record.wording import count
from clearance.world.notice import listed

STATUSES = (
    "clear", "near", WARNING, UNUSED_WAIVER, NOT_PROVEN, "violated", "contact", "suspect", ERROR,
)  # fmt: skip
"""As a case's status can be, the better before the worse."""

PASSING = STATUSES[:2]
"""Those of cases that pass as far as they are measured."""

SHADES = ("clear", "near", "violated", "contact", "suspect", ERROR)
"""As a case can be coloured, the better before the worse."""

MOST_WORST = 10
"""Failing cases, and kinds of reservations, that a summary names."""

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
        return UNUSED_WAIVER if self.waiver_faults and worst in PASSING else worst

    @property
    def shade(self) -> str:
        """The worst colour of all cases; nothing is green that fails, or of which only a part is measured."""
        shades = {shade or ERROR for shade in self.column("shade")}
        worst = next((one for one in reversed(SHADES) if one in shades), "clear")
        return "violated" if self.exit_code and worst in PASSING else worst

    @property
    def counted(self) -> str:
        """How many cases have each status, the worst first; of those that pass what their headlines reserve."""
        parts = [self._counted(status) for status in reversed(self.counts)]
        return ("; " if any("," in part for part in parts) else ", ").join(parts) or "none"

    def _counted(self, status: str) -> str:
        n, texts = self.counts[status], self._headlines[status]
        if status not in PASSING:
            return f"{n:,} {status}"
        if len(texts) == 1:
            return f"{n:,} {next(iter(texts))}"
        n_reserved = n - len(texts.get(status, ()))
        return f"{n:,} {status} ({n_reserved:,} with reservations)"

    @cached_property
    def _headlines(self) -> dict[str, dict[str, list[str]]]:
        """The names of cases by status and headline."""
        found = defaultdict[str, dict[str, list[str]]](dict)
        columns = map(self.column, ("status", "text", "case"))
        for status, text, case in zip(*columns, strict=True):
            found[status].setdefault(text, []).append(case)
        return found

    @property
    def reservations(self) -> list[str]:
        """What else the headlines of passing cases say where they differ, and what was not checked, with the
        cases."""
        differing = [
            (text, cases)
            for status in reversed(self.counts)
            for text, cases in self._headlines[status].items()
            if status in PASSING and text != status and len(self._headlines[status]) > 1
        ]
        scopes = defaultdict[str, list[str]](list)
        for case, scope in zip(self.column("case"), self.column("scope"), strict=True):
            for line in scope or ():
                scopes[line].append(case)
        return [*_with_cases(differing), *_with_cases([*scopes.items()])]

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
    def critical(self) -> dict[str, Any] | None:
        """The case whose most critical moment has the least clearance, or is deepest in contact, as columns of its
        row; the first of several, None where none is measured."""
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


def _with_cases(found: Sequence[tuple[str, Sequence[str]]]) -> Iterator[str]:
    """Each text with the cases that it is of; some of them where there are many."""
    for text, cases in found[:MOST_WORST]:
        yield f"{text} ({count(len(cases), 'case')}: {listed(cases)})"
    if len(found) > MOST_WORST:
        yield f"and {count(len(found) - MOST_WORST, 'more reservation')}, see the page"


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

"""What a batch comes to: the rows of all cases in their order, what is counted of them, and the exit code.

It is made of the rows alone, so that it has the same bytes however often the batch was interrupted, and by
whomever its cases were measured. No more than some thousand rows are held at a time. Not for: the files that are
written of it (`output`).
"""

from __future__ import annotations

import heapq
from collections import Counter, defaultdict
from dataclasses import dataclass, field
from functools import cached_property
from itertools import zip_longest
from operator import itemgetter
from typing import Any

import pyarrow as pa

from clearance.batch.case_rows import VIOLATED, CaseRows, StoredRows
from clearance.batch.cases import Cases
from clearance.batch.outcome import Outcome
from clearance.batch.rows import ERROR
from clearance.batch.shared_waivers import (
    any_of_cells,
    expired_waivers,
    stale_waivers,
    stale_waivers_of_cells,
)
from clearance.batch.store import Store
from clearance.findings.finding import NOT_PROVEN

STALE = "stale waiver"

STATUSES = ("clear", "near", STALE, NOT_PROVEN, "violated", "contact", "suspect", ERROR)
"""As a case's status can be, the better before the worse."""

BASES = {
    "motion": "proven for the motion",
    "samples": "looked at the samples only",
    "pose": "of a single pose",
}
"""What verdicts can rest on, in words."""

MOST_WORST = 10
"""Failing cases that a summary names."""


_Standing = tuple[tuple[float, int], dict[str, Any]]
"""Reach and number of a case, and its row."""


def reach_of(clearance: float | None, penetration: float | None) -> float | None:
    """[m] The clearance of a case, less how deep its bodies are in contact, as far as that is known."""
    return None if clearance is None else clearance - (penetration or 0.0)


@dataclass(frozen=True, eq=False)
class BatchAnswer:
    """All cases of a batch.

    Attributes:
        rows: of the cases, in order. Where a case has no answer, its status is "error", its text says why, and
            most columns are null.
        stale: what is wrong with waivers that the cases share, one line each.
    """

    rows: CaseRows
    stale: tuple[str, ...] = ()

    @cached_property
    def _summary(self) -> _Summary:
        made = _Summary()
        for part in self.rows.parts(_Summary.COLUMNS):
            made.add(part)
        return made

    @property
    def n_cases(self) -> int:
        """How many there are."""
        return len(self.rows)

    @property
    def counts(self) -> dict[str, int]:
        """How many cases have each status that occurs, the better before the worse."""
        found = self._summary.statuses
        return {status: found[status] for status in STATUSES if found[status]}

    @property
    def exit_code(self) -> int:
        """The greatest of all cases, and 1 for a waiver that should go."""
        return max(self._summary.exit_code, VIOLATED if self.stale else 0)

    @property
    def status(self) -> str:
        """The worst of all cases; "stale waiver" where that is all that fails."""
        worst = next(reversed(self.counts), "clear")
        return STALE if self.stale and worst in ("clear", "near") else worst

    @property
    def bases(self) -> dict[str, int]:
        """What verdicts rest on: how many on the motion, on the samples only, on a single pose."""
        found = self._summary.bases
        return {basis: found[basis] for basis in BASES if found[basis]}

    @property
    def n_waived(self) -> int:
        """How many cases have something that a waiver lets pass."""
        return self._summary.n_waived

    @property
    def n_warned(self) -> int:
        """How many cases have warnings."""
        return self._summary.n_warned

    @property
    def n_failing(self) -> int:
        """How many cases do not pass."""
        return self._summary.n_failing

    @property
    def least(self) -> dict[str, Any] | None:
        """The first case of least clearance, or deepest in contact, as columns of its row; None where none is
        measured."""
        return self._summary.least

    @property
    def worst(self) -> list[dict[str, Any]]:
        """Some of the cases that do not pass: the first of each status in turn, so that none hides another; the
        worst status first, then by clearance, the deepest contact first.
        """
        return self._summary.listed


@dataclass(eq=False)
class _Summary:
    """What is counted of rows as they pass."""

    statuses: Counter[str] = field(default_factory=Counter)
    bases: Counter[str] = field(default_factory=Counter)
    exit_code: int = 0
    n_waived: int = 0
    n_warned: int = 0
    n_failing: int = 0
    least: dict[str, Any] | None = None
    worst: dict[str, list[_Standing]] = field(default_factory=dict)
    _n: int = 0
    _reach: float | None = None

    COLUMNS = (
        "case",
        "status",
        "exit_code",
        "text",
        "basis",
        "clearance",
        "penetration",
        "time",
        "body_a",
        "body_b",
        "reasons",
        "warnings",
        "waived",
    )

    @property
    def listed(self) -> list[dict[str, Any]]:
        """What `BatchAnswer.worst` says."""
        statuses = [status for status in reversed(STATUSES) if status in self.worst]
        turns = zip_longest(*(self.worst[status] for status in statuses))
        taken = [one for turn in turns for one in turn if one is not None][:MOST_WORST]
        by_status = sorted(taken, key=lambda one: statuses.index(one[1]["status"]))
        return [row for _, row in by_status]

    def add(self, part: pa.Table) -> None:
        """Takes some rows in, which come after those before."""
        found = (part[name].to_pylist() for name in ("clearance", "penetration"))
        reached = [reach_of(*row) for row in zip(*found, strict=True)]
        self.statuses.update(part["status"].to_pylist())
        self.bases.update(basis for basis in part["basis"].to_pylist() if basis)
        self.n_waived += sum(map(bool, part["waived"].to_pylist()))
        self.n_warned += sum(map(bool, part["warnings"].to_pylist()))
        self._add_least(part, reached)
        self._add_worst(part, part["exit_code"].to_pylist(), reached)
        self._n += part.num_rows

    def _add_least(self, part: pa.Table, reached: list[float | None]) -> None:
        known = [one for one in reached if one is not None]
        if known and (self._reach is None or min(known) < self._reach):
            self._reach = min(known)
            self.least = _row(part, reached.index(self._reach))

    def _add_worst(self, part: pa.Table, exit_code: list[int], reached: list[float | None]) -> None:
        failing = [i for i, code in enumerate(exit_code) if code]
        self.n_failing += len(failing)
        self.exit_code = max([self.exit_code, *(exit_code[i] for i in failing)])
        for status, numbers in _by_status(part, failing).items():
            standing = [(reached[i] or 0.0, self._n + i) for i in numbers]
            least = heapq.nsmallest(MOST_WORST, standing)
            found = [(one, _row(part, one[1] - self._n)) for one in least]
            before = self.worst.get(status, [])
            self.worst[status] = sorted([*before, *found], key=itemgetter(0))[:MOST_WORST]


def _by_status(part: pa.Table, numbers: list[int]) -> dict[str, list[int]]:
    statuses, found = part["status"].to_pylist(), defaultdict[str, list[int]](list)
    for i in numbers:
        found[statuses[i]].append(i)
    return found


def _row(part: pa.Table, i: int) -> dict[str, Any]:
    return part.slice(i, 1).to_pylist()[0]


def answer_of(outcome: Outcome, store: Store, *, strict: bool = False) -> BatchAnswer:
    """The answer of a batch of which every case has a row or a fault.

    Args:
        strict: a case that cannot be read or answered is bad input of the batch.
    """
    rows = StoredRows(outcome, store, outcome.tried, strict)
    return BatchAnswer(rows, _stale(outcome, rows) if outcome.whole else ())


def _stale(outcome: Outcome, rows: StoredRows) -> tuple[str, ...]:
    """What is wrong with waivers that cases share; rows are read only where there are some. While a case has no
    row it may be the one that needs a waiver: then only those that are expired are wrong.
    """
    items = outcome.items
    assert isinstance(items, Cases)  # a part has no answer
    if not outcome.is_answered:
        return expired_waivers(items, outcome.waivers)
    if not outcome.waivers and not any_of_cells(items):
        return ()
    needed = (
        tuple(own or ()) for part in rows.parts(["waivers"]) for own in part["waivers"].to_pylist()
    )
    among, told = stale_waivers_of_cells(items, needed)
    if not outcome.waivers:
        return tuple(told)
    day = items[0].options.day
    return (*told, *stale_waivers(items, outcome.waivers, among, day))

"""What a batch comes to: one table of all cases in their order, and the exit code.

It is made of the rows alone, so that it has the same bytes however often the batch was interrupted, and by
whomever its cases were measured. Not for: the files that are written of it (`output`).
"""

from __future__ import annotations

from collections import Counter
from itertools import chain
from typing import Any

import pyarrow as pa
import pyarrow.compute as pc

from clearance.batch.rows import ERROR, VERDICT, error_row
from clearance.batch.run import Outcome
from clearance.batch.shared_waivers import stale_waivers, stale_waivers_of_cells
from clearance.batch.store import Store
from clearance.findings.finding import NOT_PROVEN
from clearance.late_dataclass import dataclass

FAULT = 70
"""The exit code where this program is at fault, as of `clearance check`."""

VIOLATED, BAD_INPUT = 1, 2

STALE = "stale waiver"

STATUSES = ("clear", "near", STALE, NOT_PROVEN, "violated", "contact", "suspect", ERROR)
"""As a case's status can be, the better before the worse."""


@dataclass(frozen=True, eq=False)
class BatchAnswer:
    """All cases of a batch.

    Attributes:
        cases: one row a case, in order: `case`, its name, `key`, then the columns of `rows.VERDICT`. Where a case
            has no answer, its status is "error", its text says why, and most columns are null.
        findings: one row a finding, in order of the cases, the worst of a case first: `case`, then the columns of
            `rows.FINDING`.
        stale: what is wrong with waivers that the cases share, one line each.
    """

    cases: pa.Table
    findings: pa.Table
    stale: tuple[str, ...] = ()

    @property
    def counts(self) -> dict[str, int]:
        """How many cases have each status that occurs, the better before the worse."""
        found = Counter(self.cases["status"].to_pylist())
        return {status: found[status] for status in STATUSES if found[status]}

    @property
    def exit_code(self) -> int:
        """The greatest of all cases, and 1 for a waiver that should go."""
        return max([*self.cases["exit_code"].to_pylist(), VIOLATED if self.stale else 0])

    @property
    def status(self) -> str:
        """The worst of all cases; "stale waiver" where that is all that fails."""
        worst = next(reversed(self.counts), "clear")
        return STALE if self.stale and worst in ("clear", "near") else worst

    @property
    def bases(self) -> dict[str, int]:
        """What verdicts rest on: how many on the motion, how many on the samples only."""
        found = Counter(basis for basis in self.cases["basis"].to_pylist() if basis)
        return {basis: found[basis] for basis in ("motion", "samples") if found[basis]}

    def n_with(self, column: str) -> int:
        """How many cases have lines in a column: `waived` or `warnings`."""
        return sum(bool(lines) for lines in self.cases[column].to_pylist())

    @property
    def least(self) -> dict[str, Any] | None:
        """The row of the first case of least clearance; None where none is measured."""
        known = [one for one in self.cases["clearance"].to_pylist() if one is not None]
        if not known:
            return None
        i = self.cases["clearance"].to_pylist().index(min(known))
        return self.cases.slice(i, 1).to_pylist()[0]

    def worst_first(self) -> list[int]:
        """The rows that do not pass, the worst first: by exit code, then by clearance."""
        codes = self.cases["exit_code"].to_pylist()
        clearances = self.cases["clearance"].to_pylist()
        failing = [i for i, code in enumerate(codes) if code]
        return sorted(failing, key=lambda i: (-codes[i], clearances[i] or 0.0, i))


def answer_of(outcome: Outcome, store: Store, *, strict: bool = False) -> BatchAnswer:
    """The answer of a batch of which every case has a row or a fault.

    Args:
        strict: a case that cannot be read or answered is bad input of the batch.
    """
    known = [item.number for item in outcome.items if item.number in outcome.keys]
    failed = [item.number for item in outcome.items if item.number in outcome.faults]
    own = pa.schema([("key", pa.string()), *VERDICT])
    rows = store.rows([outcome.keys[number] for number in known]).select(own.names)
    of_input = BAD_INPUT if strict else VIOLATED
    faults = [outcome.faults[number] for number in failed]
    errors = [error_row(one.text, FAULT if one.trace else of_input) for one in faults]
    table = pa.concat_tables([rows, pa.Table.from_pylist(errors, schema=own)])
    place = {number: i for i, number in enumerate([*known, *failed])}
    items = [item for item in outcome.items if item.number in place]
    table = table.take(pa.array([place[item.number] for item in items], type=pa.int64()))
    names = pa.array([item.name for item in items], type=pa.string())
    findings = _findings(table, names)
    cases = table.drop_columns(["findings"]).add_column(0, "case", names)
    return BatchAnswer(cases, findings, _stale(outcome, cases) if outcome.is_answered else ())


def _stale(outcome: Outcome, cases: pa.Table) -> tuple[str, ...]:
    needed = [own or () for own in cases["waivers"].to_pylist()]
    told = stale_waivers_of_cells(outcome.items, needed)
    if not outcome.waivers:
        return tuple(told)
    among, day = set(chain.from_iterable(needed)), outcome.items[0].options.day
    return (*told, *stale_waivers(outcome.items, outcome.waivers, among, day))


def _findings(table: pa.Table, names: pa.Array) -> pa.Table:
    """The findings of all cases, a row each."""
    column = table["findings"].combine_chunks()
    if isinstance(column, pa.ChunkedArray):
        column = pa.concat_arrays(column.chunks)
    whose = pc.list_parent_indices(column)
    flat = pa.Table.from_struct_array(pc.list_flatten(column))
    return flat.add_column(0, "case", names.take(whose))

"""A batch from its list of cases to the rows of all: what the store has, and what is measured now.

Not for: where cases are measured (`engine`), and what is written of the rows (`answer`).
"""

from __future__ import annotations

import time
import uuid
from collections.abc import Callable, Iterator, Sequence
from contextlib import AbstractContextManager
from typing import TYPE_CHECKING

from clearance.batch.answer import reach_of
from clearance.batch.engine import Engine, Queue
from clearance.batch.file_hashes import FileHashes
from clearance.batch.item import Item
from clearance.batch.measuring import Fault, ItemResult, TaskResult
from clearance.batch.outcome import Outcome
from clearance.batch.plan import files_text, planned
from clearance.batch.store import Store
from clearance.errors import shown
from clearance.record.wording import depth_mm, near_mm

if TYPE_CHECKING:
    from rich.status import Status


MOST_LISTED = 50
"""Failures that are told as they come; the answer lists the worst, and the page has all."""


class BatchWatch:
    """Counts the cases of a batch, and says in one line how far it is.

    Args:
        status: the line of a terminal, if there is one; failures are printed above it.
    """

    def __init__(self, status: Status | None = None) -> None:
        self._status = status
        self._names: dict[int, str] = {}
        self._n_done, self._n_failing = 0, 0
        self._begun = time.monotonic()
        self._worst: ItemResult | None = None

    def begin(self, items: Sequence[Item]) -> None:
        """Begins to count what is to be measured."""
        self._names, self._begun = {one.number: one.name for one in items}, time.monotonic()

    def note(self, measured: Sequence[ItemResult], faults: Sequence[Fault]) -> None:
        """Counts cases that are measured, and whose rows are kept."""
        self._n_done += len(measured) + len(faults)
        before = () if self._worst is None else (self._worst,)
        self._worst = min((*before, *measured), key=_standing, default=None)
        failing = [f"error     {self._names[one.number]}: {one.text}" for one in faults]
        for one in measured:
            if one.row["exit_code"]:
                why = (one.row["reasons"] or [""])[0]
                failing.append(f"{one.row['status']:<9} {self._names[one.number]}: {why}")
        first, self._n_failing = self._n_failing, self._n_failing + len(failing)
        if self._status is not None:
            self._print(self._status, failing, first)

    def _print(self, status: Status, lines: Sequence[str], first: int) -> None:
        for i, line in enumerate(lines, first):
            text = shown(line) if i < MOST_LISTED else "further failures are listed at the end"
            if i <= MOST_LISTED:
                status.console.print(text, markup=False, highlight=False, soft_wrap=True)
        status.update(shown(self.line).replace("[", r"\["))

    @property
    def line(self) -> str:
        """How far it is."""
        n = len(self._names)
        if not self._n_done:
            return f"0 of {n:,} cases measured"
        rate = self._n_done / max(time.monotonic() - self._begun, 1e-9)
        pace = f"{rate:,.1f} cases/s, {(n - self._n_done) / rate:,.0f} s left"
        line = f"{self._n_done:,} of {n:,} cases measured, {pace}, {self._n_failing:,} failed"
        if self._worst is None or self._worst.row["clearance"] is None:
            return line
        row = self._worst.row
        near = near_mm(row["clearance"], row["measured"], " mm")
        if row["penetration"] is not None:
            near = f"{depth_mm(row['penetration'])} mm deep"
        near = near.removeprefix(row["status"])  # which may be "contact"
        return (
            f"{line}, worst {row['status']} {near}".rstrip()
            + f", {self._names[self._worst.number]}"
        )


def _standing(one: ItemResult) -> tuple[int, float]:
    """What cases are ordered by, the worst first; of those in contact the deepest."""
    reach = reach_of(one.row["clearance"], one.row["penetration"])
    return -one.row["exit_code"], float("inf") if reach is None else reach


Opener = Callable[[int], AbstractContextManager[Engine]]
"""Opens an engine for so many cases."""


def shard_of(items: Sequence[Item], shard: tuple[int, int]) -> Sequence[Item]:
    """The part `i` of `n` of the cases, from 1: every n-th, so that each part has some of every cell."""
    i, n = shard
    return items[i - 1 :: n]


def run_batch(
    outcome: Outcome,
    store: Store,
    opened: Opener,
    watch: BatchWatch,
    *,
    fresh: bool = False,
    rehash: bool = False,
) -> None:
    """Measures what the store does not have; whatever stops it, `outcome` says how far it came.

    Args:
        opened: not called where nothing is to be measured.
        fresh: measures all. rehash: believes no hash of an earlier run.

    Raises:
        Incomplete: a full disk, or nobody is left to measure; what was kept before is kept.
    """
    hashes = FileHashes() if rehash else FileHashes(store.known_hash)
    todo = planned(outcome, store, hashes, fresh=fresh)
    outcome.n_cached = len(outcome.keys)
    watch.begin(todo)
    if todo:
        items = {item.number: item for item in todo}
        with opened(len(todo)) as engine:
            for done in engine.results(Queue(todo, uuid.uuid4().hex)):
                _keep(done, items, store, hashes)
                outcome.keys.update((one.number, one.key) for one in done.measured)
                outcome.faults.update((one.number, one) for one in done.faults)
                watch.note(done.measured, done.faults)
    stamps = hashes.stamps()
    if stamps:
        store.put(stamps=stamps)


def _keep(done: TaskResult, items: dict[int, Item], store: Store, hashes: FileHashes) -> None:
    hashes.learn(done.read)
    faults = list(_fault_rows(done.faults, items))
    store.put(
        rows=((one.key, one.row) for one in done.measured),
        inputs=dict.fromkeys((items[one.number].file, one.inputs) for one in done.measured),
        stamps=hashes.stamps(),
        faults=faults,
        answered=(items[one.number].name for one in done.measured),
    )


def _fault_rows(
    faults: Sequence[Fault], items: dict[int, Item]
) -> Iterator[tuple[str, str, str, str]]:
    """Name, text, trace and files of each; the files as they are now."""
    hashes = FileHashes()
    for one in faults:
        item = items[one.number]
        yield item.name, one.text, one.trace, files_text(item, hashes)

"""A batch from its list of cases to the rows of all: what the store has, and what is measured now.

Not for: where cases are measured (`engine`), and what is written of the rows (`answer`).
"""

from __future__ import annotations

import uuid
from collections.abc import Callable, Iterator, Sequence
from contextlib import AbstractContextManager
from typing import Protocol

from clearance.batch.engine import Engine, Queue
from clearance.batch.file_hashes import FileHashes
from clearance.batch.item import Item
from clearance.batch.measuring import Fault, ItemResult, TaskResult
from clearance.batch.outcome import Outcome
from clearance.batch.plan import files_text, planned
from clearance.batch.store import Store


class Watch(Protocol):
    """An observer of the progress of a batch."""

    def begin(self, items: Sequence[Item], n_cached: int) -> None:
        """Before the first of some cases is measured; so many others need not be."""

    def note(self, measured: Sequence[ItemResult], faults: Sequence[Fault]) -> None:
        """After some cases are measured and their rows are kept."""


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
    watch: Watch,
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
    watch.begin(todo, outcome.n_cached)
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

"""A batch from its list of cases to the rows of all: what the store has, and what is measured now.

Not for: where cases are measured (`engine`), and what is written of the rows (`answer`).
"""

from __future__ import annotations

import uuid
from collections.abc import Callable, Sequence
from contextlib import AbstractContextManager
from dataclasses import field
from typing import Protocol

from clearance.batch.engine import Engine, Queue
from clearance.batch.file_hashes import FileHashes
from clearance.batch.item import Item
from clearance.batch.measuring import Fault, ItemResult, TaskResult
from clearance.batch.plan import planned
from clearance.batch.store import Store
from clearance.late_dataclass import dataclass
from clearance.world.waiver import Waiver


class Watch(Protocol):
    """Who is told how far a batch is."""

    def begin(self, items: Sequence[Item], n_cached: int) -> None:
        """Before the first of some cases is measured; so many others need not be."""

    def tell(self, measured: Sequence[ItemResult], faults: Sequence[Fault]) -> None:
        """After some cases are measured and their rows are kept."""


@dataclass
class Outcome:
    """What has become of the cases of a batch so far.

    Attributes:
        items: in order. keys: of those that have a row, by number. faults: of those that cannot have one.
        n_cached: of the keys, how many the store had. waivers: that the cases share.
        whole: False for a part of a batch.
    """

    items: Sequence[Item]
    keys: dict[int, str] = field(default_factory=dict)
    faults: dict[int, Fault] = field(default_factory=dict)
    n_cached: int = 0
    waivers: tuple[Waiver, ...] = ()
    whole: bool = True

    @property
    def is_answered(self) -> bool:
        """True if it is whole and each case has a row."""
        return self.whole and len(self.keys) == len(self.items)


Opener = Callable[[int], AbstractContextManager[Engine]]
"""Opens an engine for so many cases."""


def shard_of(items: Sequence[Item], shard: tuple[int, int]) -> list[Item]:
    """The part `i` of `n` of the cases, from 1: every n-th, so that each part has some of every cell."""
    i, n = shard
    return list(items[i - 1 :: n])


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
    hashes = FileHashes({} if rehash else store.hashes())
    plan = planned(outcome.items, store, hashes, fresh=fresh)
    outcome.keys.update(plan.keys)
    outcome.n_cached = len(plan.keys)
    watch.begin(plan.todo, len(plan.keys))
    try:
        if plan.todo:
            with opened(len(plan.todo)) as engine:
                for done in engine.results(Queue(plan.todo, uuid.uuid4().hex)):
                    _keep(done, store, hashes, outcome)
                    watch.tell(done.measured, done.faults)
    finally:
        if hashes.is_new:
            store.keep_hashes(hashes.known)


def _keep(done: TaskResult, store: Store, hashes: FileHashes, outcome: Outcome) -> None:
    if done.segment:
        store.put(done.segment)
    hashes.learn(done.read)
    outcome.keys.update((one.number, one.key) for one in done.measured)
    outcome.faults.update((one.number, one) for one in done.faults)

"""What hands cases to whoever measures them: tasks are cut from a queue, and what comes back in part goes on it.

`LocalEngine` does all here; `workers` has processes of this machine, `dask_engine` those of others. The answer
does not depend on which engine it was. Not for: what a task is (`measuring`).
"""

from __future__ import annotations

from collections import deque
from collections.abc import Iterator, Sequence
from typing import Protocol

from clearance.batch.item import Item
from clearance.batch.keys import program
from clearance.batch.measuring import Task, TaskResult, measure

MOST = 64
"""Cases of a task: what is lost with a worker, at most."""

LEAST = 8
"""Cases of a task where as many wait: to hand one out and take it back costs as much as half a short case."""

SECONDS = 1.0
"""After so long a task comes back with what it has."""


class Queue:
    """The cases that wait, in order.

    Args:
        batch: as in `measuring.Task`.
    """

    def __init__(self, items: Sequence[Item], batch: str) -> None:
        self._items, self._taken = items, 0
        self._returned: deque[Item] = deque()
        self._alone: set[int] = set()
        self._batch = batch

    def __len__(self) -> int:
        return len(self._returned) + len(self._items) - self._taken

    def task(self, n_hands: int = 1) -> Task | None:
        """The next cases, all of one cell; None where none waits.

        Args:
            n_hands: tasks that are out at a time. Each is a share of what waits, so all end at about one time.
        """
        if not len(self):
            return None
        share = min(MOST, max(LEAST, -(-len(self) // n_hands)))
        first = self._take()
        items = [first]
        while len(items) < share and len(self) and self._goes_with(first):
            items.append(self._take())
        return Task(tuple(items), SECONDS, program(), self._batch)

    def _take(self) -> Item:
        if self._returned:
            return self._returned.popleft()
        self._taken += 1
        return self._items[self._taken - 1]

    def _goes_with(self, first: Item) -> bool:
        """True if the next case can be in one task with another."""
        after = self._returned[0] if self._returned else self._items[self._taken]
        alone = first.number in self._alone or after.number in self._alone
        return after.file == first.file and not alone

    def give_back(self, items: Sequence[Item], *, alone: bool = False) -> None:
        """Puts cases before all others.

        Args:
            alone: each is a task of its own from now on.
        """
        self._returned.extendleft(reversed(items))
        if alone:
            self._alone.update(item.number for item in items)


class Engine(Protocol):
    """Whoever measures."""

    def results(self, queue: Queue) -> Iterator[TaskResult]:
        """What the tasks of a queue come to, in any order, until none is left.

        Raises:
            Incomplete: nobody is left who could measure.
        """
        ...


class LocalEngine:
    """Measures one case after another."""

    def results(self, queue: Queue) -> Iterator[TaskResult]:
        """What the tasks come to, in order."""
        while (task := queue.task()) is not None:
            done = measure(task)
            queue.give_back(done.left)
            yield done

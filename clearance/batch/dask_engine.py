"""Cases spread over machines by Dask: the workers of a scheduler that runs already.

This is the one file that imports Dask. Two tasks a worker are handed out at a time, each result is taken and let
go at once, so the scheduler never holds more than the tasks in flight. What a worker that is lost had begun is
done again by another; a task that takes several workers with it is cut into its cases, and a case that does is at
fault itself. Not for: what a task is (`measuring`), nor the queue (`engine`).
"""

from __future__ import annotations

import logging
import math
import time
from collections.abc import Iterator
from contextlib import contextmanager
from typing import TYPE_CHECKING, Any

from clearance.batch.engine import Queue
from clearance.batch.measuring import Fault, Task, TaskResult, measure
from clearance.errors import BadBatch, Incomplete
from clearance.extras import importing

if TYPE_CHECKING:
    from distributed import Client, Future

AHEAD = 2
"""Tasks a worker that are handed out at a time: one is measured, one waits."""

RECOUNTING = 1.0
"""[s] After which workers are counted again."""

CONNECTING = 20
"""[s] In which a scheduler must answer."""


@contextmanager
def cluster_at(address: str) -> Iterator[DaskEngine]:
    """The workers of a scheduler that runs already.

    Raises:
        Unavailable: Dask is not installed. BadInput: nothing answers there.
    """
    with importing("batch", "--scheduler"):
        import distributed
    with _settings():
        try:
            client = distributed.Client(address, timeout=CONNECTING)
        except (OSError, ValueError) as error:
            raise BadBatch(
                f"no scheduler answers ({type(error).__name__})",
                where=f"--scheduler {address}",
                valid="an address such as tcp://host:8786 of a dask scheduler of the same version",
            ) from None
        try:
            yield DaskEngine(client)
        finally:
            client.close(timeout=1)


@contextmanager
def _settings() -> Iterator[None]:
    """What Dask is told: say nothing by itself, and wait no longer than asked."""
    import dask

    for name in [*logging.root.manager.loggerDict, "tornado.application"]:
        if name.startswith(("distributed", "tornado.application")):
            logging.getLogger(name).setLevel(logging.CRITICAL)
    with dask.config.set({"distributed.comm.timeouts.connect": f"{CONNECTING}s"}):
        yield


class DaskEngine:
    """Hands the tasks of a queue to the workers of a cluster.

    Attributes:
        client: of the cluster.
    """

    def __init__(self, client: Client) -> None:
        self.client = client
        self._counted, self._counted_at = 1, -math.inf

    def results(self, queue: Queue) -> Iterator[TaskResult]:
        """What the tasks come to, as they come.

        Raises:
            Incomplete: the scheduler is gone, or no worker is left.
        """
        from distributed import as_completed

        running: dict[Future, Task] = {}
        finished = as_completed([])
        try:
            self._fill(queue, running, finished)
            while running:
                future = next(finished)
                task = running.pop(future)
                done = self._result(future, task, queue)
                future.release()
                if done is not None:
                    queue.give_back(done.left)
                self._fill(queue, running, finished)
                if done is not None:
                    yield done
        finally:
            for future in running:
                future.release()

    def _fill(self, queue: Queue, running: dict[Future, Task], finished: Any) -> None:
        n_hands = AHEAD * self._n_workers()
        while len(running) < n_hands:
            task = queue.task(n_hands)
            if task is None:
                return
            future = self.client.submit(measure, task, pure=False)
            running[future] = task
            finished.add(future)

    def _n_workers(self) -> int:
        """How many there are, asked for once a second at most: they come, and some are lost."""
        now = time.monotonic()
        if now - self._counted_at > RECOUNTING:
            self._counted = max(1, len(self.client.ncores() or ()))
            self._counted_at = now
        return self._counted

    def _result(self, future: Future, task: Task, queue: Queue) -> TaskResult | None:
        """What a task came to; None where its cases wait again, one by one."""
        from distributed.client import FutureCancelledError
        from distributed.scheduler import KilledWorker

        try:
            return future.result()
        except KilledWorker:
            if len(task.items) == 1:
                text = "the worker processes that measured it have all died, of memory perhaps"
                return TaskResult((), (Fault(task.items[0].number, text),), (), ())
            queue.give_back(task.items, alone=True)
            return None
        except (FutureCancelledError, OSError) as error:
            raise Incomplete(
                f"the scheduler is gone ({type(error).__name__})",
                valid="what was measured is kept; the same command goes on with the rest",
            ) from None

"""Worker processes on this machine, each at the end of a pipe: a task goes in, what it came to comes back.

A worker that dies breaks its own pipe and no other, so it is known which task it had. That task is cut into its
cases, and a case that takes `DEATHS` workers with it is at fault itself. A worker whose parent is gone reads the
end of its pipe, and ends. Not for: what a task is (`measuring`), nor the queue (`engine`).
"""

from __future__ import annotations

import os
import signal
from collections import Counter
from collections.abc import Iterator
from contextlib import contextmanager, suppress
from multiprocessing import get_context, resource_tracker
from multiprocessing.connection import Connection, wait

from clearance.batch.engine import Queue
from clearance.batch.measuring import Fault, Task, TaskResult, measure
from clearance.errors import Incomplete

DEATHS = 3
"""Workers that a case may take with it, or that may die one after another as they start."""

SHARES = 2
"""Tasks a worker that the waiting cases are cut into at least, so that all workers end at about one time."""

_READY = "ready"
_THREADS = ("OMP_NUM_THREADS", "OPENBLAS_NUM_THREADS", "MKL_NUM_THREADS")


def _work(pipe: Connection) -> None:
    """What a worker does: says that it is there, then measures until its parent lets go or is gone."""
    signal.signal(signal.SIGINT, signal.SIG_IGN)  # the parent ends it
    with suppress(EOFError, OSError):
        pipe.send(_READY)
        while True:
            task = pipe.recv()
            try:
                done: TaskResult | Incomplete = measure(task)
            except Incomplete as error:
                done = error
            pipe.send(done)


class Worker:
    """A process, and the task that it has; None while it starts or waits."""

    def __init__(self) -> None:
        context = get_context("spawn")
        self.pipe, others = context.Pipe()
        self.process = context.Process(target=_work, args=(others,))
        self.task: Task | None = None
        self.is_ready = False
        with _as_a_worker():
            self.process.start()
        others.close()

    def end(self) -> None:
        """Ends the process, whatever it does."""
        self.pipe.close()
        self.process.kill()
        self.process.join()


class WorkerEngine:
    """Hands the tasks of a queue to workers; made by `local_workers`."""

    def __init__(self, n_workers: int) -> None:
        self._workers = [Worker() for _ in range(n_workers)]
        self._deaths: Counter[int] = Counter()
        self._starts_lost = 0

    @property
    def processes(self) -> list[int]:
        """The numbers of the workers' processes."""
        return [one.process.pid for one in self._workers if one.process.pid is not None]

    def results(self, queue: Queue) -> Iterator[TaskResult]:
        """What the tasks come to, as they come.

        Raises:
            Incomplete: no workers can be started.
        """
        self._hand_out(queue)
        while len(queue) or any(one.task for one in self._workers):
            ready = wait([one.pipe for one in self._workers])
            for one in [one for one in self._workers if one.pipe in ready]:
                done = self._received(one, queue)
                self._hand_out(queue)
                if done is not None:
                    yield done

    def _hand_out(self, queue: Queue) -> None:
        """Gives a task to each worker that waits for one."""
        for one in self._workers:
            if one.is_ready and one.task is None:
                one.task = queue.task(SHARES * len(self._workers))
                if one.task is not None:
                    with suppress(OSError):  # it is gone, which its pipe tells
                        one.pipe.send(one.task)

    def _received(self, one: Worker, queue: Queue) -> TaskResult | None:
        """What a worker has sent; None where that it is ready, or where it has died."""
        try:
            message = one.pipe.recv()
        except (EOFError, OSError):
            return self._replaced(one, queue)
        if message == _READY:
            one.is_ready, self._starts_lost = True, 0
            return None
        one.task = None
        if isinstance(message, Incomplete):
            raise message
        queue.give_back(message.left)
        return message

    def _replaced(self, one: Worker, queue: Queue) -> TaskResult | None:
        """Puts a new worker in the place of one that has died; the cases of its task wait again, one by one."""
        one.end()
        self._starts_lost += not one.is_ready
        if self._starts_lost >= DEATHS:
            raise Incomplete(
                "no worker processes can be started: each dies as it begins",
                valid="--jobs 1 needs none",
            )
        self._workers[self._workers.index(one)] = Worker()
        items = () if one.task is None else one.task.items
        if len(items) == 1:
            number = items[0].number
            self._deaths[number] += 1
            if self._deaths[number] >= DEATHS:
                text = "the worker processes that measured it have all died, of memory perhaps"
                return TaskResult((), (Fault(number, text),), (), ())
        queue.give_back(items, alone=True)
        return None

    def end(self) -> None:
        """Ends all workers."""
        for one in self._workers:
            one.end()


@contextmanager
def local_workers(n_workers: int) -> Iterator[WorkerEngine]:
    """So many worker processes on this machine.

    Raises:
        Incomplete: no process can be started.
    """
    try:
        engine = WorkerEngine(n_workers)
    except OSError as error:
        raise Incomplete(
            f"no worker processes can be started ({error})", valid="--jobs 1 needs none"
        ) from None
    try:
        yield engine
    finally:
        engine.end()


@contextmanager
def _as_a_worker() -> Iterator[None]:
    """Processes that are started inside use one thread each, and never see an interrupt from the terminal."""
    resource_tracker.ensure_running()  # which would hear of interrupts again as it starts
    before = {name: os.environ.get(name) for name in _THREADS}
    os.environ.update(dict.fromkeys(_THREADS, "1"))
    can_mask = hasattr(signal, "pthread_sigmask")
    mask = signal.pthread_sigmask(signal.SIG_BLOCK, {signal.SIGINT}) if can_mask else None
    try:
        yield
    finally:
        if mask is not None:
            signal.pthread_sigmask(signal.SIG_SETMASK, mask)
        for name, value in before.items():
            if value is None:
                del os.environ[name]
            else:
                os.environ[name] = value

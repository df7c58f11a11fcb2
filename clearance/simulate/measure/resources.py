"""What a long run may use, and its work in parts: threads, a call that reports progress, a place for its rows."""

from __future__ import annotations

import functools
import itertools
import os
from collections import deque
from collections.abc import Callable, Iterator, Sequence
from concurrent.futures import Future, ThreadPoolExecutor, wait
from dataclasses import dataclass, replace
from typing import TypeVar

from clearance.errors import BadInput
from clearance.progress import Progress
from clearance.record.rows.resumable import IN_MEMORY, MeasuredRows

Result = TypeVar("Result")

LONGEST_PART = 256
"""Rows of a part at most; short enough to show progress, long enough for bounds to be carried."""

SPARSE = 4
"""Times as long are parts of which many rows need no visit."""

WAITING = 8
"""Parts a thread that are handed out ahead: so many results wait at most."""


def usable_cores() -> int:
    """The cores that this process may run on."""
    if hasattr(os, "sched_getaffinity"):
        return len(os.sched_getaffinity(0))
    return os.cpu_count() or 1


def parts(n_rows: int, *, sparse: bool = False) -> list[slice]:
    """The rows in parts of at most `LONGEST_PART`, or `SPARSE` times that; an even number where they are long."""
    longest = LONGEST_PART * (SPARSE if sparse else 1)
    n_parts = 2 * -(-n_rows // (2 * longest)) if n_rows > longest // 2 else 1
    ends = [n_rows * i // n_parts for i in range(n_parts + 1)]
    return [slice(start, end) for start, end in zip(ends, ends[1:], strict=False)]


def in_order(
    work: Callable[[slice], Result], spans: Sequence[slice], jobs: int
) -> Iterator[Result]:
    """The results of `work` for each span, in order, from so many threads; this one does what none has begun."""
    if jobs == 1 or len(spans) <= 1:
        yield from map(work, spans)
        return
    pool, waiting = _threads(jobs - 1), iter(spans)
    ahead: deque[tuple[slice, Future[Result]]] = deque()
    try:
        while True:
            room = WAITING * jobs - len(ahead)
            ahead += [(span, pool.submit(work, span)) for span in itertools.islice(waiting, room)]
            if not ahead:
                return
            span, result = ahead.popleft()
            yield work(span) if result.cancel() else result.result()
    finally:  # also where the caller wants no more: then no thread writes any more
        for _, result in ahead:
            result.cancel()
        wait([result for _, result in ahead])


@functools.lru_cache(maxsize=1)
def _threads(jobs: int) -> ThreadPoolExecutor:
    """So many threads, which stay for the next run: to start them takes as long as a hundred steps."""
    return ThreadPoolExecutor(jobs, thread_name_prefix="clearance")


if hasattr(os, "register_at_fork"):
    os.register_at_fork(after_in_child=_threads.cache_clear)  # a child process has none of them


@dataclass(frozen=True, eq=False)
class Resources:
    """The resources of a run.

    Attributes:
        jobs: threads; as many as the machine has to offer if None. The answer does not depend on it.
        progress: called with steps done and all steps.
        rows: where they are stored; in memory by default. In `open_resumable_rows` memory does not grow with the
            steps, and the same question asked again goes on where an interrupted run was.
        prefix: of the names of its rows.

    Raises:
        BadInput: fewer than one thread.
    """

    jobs: int | None = None
    progress: Progress | None = None
    rows: MeasuredRows = IN_MEMORY
    prefix: str = ""

    def __post_init__(self) -> None:
        if self.jobs is not None and (not isinstance(self.jobs, int) or self.jobs < 1):
            raise BadInput(f"{self.jobs} jobs", valid="1 or more")

    def of_section(self, number: int, steps: tuple[int, int], of: int) -> Resources:
        """The same for one section of several, whose rows have names of their own.

        Args:
            steps: of all sections before it, and with it. of: of all sections.
        """
        progress, (before, end) = self.progress, steps

        def shifted(done: int, total: int) -> None:
            """Counts in steps what a measurement counts in its own parts."""
            assert progress is not None
            progress(before + (end - before) * done // total, of)

        return replace(self, progress=progress and shifted, prefix=f"{self.prefix}{number}-")

    @property
    def n_threads(self) -> int:
        """How many threads there are to be."""
        return self.jobs or usable_cores()


DEFAULT_RESOURCES = Resources()
"""All threads, no progress reported, rows in memory."""

"""Long work in parts: how many, on how many threads, and their results in order."""

from __future__ import annotations

import functools
import itertools
import os
from collections import deque
from collections.abc import Callable, Iterator, Sequence
from concurrent.futures import Future, ThreadPoolExecutor, wait
from typing import TypeVar

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

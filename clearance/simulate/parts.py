"""Long work in parts: how many, on how many threads, and their results in order."""

from __future__ import annotations

import functools
import os
from collections import deque
from collections.abc import Callable, Iterator, Sequence
from concurrent.futures import ThreadPoolExecutor, wait
from typing import TypeVar

Result = TypeVar("Result")

LONGEST_PART = 256
"""Rows of a part at most; short enough to show progress, long enough for bounds to be carried."""

SPARSE = 4
"""Times as long are parts of which many rows need not be looked at."""

WAITING = 8
"""Parts a thread that are handed out ahead: so many results wait at most."""

BLOCK = 2**16
"""Rows that are looked at together where all rows are gone through: 0.5 MB of each number."""


def parts(n_rows: int, *, sparse: bool = False) -> list[slice]:
    """The rows in parts of at most `LONGEST_PART`, or `SPARSE` times that; an even number where they are long."""
    longest = LONGEST_PART * (SPARSE if sparse else 1)
    n_parts = 2 * -(-n_rows // (2 * longest)) if n_rows > longest // 2 else 1
    ends = [n_rows * i // n_parts for i in range(n_parts + 1)]
    return [slice(start, end) for start, end in zip(ends, ends[1:], strict=False)]


def blocks(n_rows: int) -> Iterator[slice]:
    """The rows in blocks of `BLOCK`; the last one is shorter."""
    for start in range(0, n_rows, BLOCK):
        yield slice(start, min(start + BLOCK, n_rows))


def in_order(
    work: Callable[[slice], Result], spans: Sequence[slice], jobs: int
) -> Iterator[Result]:
    """The results of `work` for each span, in order, from as many threads as are asked for."""
    if jobs == 1 or len(spans) <= 1:
        yield from map(work, spans)
        return
    pool = _threads(jobs)
    running = deque()
    try:
        for span in spans:
            running.append(pool.submit(work, span))
            if len(running) >= WAITING * jobs:
                yield running.popleft().result()
        while running:
            yield running.popleft().result()
    finally:  # also where the caller wants no more: then no thread writes any more
        for result in running:
            result.cancel()
        wait(running)


@functools.lru_cache(maxsize=1)
def _threads(jobs: int) -> ThreadPoolExecutor:
    """So many threads, which stay for the next run: to start them takes as long as a hundred steps."""
    return ThreadPoolExecutor(jobs, thread_name_prefix="clearance")


if hasattr(os, "register_at_fork"):
    os.register_at_fork(after_in_child=_threads.cache_clear)  # a child process has none of them

"""Long work in parts: how many, on how many threads, and their results in order."""

from __future__ import annotations

import os
from collections.abc import Callable, Iterator, Sequence
from concurrent.futures import ThreadPoolExecutor
from typing import TypeVar

Result = TypeVar("Result")

LONGEST_PART = 128
"""Rows of a part at most; short enough to show progress, long enough for bounds to be carried."""


def usable_cores() -> int:
    """The cores that this process may run on."""
    if hasattr(os, "sched_getaffinity"):
        return len(os.sched_getaffinity(0))
    return os.cpu_count() or 1


def parts(n_rows: int) -> list[slice]:
    """The rows in parts of at most `LONGEST_PART`, an even number of them where they are long."""
    n_parts = 2 * -(-n_rows // (2 * LONGEST_PART)) if n_rows > LONGEST_PART // 2 else 1
    ends = [n_rows * i // n_parts for i in range(n_parts + 1)]
    return [slice(start, end) for start, end in zip(ends, ends[1:], strict=False)]


def in_order(
    work: Callable[[slice], Result], spans: Sequence[slice], jobs: int
) -> Iterator[Result]:
    """The results of `work` for each span, in order, from as many threads as are asked for."""
    if jobs == 1 or len(spans) == 1:
        yield from map(work, spans)
        return
    pool = ThreadPoolExecutor(min(jobs, len(spans)))
    try:
        yield from pool.map(work, spans)
    finally:
        pool.shutdown(cancel_futures=True)

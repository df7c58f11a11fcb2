"""The clock of the benchmarks: warm-up, interleaved passes, median and spread of CPU time.

CPU time of this one-threaded process, not time on the wall: the same on a quiet machine, and still a
measurement on a busy one. Passes of all contenders take turns, so that a change of the machine's speed
meets all of them. In each pass a contender's work is done again until it has taken `LEAST_PASS`: what takes a
millisecond is otherwise half the time it takes to fetch its data again after all the others. That first time
is told too.
"""

from __future__ import annotations

import time
from collections.abc import Callable, Sequence
from typing import Any, NamedTuple

import numpy as np

LEAST_PASS = 0.05
"""[s] CPU time of a pass at least."""


class Timing(NamedTuple):
    """Seconds of CPU that the work takes: median, least and greatest over `n_passes`; what it returned last.

    Attributes:
        first: the median of the first time in each pass, right after the others' turns.
    """

    median: float
    least: float
    greatest: float
    first: float
    n_passes: int
    answer: Any


class Pass(NamedTuple):
    """CPU seconds of the work in one pass: the first time, all times together, and how many there were."""

    first: float
    total: float
    n_times: int


def timed(work: Callable[[], Any]) -> tuple[float, Any]:
    """CPU seconds of one call, and its value."""
    start = time.process_time()
    answer = work()
    return time.process_time() - start, answer


def least_time(work: Callable[[], object], n_times: int) -> float:
    """[s] CPU time, the least of several calls."""
    return min(timed(work)[0] for _ in range(n_times))


def interleaved(works: Sequence[Callable[[], Any]], n_passes: int, budget: float) -> list[Timing]:
    """The timing of each of `works`: one call to warm up, then `n_passes` in turns, two at least.

    A work takes no further part once it has spent `budget` [s].
    """
    passes: list[list[Pass]] = [[] for _ in works]
    answers = [work() for work in works]
    for i_pass in range(n_passes):
        for i, work in enumerate(works):
            if i_pass < 2 or sum(each.total for each in passes[i]) < budget:
                done, answers[i] = _pass(work)
                passes[i].append(done)
    return [_timing(done, answer) for done, answer in zip(passes, answers, strict=True)]


def geometric_mean(ratios: Sequence[float]) -> float:
    """The factor that, in place of each of some ratios of times, would give their product."""
    return float(np.exp(np.log(ratios).mean()))


def _pass(work: Callable[[], Any]) -> tuple[Pass, Any]:
    first, answer = timed(work)
    total, n_times = first, 1
    while total < LEAST_PASS:
        passed, answer = timed(work)
        total, n_times = total + passed, n_times + 1
    return Pass(first, total, n_times), answer


def _timing(passes: list[Pass], answer: Any) -> Timing:
    seconds = [each.total / each.n_times for each in passes]
    first = float(np.median([each.first for each in passes]))
    return Timing(
        float(np.median(seconds)), min(seconds), max(seconds), first, len(seconds), answer
    )

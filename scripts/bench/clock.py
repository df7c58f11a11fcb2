"""The clock of the benchmarks: warm-up, interleaved passes, median and spread of CPU time.

CPU time of this one-threaded process, not time on the wall: the same on a quiet machine, and still a
measurement on a busy one. Passes of all contenders take turns, so that a change of the machine's speed
meets all of them.
"""

from __future__ import annotations

import time
from collections.abc import Callable, Sequence
from typing import Any, NamedTuple

import numpy as np


class Timing(NamedTuple):
    """Seconds of CPU a pass: median, least and greatest over `n_passes`; and what the last one returned."""

    median: float
    least: float
    greatest: float
    n_passes: int
    answer: Any


def timed(work: Callable[[], Any]) -> tuple[float, Any]:
    """CPU seconds of one call, and its value."""
    start = time.process_time()
    answer = work()
    return time.process_time() - start, answer


def interleaved(works: Sequence[Callable[[], Any]], n_passes: int, budget: float) -> list[Timing]:
    """The timing of each of `works`: one call to warm up, then `n_passes` in turns, two at least.

    A work takes no further part once it has spent `budget` [s].
    """
    seconds: list[list[float]] = [[] for _ in works]
    answers = [work() for work in works]
    for i_pass in range(n_passes):
        for i, work in enumerate(works):
            if i_pass < 2 or sum(seconds[i]) < budget:
                passed, answers[i] = timed(work)
                seconds[i].append(passed)
    return [_timing(taken, answer) for taken, answer in zip(seconds, answers, strict=True)]


def _timing(seconds: list[float], answer: Any) -> Timing:
    return Timing(float(np.median(seconds)), min(seconds), max(seconds), len(seconds), answer)

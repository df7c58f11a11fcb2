"""The memory of kernels: threads have each their own, and all is given back."""

from __future__ import annotations

import threading
from concurrent.futures import ThreadPoolExecutor

import numpy as np
import pytest

from clearance.compile.decorators import KERNELS
from clearance.compile.library import free_memory
from clearance.compile.memory import FIRST_CHUNK
from clearance.kernels.arithmetic.union_find import joined_labels
from tests.compile.kernel_memory import mark

pytestmark = pytest.mark.skipif(KERNELS != "built", reason="the library is not used")


def chained(n: int) -> np.ndarray:
    """The labels of n things, each joined to the next: all alike."""
    return joined_labels(n, np.arange(n - 1), np.arange(1, n))


def test_a_result_outlives_the_next_call_and_nothing_is_left_taken():
    free_memory()
    before = mark()
    first = chained(1000)
    other = joined_labels(1000, np.zeros(0, np.int64), np.zeros(0, np.int64))
    assert (first == first[0]).all() and len(set(other.tolist())) == 1000
    chained(3 * FIRST_CHUNK // 8)
    assert mark() == before


def test_threads_do_not_disturb_each_other():
    n_threads, n = 8, 20_000
    together = threading.Barrier(n_threads)

    def answered(i: int) -> tuple[int, np.ndarray]:
        together.wait()
        found = [chained(n + i) for _ in range(5)][-1]
        together.wait()
        return mark(), found

    with ThreadPoolExecutor(n_threads) as pool:
        marks, found = zip(*pool.map(answered, range(n_threads)), strict=True)
    assert len(set(marks)) == n_threads
    assert [len(labels) for labels in found] == [n + i for i in range(n_threads)]
    assert all((labels == labels[0]).all() for labels in found)  # also of threads that have ended

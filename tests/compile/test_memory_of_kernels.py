"""The memory of kernels: results outlive it, threads have each their own, and all is given back."""

from __future__ import annotations

import ctypes
import threading
from concurrent.futures import ThreadPoolExecutor

import numpy as np
import pytest

from clearance.compile.calls import KernelFault
from clearance.compile.declared import Floats, Integers
from clearance.compile.decorators import KERNELS
from clearance.compile.library import free_memory
from clearance.compile.memory import FIRST_CHUNK
from tests.compile.spoken import answered, mark, release, take, words_of_array, write_words

pytestmark = pytest.mark.skipif(KERNELS != "built", reason="the library is not used")


def counting(n: int, first: int) -> Integers:
    """n integers from `first` on."""


def answer_counting(given: int, result: int) -> int:
    n, first = (ctypes.c_int64 * 2).from_address(given)
    data = take(8 * n)
    write_words(data, list(range(first, first + n)))
    write_words(result, words_of_array(data, (n,), (8,)))
    return 0


def test_arrays_of_a_result_outlive_the_next_call():
    with answered(counting, answer_counting) as kernel:
        first, second = kernel(1000, 0), kernel(1000, 5)
    assert first.tolist() == list(range(1000)) and second.tolist() == list(range(5, 1005))


def test_nothing_is_left_taken_after_a_result_is_read():
    free_memory()
    before = mark()
    with answered(counting, answer_counting) as kernel:
        for n in (10, 3 * FIRST_CHUNK // 8, 10):
            kernel(n, 0)
            assert mark() == before


def test_nothing_is_left_taken_after_a_fault():
    free_memory()
    before = mark()
    with (
        answered(counting, lambda *_: take(5 * FIRST_CHUNK) and 1) as kernel,
        pytest.raises(KernelFault),
    ):
        kernel(1, 1)
    assert mark() == before


def test_pieces_are_aligned_and_do_not_overlap():
    sizes = [1, 63, 64, 65, 0, FIRST_CHUNK - 200, 1, 8 * FIRST_CHUNK, 7]
    taken = [(take(size), size) for size in sizes]
    for i, (place, size) in enumerate(taken):
        assert place % 64 == 0
        ctypes.memset(place, i, size)
    for i, (place, size) in enumerate(taken):
        assert ctypes.string_at(place, size) == bytes([i]) * size
    free_memory()


def test_what_was_taken_since_a_mark_is_given_back_over_several_chunks():
    free_memory()
    kept = take(100)
    ctypes.memset(kept, 7, 100)
    marked = mark()
    for size in (1000, 2 * FIRST_CHUNK, 10, 20 * FIRST_CHUNK):
        take(size)
    release(marked)
    assert mark() == marked and take(8) == marked
    assert ctypes.string_at(kept, 100) == bytes([7]) * 100
    free_memory()


def test_threads_do_not_disturb_each_other():
    n_threads, n = 8, 20_000
    together = threading.Barrier(n_threads)

    def answer(given: int, result: int) -> int:
        together.wait()
        return answer_counting(given, result)

    with answered(counting, answer) as kernel, ThreadPoolExecutor(n_threads) as pool:
        found = list(pool.map(lambda first: kernel(n, first), range(0, 1000, 125)))
        marks = set(pool.map(lambda _: (together.wait(), mark())[1], range(n_threads)))
    assert [array[0] for array in found] == list(range(0, 1000, 125))
    assert all((np.diff(array) == 1).all() and len(array) == n for array in found)
    assert len(marks) == n_threads


def test_a_result_of_a_thread_that_has_ended_is_kept():
    def floats(n: int) -> Floats: ...

    with answered(floats, lambda given, result: answer_floats(given, result)) as kernel:
        found: list[np.ndarray] = []
        thread = threading.Thread(target=lambda: found.append(kernel(1000)))
        thread.start()
        thread.join()
    assert (found[0] == 0.5).all()


def answer_floats(given: int, result: int) -> int:
    n = ctypes.c_int64.from_address(given).value
    data = take(8 * n)
    (ctypes.c_double * n).from_address(data)[:] = [0.5] * n
    write_words(result, words_of_array(data, (n,), (8,)))
    return 0

"""What is hot stays hot: the work of a question is what the table beside this file says, neither more nor less.

A commit that changes the work on purpose writes the table anew: `python -m tests.simulate.counted_work`.
"""

from __future__ import annotations

import numpy as np
import pytest

import clearance as cl
from clearance.geometry.pose import inverse
from tests.shared_cases import SHARED_NAMES, shared_case
from tests.simulate import counted_work

TABLE = counted_work.table()


@pytest.mark.parametrize("question", counted_work.QUESTIONS)
def test_a_warm_question_makes_as_many_calls_as_the_table_says(question: str) -> None:
    calls = counted_work.calls_of(counted_work.QUESTIONS[question]())
    assert calls == TABLE["calls"][question]


@pytest.mark.parametrize("certify", [False, True])
def test_further_steps_make_as_many_calls_as_the_table_says(certify: bool) -> None:
    key = "further steps, certified" if certify else "further steps"
    assert counted_work.calls_of_further_steps(certify) == TABLE["calls"][key]


@pytest.mark.parametrize("name", counted_work.SCENES)
def test_kernels_count_what_the_table_says_of_a_scene(name: str) -> None:
    assert counted_work.counters_of_run(counted_work.scene(name)) == TABLE["runs"][name]


@pytest.mark.parametrize("name", SHARED_NAMES)
def test_kernels_count_what_the_table_says_of_a_shared_case(name: str) -> None:
    case = cl.load_case(shared_case(name))
    assert counted_work.counters_of_run(case) == TABLE["runs"][name]


@pytest.mark.parametrize("name", counted_work.PAIRS)
def test_kernels_count_what_the_table_says_of_a_pair(name: str) -> None:
    assert counted_work.counters_of_pair(name) == TABLE["pairs"][name]


def test_calls_are_counted_by_whose_they_are() -> None:
    """`inverse` calls asarray, zeros_like, swapaxes and einsum; a comprehension is no call."""
    pose = np.eye(4)
    assert counted_work.calls_of(lambda: inverse(pose)) == {"package": 1, "numpy": 4}
    assert counted_work.calls_of(lambda: [0 for _ in range(3)]) == {"package": 0, "numpy": 0}

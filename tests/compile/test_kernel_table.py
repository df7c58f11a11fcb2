"""Kernels that are called by address: compiled when they are needed, refused to callers with other types."""

import os
import subprocess
import sys
from pathlib import Path

import numba
import numpy as np
import pytest

from clearance.compile import kernel_table
from clearance.compile.jit import inline, kernel
from clearance.compile.kernel_table import MEETING, at_address, call
from clearance.kernels.features import meeting
from tests.reached import reached

ROOT = Path(__file__).parents[2]

compiled_only = pytest.mark.skipif(numba.config.DISABLE_JIT, reason="nothing is compiled here")

AFTER_A_QUESTION = """
import numpy as np, clearance
from clearance.compile import kernel_table
away = np.eye(4)
away[:3, 3] = {shift}
box = clearance.box((1.0, 1.0, 1.0))
print(clearance.distance(box, box, pose_b=away).distance)
print(*np.flatnonzero(kernel_table._table[:, 0]))
"""


def after_a_question(shift):
    """(distance, the places of the table that have an address) in a process of its own."""
    done = subprocess.run(
        [sys.executable, "-c", AFTER_A_QUESTION.format(shift=shift)],
        cwd=ROOT, env={**os.environ, "PYTHONPATH": str(ROOT)}, capture_output=True, text=True, check=True,
    )  # fmt: skip
    distance, places = done.stdout.splitlines()
    return float(distance), {int(place) for place in places.split()}


@compiled_only
def test_what_decides_contact_is_compiled_only_where_it_is_in_question():
    distance, places = after_a_question((3.0, 0.25, 0.5))
    assert distance == 2.0
    assert kernel_table.SEARCH in places
    assert not {kernel_table.MEETING, kernel_table.WINDING_NUMBER} & places
    distance, places = after_a_question((0.5, 0.25, 0.5))
    assert distance == 0.0
    assert {kernel_table.MEETING, kernel_table.COMMON_POINT} <= places


@compiled_only
def test_a_caller_with_other_types_is_refused():
    @kernel
    def with_other_types(x, table):
        return at_address(table, MEETING, 1.0, (x, x))

    assert meeting.meeting is not None
    with pytest.raises(TypeError, match=r"meeting.* is called with other types"):
        call(with_other_types, 1.0)


@compiled_only
def test_what_only_kernels_can_call_is_refused_to_python():
    from clearance.kernels.arithmetic.vec3 import rigid

    with pytest.raises(TypeError, match=r"vec3\.rigid can be called by kernels only"):
        rigid(np.eye(4))
    assert reached(rigid)(np.eye(4)).xx == 1.0
    with pytest.raises(TypeError, match="by kernels only"):
        rigid(np.eye(4))


@inline
def first_of(arrays):
    return arrays[0]


@compiled_only
def test_an_array_is_not_handed_on_to_a_kernel_that_counts_no_references():
    """One form of `first_of` would serve both: where only one counts, an array is freed while it is in use."""

    @numba.njit  # not cached: `first_of` is compiled here, with counts
    def counting(arrays):
        return first_of(arrays)[0]

    @kernel(reference_counts=False)
    def not_counting(arrays):
        return first_of(arrays)[0]

    arrays = (np.ones(2), np.zeros(2))
    assert counting(arrays) == 1.0
    with pytest.raises(Exception, match="first_of returns an array to a kernel without reference counts"):
        not_counting(arrays)

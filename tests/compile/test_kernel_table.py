"""Kernels that are called by address: compiled when they are needed, refused to callers with other types."""

import os
import subprocess
import sys
from pathlib import Path

import numba
import pytest

from clearance.compile import kernel_table
from clearance.compile.jit import kernel
from clearance.compile.kernel_table import MEETING, at_address, call
from clearance.kernels.features import meeting

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


def test_a_kernel_that_is_prepared_tells_the_types_of_no_call(monkeypatch):
    from clearance.compile import ready_kernel

    told = []
    function = ready_kernel.ReadyKernel(lambda *args: args, lambda: None, lambda: None)
    monkeypatch.setattr(ready_kernel, "form_of", lambda args: told.append(args) or "a form")
    function._ready["a form"] = lambda *args: ("ready", *args)
    ready = kernel_table.prepared(function, 1.0)
    assert len(told) == 1
    assert call(ready, 2.0)[:2] == ("ready", 2.0)
    assert len(told) == 1
    plain = kernel_table.prepared(max, 1.0)
    assert plain is max

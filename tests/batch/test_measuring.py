"""Cases of a task come to what each comes to by itself, and a fault of one costs no other."""

from __future__ import annotations

import pytest

from clearance.batch import measuring
from clearance.batch.keys import program
from clearance.batch.measuring import Task, TaskResult, measure
from clearance.errors import Incomplete
from tests.batch.batches import items_of, write_cell

NEAREST = [0.5, 0.02, 0.2, 0.4, 0.01, 0.3, 0.25, 0.6, 0.1]


@pytest.fixture
def items(tmp_path):
    manifest = write_cell(tmp_path, NEAREST)
    (tmp_path / "t004.csv").write_text("time,rail\n0,0\n1,nothing\n")
    return tuple(items_of([str(manifest)]))


def done(items, seconds: float = 1e9) -> TaskResult:
    return measure(Task(tuple(items), seconds, program(), "a batch"))


def test_cases_of_a_task_come_to_what_each_comes_to_by_itself(items):
    alone = [done([item]) for item in items]
    found = done(items)
    assert found.measured == tuple(told for one in alone for told in one.measured)
    assert found.faults == tuple(fault for one in alone for fault in one.faults)
    assert [fault.number for fault in found.faults] == [4] and not found.left


def test_after_its_time_a_task_leaves_what_it_has_not_begun(items):
    found = done(items, seconds=-1.0)
    assert [told.number for told in found.measured] == [0] and found.left == items[1:]


def test_a_fault_of_the_program_in_one_case_is_told_of_that_alone(items, monkeypatch):
    told = measuring.row_of
    monkeypatch.setattr(
        measuring, "row_of", lambda run: 1 / 0 if run.record.case.name == "t002" else told(run)
    )
    found = done(items)
    assert [(fault.number, bool(fault.trace)) for fault in found.faults] == [(2, True), (4, False)]
    assert "ZeroDivisionError" in found.faults[0].trace
    assert len(found.measured) == len(items) - 2


def test_a_process_of_another_program_measures_nothing(items):
    with pytest.raises(Incomplete, match="another version of clearance"):
        measure(Task(items, 1e9, "another", "a batch"))

"""Cases of a task go through the stages together, and come to what each comes to by itself."""

from __future__ import annotations

import pytest

from clearance.batch import measuring
from clearance.batch.keys import program
from clearance.batch.manifest import Changes, items_of
from clearance.batch.measuring import GROUP, Task, TaskResult, measure
from tests.batch.batches import write_cell

NEAREST = [0.5, 0.02, 0.2, 0.4, 0.01, 0.3, 0.25, 0.6, 0.1]


@pytest.fixture
def items(tmp_path):
    manifest = write_cell(tmp_path, NEAREST)
    (tmp_path / "t004.csv").write_text("time,rail\n0,0\n1,nothing\n")
    return tuple(items_of([str(manifest)], Changes()))


def done(items, seconds: float = 1e9) -> TaskResult:
    return measure(Task(tuple(items), seconds, program(), "a batch"))


def rows(found: TaskResult) -> list[dict]:
    return [one.row for one in found.measured]


@pytest.mark.parametrize("together", [1, 2, GROUP])
def test_cases_of_a_task_come_to_what_each_comes_to_by_itself(items, together, monkeypatch):
    monkeypatch.setattr(measuring, "GROUP", together)
    alone = [done([item]) for item in items]
    found = done(items)
    assert rows(found) == [row for one in alone for row in rows(one)]
    assert found.measured == tuple(told for one in alone for told in one.measured)
    assert found.faults == tuple(fault for one in alone for fault in one.faults)
    assert [fault.number for fault in found.faults] == [4] and not found.left


def test_after_its_time_a_task_leaves_what_it_has_read_but_not_begun(items, monkeypatch):
    monkeypatch.setattr(measuring, "_group_size", lambda *_: GROUP)
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


def test_where_reading_takes_long_no_further_case_is_read_ahead(items, monkeypatch):
    monkeypatch.setattr(measuring, "GROUP_SECONDS", -1.0)
    monkeypatch.setattr(measuring, "_group_size", lambda *_: GROUP)
    under_way, most = set(), []
    read, tell = measuring.read_item, measuring.row_of

    def seen_reading(item, batch):
        under_way.add(item.name)
        most.append(len(under_way))
        return read(item, batch)

    def seen_telling(run):
        under_way.discard(run.record.case.name)
        return tell(run)

    monkeypatch.setattr(measuring, "read_item", seen_reading)
    monkeypatch.setattr(measuring, "row_of", seen_telling)
    done(items[:4])
    assert most == [1, 1, 1, 1]


def test_only_short_cases_go_together():
    assert measuring._group_size(0, 0.0) == 1
    assert measuring._group_size(1, 0.005) == measuring._group_size(300, 1.5) == GROUP
    assert measuring._group_size(2, 0.1) == 2
    assert measuring._group_size(1, 60.0) == measuring._group_size(9, 30.0) == 1

"""How a queue is cut into tasks."""

from pathlib import Path

import pytest

from clearance.batch.engine import LEAST, MOST, Queue
from tests.batch.batches import items_of, write_cell


@pytest.fixture
def items(tmp_path: Path):
    return items_of([str(write_cell(tmp_path, [0.5] * 500))])


def cut(queue, n_hands):
    """The numbers of the cases of each task."""
    found = []
    while (task := queue.task(n_hands)) is not None:
        found.append([item.number for item in task.items])
    return found


@pytest.mark.parametrize("n_hands", [1, 4, 16])
def test_each_case_is_in_one_task_and_the_last_are_small(items, n_hands):
    tasks = cut(Queue(items, "batch"), n_hands)
    assert [number for task in tasks for number in task] == [item.number for item in items]
    waiting = len(items)
    for task in tasks:
        assert len(task) == min(waiting, MOST, max(LEAST, -(-waiting // n_hands)))
        waiting -= len(task)


def test_cases_that_are_given_back_alone_are_tasks_of_their_own(items):
    queue = Queue(items[:20], "batch")
    first = queue.task()
    queue.give_back(first.items[:3], alone=True)
    queue.give_back((), alone=True)
    assert cut(queue, 1) == [[0], [1], [2]]

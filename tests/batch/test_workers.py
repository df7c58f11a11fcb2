"""Worker processes: the answer of one process, a worker that dies, and a case that takes workers with it."""

import os

import pytest

from clearance.batch import workers
from clearance.batch.engine import Queue
from clearance.batch.measuring import measure
from clearance.batch.workers import local_workers
from clearance.errors import Incomplete
from tests.batch.batches import items_of, write_cell

pytestmark = [pytest.mark.cold, pytest.mark.slow]

N_CASES, DEATHS = 20, 2


@pytest.fixture
def items(tmp_path, monkeypatch):
    monkeypatch.setattr(workers, "DEATHS", DEATHS)  # fewer are started
    return items_of([str(write_cell(tmp_path, [0.5] * N_CASES))])


def measure_or_die(task):
    """Dies of the case that is called so, at once."""
    if any(item.name == os.environ["DEADLY"] for item in task.items):
        os._exit(9)
    return measure(task)


def work_or_die(pipe):
    workers.measure = measure_or_die
    WORK(pipe)


def die(pipe):
    os._exit(9)


WORK = workers._work


def test_a_case_that_takes_its_workers_with_it_is_at_fault_and_costs_no_other(items, monkeypatch):
    monkeypatch.setenv("DEADLY", "t007")
    monkeypatch.setattr(workers, "_work", work_or_die)
    started = []
    start = workers.Worker.__init__
    monkeypatch.setattr(
        workers.Worker, "__init__", lambda self: (started.append(self), start(self))[1]
    )
    with local_workers(2) as engine:
        found = list(engine.results(Queue(items, "batch")))
    measured = sorted(one.number for done in found for one in done.measured)
    assert measured == [i for i in range(N_CASES) if i != 7]
    (fault,) = (one for done in found for one in done.faults)
    assert (fault.number, fault.text[:24]) == (7, "the worker processes tha")
    assert len(started) == 2 + 1 + DEATHS  # of its first task, then of it alone
    assert not any(one.process.is_alive() for one in started)


def test_workers_that_die_as_they_start_are_told_in_one_line(items, monkeypatch):
    monkeypatch.setattr(workers, "_work", die)
    with local_workers(1) as engine, pytest.raises(Incomplete, match="--jobs 1 needs none"):
        list(engine.results(Queue(items, "batch")))

"""Whatever is killed, at whatever moment: the same command goes on, to the bytes of an undisturbed answer."""

from __future__ import annotations

import os
import sys

import numpy as np
import pytest

from clearance.batch import dask_engine, workers
from clearance.batch.engine import Queue
from clearance.batch.measuring import measure
from clearance.batch.workers import local_workers
from clearance.errors import BadInput, Incomplete
from tests.batch.batches import answer_bytes, items_of, run_here, write_cell
from tests.batch.clusters import (
    ended,
    finished,
    is_gone,
    kill,
    n_kept,
    started,
    until,
    workers_of,
)

pytestmark = [
    pytest.mark.cold,
    pytest.mark.slow,
    pytest.mark.skipif(sys.platform != "linux", reason="looks for processes in /proc"),
]

N_CASES = 80


@pytest.fixture(scope="module")
def undisturbed(tmp_path_factory):
    """Manifest, and the answer of a batch in one process."""
    folder = tmp_path_factory.mktemp("undisturbed")
    nearest = np.random.default_rng(28).uniform(0.01, 0.75, N_CASES)
    manifest = write_cell(folder / "in", nearest)
    (folder / "in" / "t023.csv").write_text("time,rail\n0,0\n1,oops\n")
    run_here(manifest, folder / "out")
    return manifest, answer_bytes(folder / "out")


def arguments(manifest, place):
    return [str(manifest), "--out", str(place)]


def finished_alone(manifest, place):
    """Finishes a batch in one process: workers take three times as long."""
    return finished(*arguments(manifest, place), "--jobs", "1")


def test_after_killed_workers_and_a_killed_command_the_same_one_goes_on(undisturbed, tmp_path):
    """A worker as it starts, one as it measures, and the command, with which its workers end."""
    manifest, expected = undisturbed
    least = 20
    batch = started(*arguments(manifest, tmp_path / "out"), "--jobs", "2")
    kill(until(lambda: workers_of(batch.pid))[0])
    until(lambda: n_kept(tmp_path / "out"))
    kill(until(lambda: workers_of(batch.pid))[0])
    until(lambda: workers_of(batch.pid) and n_kept(tmp_path / "out") >= least)
    workers = workers_of(batch.pid)
    kill(batch.pid)
    ended(batch)
    kept = n_kept(tmp_path / "out")
    assert kept >= least
    until(lambda: all(map(is_gone, workers)))
    code, out, err = finished_alone(manifest, tmp_path / "out")
    assert (code, err) == (1, "")
    assert answer_bytes(tmp_path / "out") == expected
    cached = int(next(line for line in out.splitlines() if "cached" in line).split()[1])
    assert cached == kept


def test_without_its_scheduler_a_batch_is_incomplete_and_goes_on(undisturbed, tmp_path):
    manifest, expected = undisturbed
    host = started("127.0.0.1", str(tmp_path / "address"), module=("tests.batch.scheduler",))
    address = until(lambda: (tmp_path / "address").exists() and (tmp_path / "address").read_text())
    batch = started(*arguments(manifest, tmp_path / "out"), "--scheduler", str(address))
    until(lambda: n_kept(tmp_path / "out"))
    kill(host.pid)
    ended(host)
    out, err = ended(batch)
    if batch.returncode == 1:
        pytest.skip("it was done before")
    assert (batch.returncode, out) == (4, "")
    assert err.startswith("incomplete: the scheduler is gone") and err.count("\n") == 1
    assert finished_alone(manifest, tmp_path / "out")[0] == 1
    assert answer_bytes(tmp_path / "out") == expected


def test_a_scheduler_that_does_not_answer_is_bad_input(monkeypatch):
    pytest.importorskip("distributed")
    monkeypatch.setattr(dask_engine, "CONNECTING", 0.2)
    with pytest.raises(BadInput, match="no scheduler answers"):
        with dask_engine.cluster_at("tcp://127.0.0.1:1"):
            pass


def test_of_two_commands_on_one_store_the_second_waits_and_both_answer(undisturbed, tmp_path):
    manifest, expected = undisturbed
    both = [started(*arguments(manifest, tmp_path / "out"), "--jobs", "1") for _ in range(2)]
    said = [ended(one) for one in both]
    assert [one.returncode for one in both] == [1, 1]
    waits = "store.sqlite: another batch writes here; this one goes on when that has ended"
    assert sorted(waits in err for _, err in said) == [False, True]
    cached = sorted(out[out.index("cached") :].split()[1] for out, _ in said)
    assert cached == ["0", str(N_CASES - 1)]
    assert answer_bytes(tmp_path / "out") == expected


N_MEASURED, DEATHS = 20, 2


@pytest.fixture
def items(tmp_path, monkeypatch):
    monkeypatch.setattr(workers, "DEATHS", DEATHS)  # fewer are started
    return items_of([str(write_cell(tmp_path, [0.5] * N_MEASURED))])


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
    assert measured == [i for i in range(N_MEASURED) if i != 7]
    (fault,) = (one for done in found for one in done.faults)
    assert (fault.number, fault.text[:24]) == (7, "the worker processes tha")
    assert len(started) == 2 + 1 + DEATHS  # of its first task, then of it alone
    assert not any(one.process.is_alive() for one in started)


def test_workers_that_die_as_they_start_are_told_in_one_line(items, monkeypatch):
    monkeypatch.setattr(workers, "_work", die)
    with local_workers(1) as engine, pytest.raises(Incomplete, match="--jobs 1 needs none"):
        list(engine.results(Queue(items, "batch")))

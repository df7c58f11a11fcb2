"""Whatever is killed, at whatever moment: the same command goes on, and its answer has the bytes of an undisturbed
one. With real processes; no test depends on how long anything takes.
"""

from __future__ import annotations

import os
import signal
import subprocess
import sys

import numpy as np
import pytest

from tests.batch.batches import answer_bytes, run_here, write_cell
from tests.batch.clusters import (
    ROOT,
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

N_CASES = 160


@pytest.fixture(scope="module")
def undisturbed(tmp_path_factory):
    """Manifest, and the answer of a batch in one process."""
    folder = tmp_path_factory.mktemp("undisturbed")
    nearest = np.random.default_rng(28).uniform(0.01, 0.75, N_CASES)
    manifest = write_cell(folder / "in", nearest)
    (folder / "in" / "t023.csv").write_text("time,rail\n0,0\n1,oops\n")
    run_here(manifest, folder / "out")
    return manifest, answer_bytes(folder / "out")


def arguments(manifest, place, *more):
    return [str(manifest), "--out", str(place), "--jobs", "2", *more]


def goes_on_alone(manifest, place):
    """Finishes a batch in one process: what is kept is the same, and workers take three times as long."""
    return finished(*arguments(manifest, place)[:-1], "1")[0] == 1


def test_two_workers_write_what_one_process_does(undisturbed, tmp_path):
    manifest, expected = undisturbed
    code, out, err = finished(*arguments(manifest, tmp_path / "out"))
    assert (code, err) == (1, "") and f"{N_CASES} cases" in out and "1 error" in out
    assert answer_bytes(tmp_path / "out") == expected
    code, out, err = finished(*arguments(manifest, tmp_path / "out", "--strict"))
    assert (code, err) == (2, "") and f"cached      {N_CASES - 1} of {N_CASES}" in out


FULL = """
import clearance.batch.store as store
from clearance.cli import main
kept, put = [], store.Store.put
def full(self, *given, **told):
    pages = self._db.execute("PRAGMA page_count").fetchone()[0]
    self._db.execute(f"PRAGMA max_page_count = {pages if kept else 10**6}")
    put(self, *given, **told)
    kept.append(self)
store.Store.put = full
if __name__ == "__main__":
    main()
"""


def test_a_full_disk_ends_a_batch_of_workers_and_keeps_what_was_kept(undisturbed, tmp_path):
    manifest, expected = undisturbed
    (tmp_path / "full_disk.py").write_text(FULL)
    asked = arguments(manifest, tmp_path / "out")
    done = subprocess.run(
        [sys.executable, str(tmp_path / "full_disk.py"), "batch", *asked],
        env=os.environ | {"PYTHONPATH": str(ROOT)}, capture_output=True, text=True,
    )  # fmt: skip
    assert (done.returncode, done.stdout) == (4, "")
    told = done.stderr.splitlines()
    assert told[-1].startswith("incomplete: ") and "database or disk is full" in told[-1]
    assert 0 < n_kept(tmp_path / "out") < N_CASES - 1
    assert set(answer_bytes(tmp_path / "out")) == {"batch.html", "junit.xml"}  # "not finished"
    code, out, err = finished(*asked[:-1], "1")
    assert (code, err) == (1, "") and "cached      0 of" not in out
    assert answer_bytes(tmp_path / "out") == expected


def test_what_a_killed_worker_had_begun_is_done_again(undisturbed, tmp_path):
    manifest, expected = undisturbed
    batch = started(*arguments(manifest, tmp_path / "out"))
    first = until(lambda: workers_of(batch.pid))[0]
    kill(first)  # as it starts
    until(lambda: n_kept(tmp_path / "out") or batch.poll() is not None)
    for worker in workers_of(batch.pid)[:1]:
        kill(worker)  # as it measures
    out, err = ended(batch)
    assert (batch.returncode, err) == (1, ""), out
    assert answer_bytes(tmp_path / "out") == expected


@pytest.mark.parametrize("least", [0, 40])
def test_after_a_killed_command_the_same_one_goes_on(undisturbed, tmp_path, least):
    """Its workers end with it."""
    manifest, expected = undisturbed
    batch = started(*arguments(manifest, tmp_path / "out"))
    until(lambda: workers_of(batch.pid) and n_kept(tmp_path / "out") >= least)
    workers = workers_of(batch.pid)
    kill(batch.pid)
    ended(batch)
    kept = n_kept(tmp_path / "out")
    assert kept >= least
    until(lambda: all(map(is_gone, workers)))
    code, out, err = finished(*arguments(manifest, tmp_path / "out"))
    assert (code, err) == (1, "")
    assert answer_bytes(tmp_path / "out") == expected
    cached = int(next(line for line in out.splitlines() if "cached" in line).split()[1])
    assert cached == kept


def test_an_interrupt_keeps_what_is_done_and_is_one_line(undisturbed, tmp_path):
    manifest, expected = undisturbed
    batch = started(*arguments(manifest, tmp_path / "out"))
    until(lambda: n_kept(tmp_path / "out"))
    os.killpg(batch.pid, signal.SIGINT)  # as a terminal does: all of them
    out, err = ended(batch)
    if batch.returncode == 1:
        pytest.skip("it was done before")
    assert batch.returncode == 130 and out == ""
    assert err.startswith("interrupted: ") and err.count("\n") == 1
    assert goes_on_alone(manifest, tmp_path / "out")
    assert answer_bytes(tmp_path / "out") == expected


def test_without_its_scheduler_a_batch_is_incomplete_and_goes_on(undisturbed, tmp_path):
    manifest, expected = undisturbed
    host = started("127.0.0.1", str(tmp_path / "address"), module=("tests.batch.scheduler",))
    address = until(lambda: (tmp_path / "address").exists() and (tmp_path / "address").read_text())
    asked = [str(manifest), "--out", str(tmp_path / "out"), "--scheduler", str(address)]
    batch = started(*asked)
    until(lambda: n_kept(tmp_path / "out"))
    kill(host.pid)
    ended(host)
    out, err = ended(batch)
    if batch.returncode == 1:
        pytest.skip("it was done before")
    assert (batch.returncode, out) == (4, "")
    assert err.startswith("incomplete: the scheduler is gone") and err.count("\n") == 1
    code, _, err = finished(*asked)
    assert code == 2 and "no scheduler answers" in err and err.count("\n") == 1
    assert goes_on_alone(manifest, tmp_path / "out")
    assert answer_bytes(tmp_path / "out") == expected


def test_of_two_commands_on_one_store_the_second_waits_and_both_answer(undisturbed, tmp_path):
    manifest, expected = undisturbed
    both = [started(*arguments(manifest, tmp_path / "out")[:-1], "1") for _ in range(2)]
    said = [ended(one) for one in both]
    assert [one.returncode for one in both] == [1, 1]
    waits = "store.sqlite: another batch writes here; this one goes on when that has ended"
    assert sorted(waits in err for _, err in said) == [False, True]
    cached = sorted(out[out.index("cached") :].split()[1] for out, _ in said)
    assert cached == ["0", str(N_CASES - 1)]
    assert answer_bytes(tmp_path / "out") == expected


def test_parts_by_other_queues_make_the_same_answer(undisturbed, tmp_path):
    manifest, expected = undisturbed
    for part in ("1/2", "2/2"):
        code, out, _ = finished(*arguments(manifest, tmp_path / "out")[:-1], "1", "--shard", part)
        assert code == 1 and f"(part {part.replace('/', ' of ')})" in out
        assert (tmp_path / "out" / f"part-{part.replace('/', '-of-')}.sqlite").is_file()
        assert set(answer_bytes(tmp_path / "out")) == {"batch.html", "junit.xml"}  # "not finished"
    code, out, _ = finished(*arguments(manifest, tmp_path / "out"))
    assert code == 1 and f"cached      {N_CASES - 1} of {N_CASES}" in out
    assert answer_bytes(tmp_path / "out") == expected

"""What a batch holds of its cases: their number hardly shows, neither as they are measured nor in the answer.

In a process of its own, in which nothing else has been run: what others leave alive puts off collecting garbage.

    PYTHONPATH=. python tests/batch/test_memory.py FOLDER
"""

import gc
import hashlib
import json
import os
import subprocess
import sys
import tracemalloc
from contextlib import nullcontext
from pathlib import Path

import pytest

from clearance.batch.answer import answer_of
from clearance.batch.keys import key_of, program
from clearance.batch.manifest import Changes, items_of
from clearance.batch.measuring import ItemResult, Task, TaskResult, measure
from clearance.batch.outcome import Outcome
from clearance.batch.output import write_answer
from clearance.batch.run import run_batch
from clearance.batch.segments import rows_in, segment_of
from clearance.batch.store import open_store
from clearance.cli.batch_progress import SilentWatch
from tests.batch.batches import write_cell

ROOT = Path(__file__).parents[2]
FEW, MANY = 600, 1800


class SameForAll:
    """Measures the first case, and takes its row for that of each other one."""

    def results(self, queue):
        row = None
        while (task := queue.task()) is not None:
            if row is None:
                done = measure(Task(task.items[:1], 60.0, program(), "batch"))
                (row,) = rows_in(done.segment).to_pylist()
            made = [(item, key_of(item, [(item.name, _digest(item.name))])) for item in task.items]
            told = (row["status"], row["exit_code"], row["clearance"], "")
            yield TaskResult(
                tuple(ItemResult(item.number, key, *told) for item, key in made),
                (),
                segment_of([row | {"key": key} for _, key in made]),
                (),
                (),
            )


def _digest(text):
    return hashlib.sha256(text.encode()).hexdigest()


def name_of(i):
    return f"t{i:06d}.csv"


def run_many(folder, n):
    """A batch of so many cases, with its answer."""
    manifest = write_cell(folder / "in", [0.2])
    for i in range(n):
        (folder / "in" / name_of(i)).write_text("time,rail\n0,0\n1,0.6\n")
    items = items_of([str(manifest)], Changes(certify=False))
    store, outcome = open_store(folder / "out"), Outcome(items)
    run_batch(outcome, store, lambda n: nullcontext(SameForAll()), SilentWatch())
    answer = answer_of(outcome, store)
    write_answer(answer, store)
    assert answer.counts == {"near": len(items)}
    return items, outcome, answer


def traced(folder, n):
    """Bytes that Python holds after so many cases, and the most that it held."""
    gc.collect()
    tracemalloc.start()
    try:
        alive = run_many(folder, n)
        most = tracemalloc.get_traced_memory()[1]
        gc.collect()
        held = tracemalloc.get_traced_memory()[0]
        del alive
        return held, most
    finally:
        tracemalloc.stop()


def growth(folder):
    """Bytes a case, that stay and at the most.

    The names of all files are interned before: `pathlib` does that, and Python's table of them doubles at times.
    """
    interned = [sys.intern(name_of(i)) for i in range(MANY)]
    run_many(folder / "warm", 10)  # compiles, which takes several times as long traced
    few, many = (traced(folder / str(n), n) for n in (FEW, MANY))
    del interned
    return [(m - f) / (MANY - FEW) for f, m in zip(few, many, strict=True)]


@pytest.mark.slow
@pytest.mark.cold
def test_a_case_costs_a_hundred_bytes_or_two(tmp_path):
    ran = subprocess.run(
        [sys.executable, __file__, str(tmp_path)],
        env={**os.environ, "PYTHONPATH": str(ROOT)}, cwd=ROOT, capture_output=True, text=True,
    )  # fmt: skip
    assert ran.returncode == 0, ran.stderr
    held, most = json.loads(ran.stdout)
    assert held < 150
    assert most < 250


if __name__ == "__main__":
    print(json.dumps(growth(Path(sys.argv[1]))))

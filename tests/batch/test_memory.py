"""What a batch holds of its cases: their number hardly shows, neither as they are measured nor in the answer."""

import gc
import hashlib
import tracemalloc
from contextlib import nullcontext

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


def run_many(folder, n):
    """A batch of so many cases, with its answer."""
    manifest = write_cell(folder / "in", [0.2])
    for i in range(n):
        (folder / "in" / f"t{i:06d}.csv").write_text("time,rail\n0,0\n1,0.6\n")
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
    gc.freeze()  # else all that other tests left alive puts off the collection of what goes here
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
        gc.unfreeze()


def growth(folder):
    """Bytes a case, that stay and at the most."""
    few, many = (traced(folder / str(n), n) for n in (FEW, MANY))
    return [(m - f) / (MANY - FEW) for f, m in zip(few, many, strict=True)]


@pytest.mark.slow
def test_a_case_costs_a_hundred_bytes_or_two(tmp_path):
    run_many(tmp_path / "warm", 10)  # compiles, which takes several times as long traced
    held, most = growth(tmp_path)
    if held >= 150 or most >= 400:  # interned names: their table doubles at times, by 2 MB
        held, most = growth(tmp_path / "again")
    assert held < 150
    assert most < 400

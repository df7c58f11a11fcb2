"""What a batch holds of its cases in the process that writes: rows pass through, and the answer is one table."""

import gc
import hashlib
import tracemalloc
from contextlib import nullcontext

import pytest

from clearance.batch.answer import answer_of
from clearance.batch.keys import key_of, program
from clearance.batch.manifest import items_of
from clearance.batch.measuring import Task, TaskResult, measure
from clearance.batch.outcome import Outcome
from clearance.batch.output import write_answer
from clearance.batch.run import run_batch
from clearance.batch.store import open_store
from clearance.cli.batch_run import SilentWatch
from tests.batch.batches import write_cell

FEW, MANY = 200, 1200


class SameForAll:
    """Measures the first case, and takes its row for that of each other one."""

    def results(self, queue):
        first = None
        while (task := queue.task()) is not None:
            first = first or measure(Task(task.items[:1], 60.0, program(), "batch")).measured[0]
            yield TaskResult(tuple(_like(first, item) for item in task.items), (), (), ())


def _like(first, item):
    digest = hashlib.sha256(item.name.encode()).hexdigest()
    return first._replace(number=item.number, key=key_of(item, [(item.name, digest)]))


def most_held(folder, n):
    """Bytes that Python held at the most, in a batch of so many cases with its answer."""
    manifest = write_cell(folder / "in", [0.2])
    for i in range(n):
        (folder / "in" / f"t{i:06d}.csv").write_text("time,rail\n0,0\n1,0.6\n")
    gc.collect()
    tracemalloc.start()
    try:
        items = items_of([str(manifest)], dict(certify=False))
        outcome = Outcome(items)
        with open_store(folder / "out") as store:
            run_batch(outcome, store, lambda n: nullcontext(SameForAll()), SilentWatch())
            answer = answer_of(outcome, store)
            write_answer(answer, store)
        assert answer.counts == {"near": n + 1}
        return tracemalloc.get_traced_memory()[1]
    finally:
        tracemalloc.stop()


@pytest.mark.slow
@pytest.mark.cold
def test_a_case_costs_some_thousand_bytes(tmp_path):
    """So 10,000 cases fit a small machine; most of it is the page, which is made as one text."""
    most_held(tmp_path / "warm", 1)
    few, many = (most_held(tmp_path / str(n), n) for n in (FEW, MANY))
    assert (many - few) / (MANY - FEW) < 6000

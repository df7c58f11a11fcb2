"""Prints how fast a batch is: cases a second, two workers against one, what store and engine cost, memory.

    python scripts/bench/batch.py [--parts rates|workers|many ...] [--cases N] [--many N] [--scene NAME]

`--cases` trajectories of 300 steps in one cell of `scenes/`, for both bases of a verdict; `--many` short ones for
memory, after a tenth of them and after all, and for the second run. Rates are of processor time, after the cell is
read and all is compiled: the median of tasks of 20 cases and the best of them, which says more on a busy machine.
Two workers are held against one by the wall, in turns, the least of each; and by processor time of all their
processes, which says what two idle cores would show.
"""

from __future__ import annotations

import argparse
import os
import shutil
import tempfile
import time
from collections.abc import Iterator, Sequence
from contextlib import contextmanager
from pathlib import Path
from statistics import median

import harness  # first: it sets the number of threads before numpy is loaded
import numpy as np
from harness import ROOT, SCENES, Row, timed

from clearance.batch.answer import answer_of
from clearance.batch.engine import LocalEngine
from clearance.batch.item import Item
from clearance.batch.keys import program
from clearance.batch.manifest import batch_of
from clearance.batch.measuring import Task, measure
from clearance.batch.outcome import Outcome
from clearance.batch.output import write_answer
from clearance.batch.run import BatchWatch, run_batch
from clearance.batch.store import FILE, open_store
from clearance.batch.workers import WorkerEngine, local_workers
from clearance.case.case_file import load_case

CHUNK, TURNS = 20, 3

SMALLEST = ["--parts", "rates", "--cases", "80", "--scene", "box_box"]


def main(words: list[str] | None = None) -> list[Row]:
    """Runs all parts."""
    asked = harness.arguments(
        __doc__, words, parts=[*PARTS], cases=1000, many=10_000, scene="iiwa_pipe_rack"
    )
    with tempfile.TemporaryDirectory() as name:
        found = [row for part in asked.parts for row in PARTS[part](Path(name), asked)]
    rows = [dict(zip(("what", "value", "unit"), row, strict=True)) for row in found]
    load = " ".join(f"{value:.1f}" for value in os.getloadavg())
    harness.show(f"{asked.scene}; {os.cpu_count()} cores, load {load}", rows)
    harness.write_csv(rows, asked.csv, digits=4)
    return rows


def _rates(folder: Path, asked: argparse.Namespace) -> Iterator[tuple]:
    """Cases a second in a cell of the scenes, in this process."""
    manifest = scene_batch(folder / "rates", asked.scene, asked.cases)
    for certify, basis in ((False, "samples"), (True, "motion")):
        times = chunk_times(batch_of([str(manifest)], {"certify": certify}).items)
        yield f"cases a second, 1 core, {basis} (median)", 1.0 / median(times), "1/s"
        yield f"cases a second, 1 core, {basis} (best)", 1.0 / min(times), "1/s"


def _workers(folder: Path, asked: argparse.Namespace) -> Iterator[tuple]:
    """Store and engine, and two workers against one, in the same cell."""
    manifest = scene_batch(folder / "workers", asked.scene, asked.cases)
    items = batch_of([str(manifest)]).items
    yield "store and engine a case", 1000.0 * overhead(folder / "over", items), "ms"
    costs: dict[int, list[tuple[float, float]]] = {1: [], 2: []}
    for k in range(TURNS):
        for jobs, found in costs.items():
            found.append(cost(folder / f"w{jobs}-{k}", items, jobs))
    (one, cpu_one), (two, cpu_two) = (map(min, zip(*costs[n], strict=True)) for n in (1, 2))
    yield "2 workers against 1", one / two, "x"
    yield "the same, if two cores did nothing else", 2.0 * cpu_one / cpu_two, "x"


def _many(folder: Path, asked: argparse.Namespace) -> Iterator[tuple]:
    """Memory over many cases, and the second run of the same manifest."""
    manifest = str(cart_batch(folder / "many", asked.many))
    items = batch_of([manifest]).items
    with local_workers(2) as engine:
        watch = _Resident(engine, len(items))
        _run(folder / "kept", items, engine, watch)
    for name, late in watch.late.items():
        yield f"{name}: resident after {len(items) // 10:,} cases", watch.early[name], "MB"
        yield f"{name}: resident after {len(items):,} cases", late, "MB"
    yield "store a case", (folder / "kept" / FILE).stat().st_size / len(items), "bytes"
    for name in ("second run", "third run"):
        begun = time.process_time()
        outcome = Outcome(batch_of([manifest]).items)
        with open_store(folder / "kept") as store:
            run_batch(outcome, store, _here, BatchWatch())
            known = time.process_time()
            write_answer(answer_of(outcome, store), store)
        ended = time.process_time()
        assert outcome.n_cached == len(items)
        yield f"{name}: cases a second, until all are known", len(items) / (known - begun), "1/s"
        yield f"{name}: cases a second, answer written", len(items) / (ended - begun), "1/s"
    yield (
        f"page of {len(items):,} cases",
        (folder / "kept" / "batch.html").stat().st_size / 1e6,
        "MB",
    )


PARTS = {"rates": _rates, "workers": _workers, "many": _many}


def chunk_times(items: Sequence[Item]) -> list[float]:
    """[s] of processor time a case in each task, the first two left out."""
    times = []
    for start in range(0, len(items), CHUNK):
        own = tuple(items[start : start + CHUNK])
        times.append(
            timed(lambda own=own: measure(Task(own, 1e9, program(), "bench")))[0] / len(own)
        )
    return times[2:]


def overhead(place: Path, items: Sequence[Item]) -> float:
    """[s] a case of processor time in this process where two workers measure: all but measuring."""
    with local_workers(2) as engine:
        _run(place / "warm", items[:64], engine)
        return timed(lambda: _run(place / "all", items, engine))[0] / len(items)


def cost(place: Path, items: Sequence[Item], jobs: int) -> tuple[float, float]:
    """[s] a case by the wall, and of processor time of the command and all workers, after the first cases."""
    with local_workers(jobs) as engine:
        _run(place / "warm", items[: 64 * jobs], engine)
        begun, used = time.perf_counter(), _processor_time(engine)
        _run(place / "all", items, engine)
        wall, spent = time.perf_counter() - begun, _processor_time(engine) - used
        return wall / len(items), spent / len(items)


def _processor_time(engine: WorkerEngine) -> float:
    """[s] of this process and its workers."""
    fields = [
        Path(f"/proc/{n}/stat").read_text().rpartition(")")[2].split() for n in engine.processes
    ]
    ticks = sum(int(each[11]) + int(each[12]) for each in fields)
    return time.process_time() + ticks / os.sysconf("SC_CLK_TCK")


class _Resident(BatchWatch):
    """Notes the memory of this process, which writes, and of its workers, on the way."""

    def __init__(self, engine: WorkerEngine, n_items: int) -> None:
        super().__init__()
        self._engine, self._n, self._done = engine, n_items, 0
        self.early: dict[str, float] = {}
        self.late: dict[str, float] = {}

    def note(self, measured, faults) -> None:
        before, self._done = self._done, self._done + len(measured) + len(faults)
        if before < self._n // 10 <= self._done:
            self.early = self._now()
        if self._done >= self._n - 200:
            self.late = self._now()

    def _now(self) -> dict[str, float]:
        workers = map(_resident, map(str, self._engine.processes))
        return {"parent": _resident("self"), "workers, the greatest": max(workers)}


def _resident(process: str) -> float:
    """[MB] of a process."""
    pages = int(Path(f"/proc/{process}/statm").read_text().split()[1])
    return pages * os.sysconf("SC_PAGE_SIZE") / 1e6


def _run(place: Path, items: Sequence[Item], engine, watch=None) -> None:
    shutil.rmtree(place, ignore_errors=True)

    @contextmanager
    def opened(n_cases: int):
        yield engine

    with open_store(place) as store:
        run_batch(Outcome(items), store, opened, watch or BatchWatch())


@contextmanager
def _here(n_cases: int) -> Iterator[LocalEngine]:
    yield LocalEngine()


MANIFEST = 'cell: cell.yaml\ntrajectories: "t*.csv"\n'

CART = """<robot name="cart"><link name="ground"/>
  <link name="slider"><collision><geometry><box size="0.2 0.2 0.2"/></geometry></collision></link>
  <joint name="rail" type="prismatic"><parent link="ground"/><child link="slider"/>
    <axis xyz="1 0 0"/><limit lower="-5" upper="5" effort="9" velocity="9"/></joint></robot>"""

RAIL = """robot: {urdf: cart.urdf}
scene: {obstacles: [{name: wall, box: {size: [0.2, 1, 1]}, pose: {xyz: [1, 0, 0]}}]}
limits: {fail: 0.05, warn: 0.3}
"""


def scene_batch(folder: Path, scene: str, n_cases: int, n_steps: int = 300) -> Path:
    """A manifest of a scene's cell and its motion, each joint shifted by up to a few hundredths."""
    source = SCENES / scene
    folder.mkdir(parents=True)
    if (source / "meshes").is_dir():
        shutil.copytree(source / "meshes", folder / "meshes")
    text = (source / "case.yaml").read_text().replace("../../robots", str(ROOT / "robots"))
    cell = [line for line in text.splitlines() if not line.startswith("trajectory:")]
    (folder / "cell.yaml").write_text("\n".join(cell) + "\n")
    given = load_case(source / "case.yaml").robots[0].given_trajectory
    times = np.linspace(given.times[0], given.times[-1], n_steps)
    moves = [np.interp(times, given.times, column) for column in given.positions.T]
    header = ",".join(["time", *given.joint_names])
    for k, rng in enumerate(np.random.default_rng(28).spawn(n_cases)):
        shifted = np.column_stack([times, *moves])
        shifted[:, 1:] += 0.01 * rng.standard_normal(len(moves))
        np.savetxt(folder / f"t{k:06d}.csv", shifted, "%.6f", ",", header=header, comments="")
    (folder / "batch.yaml").write_text(MANIFEST)
    return folder / "batch.yaml"


def cart_batch(folder: Path, n_cases: int) -> Path:
    """A manifest of a cart before a wall, and short motions of it."""
    folder.mkdir()
    (folder / "cart.urdf").write_text(CART)
    (folder / "cell.yaml").write_text(RAIL)
    for k, far in enumerate(np.random.default_rng(28).uniform(0.0, 0.79, n_cases)):
        (folder / f"t{k:06d}.csv").write_text(f"time,rail\n0,0\n1,{far:.4f}\n2,0.1\n")
    (folder / "batch.yaml").write_text(MANIFEST)
    return folder / "batch.yaml"


if __name__ == "__main__":
    main()

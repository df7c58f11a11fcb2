"""A long run: its rows come part by part, go on after any interruption, and take the same memory at any length."""

from __future__ import annotations

import errno
import multiprocessing
import os
import tracemalloc
from collections.abc import Callable
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

import clearance as cl
from clearance.errors import Unwritable
from clearance.record.rows import blocks
from clearance.record.rows import resumable as resumable_rows
from clearance.record.rows.resumable import open_resumable_rows
from clearance.report.tables import pair_batches, step_batches, write_csv, write_parquet
from clearance.simulate.measure import resources
from clearance.simulate.replay.replay import replay_of
from clearance.world.case import Case
from tests.examples import first_fast
from tests.made_cases import resampled

ROOT = Path(__file__).parents[3]
ASKED = {
    "steps": {"certify": False},
    "pairs": {"need": "pairs", "certify": False},
    "limit": {"need": "limit", "certify": False},
    "minimum": {"need": "minimum", "certify": False},
    "certified": {"certify": True},
}


class Interrupted(BaseException):
    """Stands for Ctrl-C."""


@pytest.fixture(scope="module")
def case() -> Case:
    """The first 160 of the scene's steps: ten parts."""
    whole = cl.load_case(ROOT / "scenes" / "box_pipe" / "case.yaml")
    placed = whole.robots[0]
    asked = placed.trajectory
    short = replace(asked, times=asked.times[:160], positions=asked.positions[:160])
    return replace(whole, robots=(replace(placed, trajectory=short),))


@pytest.fixture(autouse=True)
def saved_at_once(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(resumable_rows, "SAVE_AFTER", 0.0)
    monkeypatch.setattr(resources, "LONGEST_PART", 16)
    monkeypatch.setattr(resources, "SPARSE", 1)


def answer(
    case: Case, place: Path, said: list[str], *, jobs=None, progress=None, **asked: object
) -> dict[str, object]:
    """All that a run found whose rows were kept in `place`, after that is gone."""
    with open_resumable_rows(place, said.append) as kept:
        run = cl.check(case, **asked, resources=cl.Resources(jobs, progress, kept))
        kept.let_go()
        found = told(run)
    assert not place.exists()
    assert found == told(run)
    return found


def told(run: cl.Run) -> dict[str, object]:
    """Everything in a record that depends on rows, bit for bit."""
    record = run.record
    found = {
        "steps": [run.steps.schema.names, *(column.to_pylist() for column in run.steps.columns)],
        "minima": list(run.pair_minima),
        "pairs": None if run.pairs is None else run.pairs.to_pydict(),
        "tally": record.tally,
    }
    if record.certificate is not None:
        known = record.certificate
        arrays = known.lower_bound, known.upper_bound, known.share, known.pair
        found["bounds"] = (*(array.tobytes() for array in arrays), known.tally)
    return found


def stopping_at(count: int) -> Callable[[int, int], None]:
    """A progress that interrupts at its call of that number."""
    calls = []

    def progress(done: int, total: int) -> None:
        calls.append(done)
        if len(calls) == count:
            raise Interrupted

    return progress


@pytest.mark.slow
@pytest.mark.parametrize("name", first_fast(ASKED, 3))
def test_rows_on_disk_interrupted_and_on_threads_are_the_rows_in_memory(
    case: Case, name: str, tmp_path: Path
) -> None:
    memory = told(cl.check(case, **ASKED[name], resources=cl.Resources(jobs=1)))
    assert memory["tally"]["queries"] + memory["tally"]["pairs_skipped"] >= 160
    said: list[str] = []
    assert answer(case, tmp_path / "kept", said, jobs=2, **ASKED[name]) == memory
    assert said == []
    counts = (1, 2, 3)
    for count in counts:
        with pytest.raises(Interrupted):
            progress = stopping_at(count)
            answer(
                case, tmp_path / "kept", said, jobs=1 + count % 2, progress=progress, **ASKED[name]
            )
    with pytest.raises(Interrupted), open_resumable_rows(tmp_path / "kept", said.append) as kept:
        cl.check(
            case, **ASKED[name], resources=cl.Resources(rows=kept)
        )  # all is measured, and then the report is interrupted
        raise Interrupted
    assert answer(case, tmp_path / "kept", said, jobs=1, **ASKED[name]) == memory
    assert len(said) == 1 + len(counts) and all(line.startswith("resuming: ") for line in said)


def test_a_report_from_disk_has_the_bytes_of_one_from_memory(
    case: Case, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    """In one block of rows or in many, interrupted or not."""
    monkeypatch.setattr(blocks, "BLOCK", 100)
    asked = {"need": "pairs", "certify": True}
    cl.check(case, **asked).save(tmp_path / "memory")
    with pytest.raises(Interrupted), open_resumable_rows(tmp_path / "kept", print) as kept:
        cl.check(case, **asked, resources=cl.Resources(progress=stopping_at(15), rows=kept))
    with open_resumable_rows(tmp_path / "kept", print) as kept:
        cl.check(case, **asked, resources=cl.Resources(rows=kept)).save(tmp_path / "disk")
    names = sorted(path.name for path in (tmp_path / "memory").iterdir())
    assert names == sorted(path.name for path in (tmp_path / "disk").iterdir())
    for name in names:
        assert (tmp_path / "disk" / name).read_bytes() == (tmp_path / "memory" / name).read_bytes()
    assert sorted(path.name for path in tmp_path.iterdir()) == ["disk", "memory"]


def nudged(case: Case, what: str) -> Case:
    """The case with one number changed in its last bit."""
    obstacle, placed = case.obstacles[0], case.robots[0]
    if what == "obstacle":
        pose = obstacle.world_from_body.copy()
        pose[0, 3] += 1e-15
        return replace(
            case, obstacles=(replace(obstacle, world_from_body=pose), *case.obstacles[1:])
        )
    positions = placed.trajectory.positions.copy()
    positions[-1, 0] = np.nextafter(positions[-1, 0], 1.0)
    moved = replace(placed, trajectory=replace(placed.trajectory, positions=positions))
    return replace(case, robots=(moved,))


@pytest.mark.slow
def test_another_question_starts_anew(case: Case, tmp_path: Path) -> None:
    for other, asked in [
        (case, {"limits": cl.Limits(0.001, 0.002)}),
        (case, {"need": "pairs"}),
        (case, {"certify": False}),
        (nudged(case, "obstacle"), {}),
        (nudged(case, "joint"), {}),
    ]:
        with pytest.raises(Interrupted):
            answer(case, tmp_path / "kept", [], progress=stopping_at(5))
        said: list[str] = []
        assert answer(other, tmp_path / "kept", said, **asked) == told(cl.check(other, **asked))
        assert said == ["starting anew: the interrupted run had other inputs"]


def test_a_run_whose_folder_is_gone_can_still_be_asked_and_saved(
    case: Case, tmp_path: Path
) -> None:
    with open_resumable_rows(tmp_path / "kept", print) as kept:
        run = cl.check(case, resources=cl.Resources(rows=kept))
    assert list(run.pair_minima) == list(cl.check(case).pair_minima)
    run.save(tmp_path / "out")
    assert [path.name for path in tmp_path.iterdir()] == ["out"]


def test_a_full_disk_is_told_before_anything_is_mapped(
    case: Case, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    def full(*_: object) -> None:
        raise OSError(errno.ENOSPC, os.strerror(errno.ENOSPC))

    monkeypatch.setattr(os, "posix_fallocate", full)
    with pytest.raises(Unwritable, match="No space left"):
        answer(case, tmp_path / "kept", [])
    assert not (tmp_path / "kept").exists()


@pytest.mark.slow
def test_a_state_whose_rows_are_gone_is_not_believed(case: Case, tmp_path: Path) -> None:
    with pytest.raises(Interrupted):
        answer(case, tmp_path / "kept", [], progress=stopping_at(5))
    (tmp_path / "kept" / "steps.lower_bound.rows").write_bytes(b"torn")
    said: list[str] = []
    assert answer(case, tmp_path / "kept", said) == told(cl.check(case))
    assert said == []


def with_steps(case: Case, n_steps: int) -> Case:
    """The case with its joints moving through the same positions in so many steps."""
    times = case.robots[0].given_trajectory.times
    return resampled(case, np.linspace(times[0], times[-1], n_steps))


def most_memory(case: Case, folder: Path, jobs: int) -> int:
    """[bytes] numpy and Python take at most beside the case, from the sweep to the last file but the page.

    The less of two runs: where the interpreter's table of interned names grows, that takes 2 MB once.
    """
    most = []
    for _ in range(2):
        tracemalloc.start()
        check_and_write(case, folder, jobs)
        most.append(tracemalloc.get_traced_memory()[1])
        tracemalloc.stop()
    return min(most)


def check_and_write(case: Case, folder: Path, jobs: int) -> None:
    """The whole of a run, but the page."""
    with open_resumable_rows(folder / "kept", print) as kept:
        run = cl.check(
            case, need="pairs", certify=True, resources=cl.Resources(jobs=jobs, rows=kept)
        )
        write_parquet(step_batches(run.record, kept), folder / "steps.parquet")
        write_csv(lambda: step_batches(run.record, kept), folder / "steps.csv")
        write_parquet(pair_batches(run.record, kept), folder / "pairs.parquet")
        assert run.summary
        replay_of(run.session, 300, kept)


def most_memory_of_all(folder: Path) -> tuple[int, int, int]:
    """[bytes] of 2000 and of 20,000 steps on one thread, and of 20,000 on two."""
    resources.LONGEST_PART, blocks.BLOCK, resumable_rows.SAVE_AFTER = 128, 1000, 1.0
    case = cl.load_case(ROOT / "scenes" / "box_box" / "case.yaml")
    check_and_write(with_steps(case, 500), folder, 2)  # loads and compiles, slow where traced
    few, many = with_steps(case, 2_000), with_steps(case, 20_000)
    return most_memory(few, folder, 1), most_memory(many, folder, 1), most_memory(many, folder, 2)


@pytest.mark.slow
def test_memory_does_not_grow_with_the_steps(tmp_path: Path) -> None:
    """Ten times the steps: at most the clearances once (8 bytes a step) and a few codes, never rows or poses.

    Two threads take at most twice as much, and so much only where both are at work at once. In a process of its
    own: threads that other tests have left take memory too.
    """
    with multiprocessing.get_context("spawn").Pool(1) as alone:
        short, long, on_two = alone.apply(most_memory_of_all, (tmp_path,))
    assert (long - short) / 18_000 < 20.0, (short, long)
    assert on_two < 2 * long, (long, on_two)

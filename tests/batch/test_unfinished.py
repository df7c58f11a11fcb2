"""A batch that has not come to its end: no older answer stands, and `status` tells missing from unreadable."""

import pytest

from clearance.batch import engine
from clearance.batch.engine import LocalEngine
from clearance.cli import run
from tests.batch.batches import ANSWER, answer_bytes, write_cell, write_path
from tests.report.schemas import valid_suite

GREEN = [0.5, 0.4, 0.6, 0.7]


@pytest.fixture
def folder(tmp_path, monkeypatch):
    write_cell(tmp_path, GREEN)
    monkeypatch.chdir(tmp_path)
    return tmp_path


def batch(*arguments):
    return run(["batch", "batch.yaml", "--out", "store", "--jobs", "1", "--quiet", *arguments])


def is_withdrawn(store):
    suite = valid_suite(store / "junit.xml")
    (error,) = suite.iter("error")
    page = (store / "batch.html").read_text()
    told = "this batch is not finished: of 4 cases some are not measured; the same command goes on"
    assert error.get("message") == told and told in page and "not finished</p>" in page
    return set(answer_bytes(store)) == {"junit.xml", "batch.html"}


class Stopped(LocalEngine):
    """Stops after the first task, as one that is interrupted does."""

    def results(self, queue):
        for done in super().results(queue):
            yield done
            raise KeyboardInterrupt


def test_an_interrupted_batch_leaves_nothing_green(folder, monkeypatch):
    assert batch() == 0
    first = answer_bytes(folder / "store")
    assert set(first) == set(ANSWER)
    monkeypatch.setattr(engine, "MOST", 2)
    monkeypatch.setattr("clearance.cli.batch_run.LocalEngine", Stopped)
    assert batch("--fresh") == 130
    assert is_withdrawn(folder / "store")
    assert run(["batch", "status", "store"]) == 0  # all rows are there; only the answer is not
    write_path(folder / "t001.csv", 0.45)
    assert batch() == 130 and is_withdrawn(folder / "store")
    write_path(folder / "t001.csv", 0.4)
    monkeypatch.undo()
    monkeypatch.chdir(folder)
    assert batch() == 0 and answer_bytes(folder / "store") == first


def test_a_part_of_a_batch_leaves_no_older_answer(folder, capsys):
    assert batch() == 0
    first = answer_bytes(folder / "store")
    assert batch("--shard", "1/2") == 0 and is_withdrawn(folder / "store")
    assert run(["batch", "status", "store"]) == 0
    told = capsys.readouterr().out
    assert "answer      not written yet" in told and "parts       1 file not merged yet" in told
    assert batch() == 0 and answer_bytes(folder / "store") == first


def test_status_tells_missing_from_unreadable(folder, capsys):
    (folder / "t001.csv").write_text("time,rail\n0,x\n")
    assert batch() == 1
    write_path(folder / "t002.csv", 0.3)
    capsys.readouterr()
    assert run(["batch", "status", "store"]) == 4
    told = capsys.readouterr().out
    assert told.startswith(
        "2 of 4 cases done\n  missing     1\n  unreadable  1, when last tried\n  failed      0\n"
    )
    assert "  error       t001: cell.yaml: trajectory.file: t001.csv: line 2: 'x'" in told
    assert batch() == 1 and run(["batch", "status", "store"]) == 1
    write_path(folder / "t001.csv", 0.4)
    capsys.readouterr()
    assert run(["batch", "status", "store"]) == 4
    assert "missing     1\n  unreadable  0\n" in capsys.readouterr().out
    assert batch() == 0 and run(["batch", "status", "store"]) == 0


def test_a_part_keeps_what_another_found_unreadable(folder, capsys):
    for name in ("t000", "t001"):
        (folder / f"{name}.csv").write_text("time,rail\n0,x\n")
    assert batch("--shard", "1/2") == 1 and batch("--shard", "2/2") == 1
    capsys.readouterr()
    assert run(["batch", "status", "store"]) == 4
    told = capsys.readouterr().err
    assert told.startswith("incomplete: store: only parts of a batch are here")
    assert run(["batch", "merge", "store"]) == 0
    assert capsys.readouterr().out == "2 rows of 2 parts are in store\n"
    assert run(["batch", "status", "store"]) == 1
    assert "2 of 4 cases done\n  missing     0\n  unreadable  2" in capsys.readouterr().out
    assert list((folder / "store").glob("part-*")) == []

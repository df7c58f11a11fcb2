"""`clearance batch` in this process: exit codes, what is printed, options, one line for every mistake."""

from __future__ import annotations

import sys

import pytest

from clearance.batch.item import Item
from clearance.batch.measuring import Fault, ItemResult
from clearance.batch.run import BatchWatch
from clearance.cli import run
from tests.batch.batches import write_cell, write_path
from tests.report.schemas import valid_suite


@pytest.fixture
def folder(tmp_path, monkeypatch):
    write_cell(tmp_path, [0.5, 0.2, 0.04])
    monkeypatch.chdir(tmp_path)
    return tmp_path


def batch(*arguments):
    return run(["batch", *arguments, "--jobs", "1"])


def test_the_exit_code_is_that_of_the_worst(folder, capsys):
    assert batch("batch.yaml", "--out", "store") == 1
    told = capsys.readouterr()
    lines = told.out.splitlines()
    assert lines[0] == "VIOLATED  3 cases: 1 violated, 1 near, 1 clear" and told.err == ""
    assert any("  violated    t002: 39.99 mm, below the fail limit of 50 mm" in x for x in lines)
    assert lines[-1] == "  page        store/batch.html"
    assert batch("batch.yaml", "--out", "store", "--fail-mm", "10", "--samples-only") == 0
    samples = capsys.readouterr().out.splitlines()
    assert samples[0].endswith("3 cases: 2 near at the samples only, 1 clear at the samples only")
    assert batch("batch.yaml", "--out", "store", "--quiet") == 1
    assert capsys.readouterr().out == ""
    assert run(["batch", "--help"]) == 0 and "--shard" in capsys.readouterr().out


def test_tolerances_of_a_file_decide_and_status_sees_another(folder, capsys):
    (folder / "batch.yaml").write_text("cell: cell.yaml\ntrajectories: t000.csv\n")
    own = folder / "t.yaml"
    own.write_text("obstacles: {wall: {xyz: 0.001}}\n")
    asked = ("batch.yaml", "--out", "store", "--tolerance", "t.yaml")
    assert batch(*asked) == 0
    assert run(["batch", "status", "store"]) == 0
    own.write_text("obstacles: {wall: {xyz: 0.48}}\n")
    capsys.readouterr()
    assert run(["batch", "status", "store"]) == 4
    assert batch(*asked) == 1
    assert "NOT PROVEN" in capsys.readouterr().out
    own.write_text("obstacles: {wal: {xyz: 0.01}}\n")
    assert batch(*asked, "--strict") == 2
    assert "did you mean 'wall'?" in capsys.readouterr().out


@pytest.mark.slow
def test_no_kind_of_failure_hides_another(folder, capsys):
    """A dozen contacts, and a table that was cut off, and degrees for radians: each is named."""
    for i in range(3, 15):
        write_path(folder / f"t{i:03d}.csv", -0.01)
    (folder / "t015.csv").write_text("time,rail\n0,0\n1,")
    (folder / "t016.csv").write_text("time,rail\n0,0\n1,-90\n")
    assert batch("batch.yaml", "--out", "store") == 2
    lines = capsys.readouterr().out.splitlines()
    failing = [line.split() for line in lines if line.startswith("  ") and ": " in line[14:]]
    listed = [
        words[0] for words in failing if words[0] in ("error", "suspect", "contact", "violated")
    ]
    assert listed == ["error", "suspect", *["contact"] * 7, "violated"]
    assert any("  suspect     t016: suspect " in line for line in lines)
    assert run(["batch", "status", "store"]) == 2
    assert "  error       t015: " in capsys.readouterr().out


def test_a_store_that_cannot_be_written_is_one_line(folder, capsys):
    batch("batch.yaml", "--out", "store", "--quiet")
    (folder / "store" / ".store.lock").unlink()
    (folder / "store" / ".store.lock").mkdir()
    assert batch("batch.yaml", "--out", "store") == 2
    told = capsys.readouterr().err
    assert told.startswith("error: store: cannot write here: ") and told.count("\n") == 1


def test_view_writes_the_page_of_one_case_and_links_it(folder, refusal, capsys):
    batch("batch.yaml", "--out", "store")
    assert run(["view", "store", "t001"]) == 0
    (page,) = (folder / "store" / "cases").glob("t001-*/report.html")
    assert "NEAR" in capsys.readouterr().out
    linked = page.parent.relative_to(folder / "store").as_posix()
    assert linked in (folder / "store" / "batch.html").read_text()
    assert "there is no case 't01'; did you mean" in refusal("view", "store", "t01")


@pytest.mark.parametrize(
    ("arguments", "told"),
    [
        (["batch.yaml"], "Missing option '--out'"),
        (["batch.yaml", "--out", "cell.yaml"], "cell.yaml: is a file"),
        (["batch.yaml", "--out", "."], "is a folder of something else"),
        (["batch.yaml", "--out", "store", "--shard", "3/2"], "'3/2' is no part; i/n with i from 1 to n"),
        (["batch.yaml", "--out", "store", "--scheduler", "x"], "leave it out with --scheduler"),
        (["batch.yaml", "--out", "store", "--waivers", "none.yaml"], "there is no file 'none.yaml'"),
        (["batch.yaml", "--out", "store", "--tolerance", "t.yaml"], "t.yaml: tracking.file: there is no file"),
    ],
)  # fmt: skip
def test_a_mistake_is_one_line(folder, refusal, arguments, told):
    (folder / "t.yaml").write_text("tracking: {file: c.yaml}\n")
    assert told in refusal("batch", *arguments, "--jobs", 1)
    assert "nothing: there is no such folder" in refusal("batch", "status", "nothing")


def test_a_batch_that_is_refused_or_stopped_leaves_no_older_answer(folder, monkeypatch):
    asked = ("batch.yaml", "--out", "store")
    assert batch(*asked, "--fail-mm", "5") == 0
    older = {file: file.read_bytes() for file in (folder / "store").iterdir()}

    def require_told(text: str) -> None:
        (fault,) = valid_suite(folder / "store/junit.xml").iter("error")
        assert text in fault.get("message") and not (folder / "store/cases.parquet").exists()
        for file, content in older.items():
            file.write_bytes(content)

    assert batch(*asked, "--colour") == 2
    require_told("No such option")
    assert batch(*asked, "--scheduler", "tcp://127.0.0.1:1") == 2
    require_told("leave it out with --scheduler")
    assert batch(*asked, "none*.yaml") == 2
    require_told("none*.yaml")

    def stopped(*_: object) -> None:
        raise KeyboardInterrupt

    monkeypatch.setattr("clearance.batch.manifest.batch_of", stopped)
    assert batch(*asked) == 130
    require_told("the same command goes on")
    assert batch(*asked, "--baseline", "store") == 2
    assert older == {file: file.read_bytes() for file in (folder / "store").iterdir()}


def test_a_scheduler_needs_dask(folder, capsys, monkeypatch):
    monkeypatch.setitem(sys.modules, "distributed", None)
    assert run(["batch", "batch.yaml", "--out", "store", "--scheduler", "tcp://host:8786"]) == 2
    err = capsys.readouterr().err
    assert "--scheduler needs distributed" in err and "pip install 'clearance[batch]'" in err


ITEMS = [Item(i, name, f"{name}.yaml", None, None) for i, name in enumerate("abcd")]


def result(number, status, exit_code, clearance, penetration=None):
    told = {"status": status, "measured": status, "exit_code": exit_code, "clearance": clearance}
    return ItemResult(number, "key", "[]", told | {"penetration": penetration, "reasons": []})


def test_a_line_says_how_far_it_is_and_names_the_deepest_contact():
    watch = BatchWatch()
    watch.begin(ITEMS)
    assert watch.line == "0 of 4 cases measured"
    watch.note([result(0, "clear", 0, 0.4)], [])
    assert watch.line.endswith("0 failed, worst clear 400.0 mm, a")
    watch.note([result(1, "contact", 1, 0.0, 0.01), result(2, "contact", 1, 0.0, 0.03)], [])
    watch.note([], [Fault(3, "unreadable")])
    assert watch.line.startswith("4 of 4 cases measured, ")
    assert watch.line.endswith(" 0 s left, 3 failed, worst contact 30.00 mm deep, c")


@pytest.mark.slow
def test_of_many_names_the_nearest_are_told(folder, refusal):
    write_cell(folder, [0.5] * 60)
    batch("batch.yaml", "--out", "store", "--quiet")
    told = refusal("view", "store", "weld")
    assert "there is no case 'weld'; valid are 60 names, the nearest: t" in told and len(told) < 200

"""Two batches held against each other: a fixture that moved, cases that are new, gone, or cannot be read."""

import shutil

import pytest

from clearance.cli import run
from tests.batch.batches import write_cell, write_path


@pytest.fixture
def folder(tmp_path, monkeypatch):
    """A cell with motions to 0.5, 0.2, 0.1 and 0.04 m of a wall, and a batch of it in the store `old`."""
    write_cell(tmp_path, [0.5, 0.2, 0.1, 0.04])
    monkeypatch.chdir(tmp_path)
    assert batch("old") == 1
    return tmp_path


def batch(place, *more):
    return run(["batch", "batch.yaml", "--out", place, "--jobs", "1", "--quiet", *more])


def compared(capsys, *more):
    """The exit code, and the lines that are printed."""
    capsys.readouterr()
    code = run(["compare", "old", "new", *more])
    return code, [line.strip() for line in capsys.readouterr().out.splitlines()]


def edit(path, old, new):
    text = path.read_text()
    assert old in text
    path.write_text(text.replace(old, new))


@pytest.mark.slow
def test_an_obstacle_that_moved_is_told_case_by_case(folder, capsys):
    """6 cm nearer: what keeps its limits is worse and does not alarm."""
    edit(folder / "cell.yaml", "xyz: [1, 0, 0]", "xyz: [0.94, 0, 0]")
    assert batch("new") == 1
    code, lines = compared(capsys)
    assert code == 1
    assert lines[0] == ("since the baseline: NEW, WORSE OR LESS KNOWN in 2 cases; 4 cases: 4 worse")
    told = [line.split(": ", 2)[0].split() + [line.split(": ", 2)[2]] for line in lines[1:]]
    assert [words[:2] for words in told] == [["worse", f"t00{i}"] for i in (2, 3, 0, 1)]
    assert told[0][2] == "near 99.99 mm -> violated 39.99 mm, default limits"
    assert told[1][2] == "violated 39.99 mm -> contact, default limits"
    (folder / "new").rename(folder / "then")
    (folder / "old").rename(folder / "new")
    (folder / "then").rename(folder / "old")
    code, lines = compared(capsys)
    assert (code, lines[0]) == (0, "since the baseline: 4 cases: 4 better")


def test_a_pose_in_place_of_a_motion_is_less(folder, capsys):
    path = folder / "t000.csv"
    path.write_text("".join(path.read_text().splitlines(keepends=True)[:2]))
    assert run(["batch", "batch.yaml", "--out", "new", "--jobs", "1"]) == 1
    assert "at a single pose" in capsys.readouterr().out.splitlines()[0]
    assert "clear at a single pose" in (folder / "new" / "batch.html").read_text()
    code, lines = compared(capsys)
    assert (code, lines[1]) == (
        1, "less is known: a motion was checked, and now only a single pose is (t000)"
    )  # fmt: skip


@pytest.mark.slow
def test_cases_that_one_batch_has(folder, capsys):
    write_path(folder / "t004.csv", 0.4)
    write_path(folder / "t005.csv", -0.1)
    (folder / "t000.csv").unlink()
    (folder / "t001.csv").write_text("time,rail\n0,x\n")
    assert batch("new") == 1
    code, lines = compared(capsys)
    assert code == 1 and "in 3 cases; 6 cases: 2 unchanged" in lines[0]
    assert lines[1].startswith("t001: no answer: cell.yaml: trajectory.file: t001.csv: line 2")
    assert lines[2].startswith("t005: new case: contact")
    assert lines[3] == "t000: gone: the batch has no such case any more"
    assert lines[4] == "t004: new case: clear"
    shutil.rmtree(folder / "old")
    (folder / "new").rename(folder / "old")
    assert batch("new") == 1
    code, lines = compared(capsys)
    assert code == 0 and lines[1].startswith("t001: no answer, as before: ")
    write_path(folder / "t001.csv", 0.4)
    assert batch("new") == 1
    code, lines = compared(capsys)
    assert code == 0 and lines[1] == "t001: answered, and was not before: clear"


WAIVER = "- {{between: [slider, wall], at_least: 0.03, reason: soft, by: N. N., until: {}}}\n"


@pytest.mark.slow
def test_a_waiver_that_is_gone_or_unused_alarms(folder, capsys):
    (folder / "w.yaml").write_text(WAIVER.format("2027-03-31"))
    assert batch("old", "--waivers", "w.yaml", "--today", "2026-11-01") == 0
    assert batch("new") == 1
    code, lines = compared(capsys)
    assert code == 1 and "in 1 case; 4 cases: 1 worse, 3 unchanged" in lines[0]
    assert lines[-1].endswith("(waived before, and is not now)")
    assert batch("new", "--waivers", "w.yaml", "--today", "2027-11-01") == 1
    code, lines = compared(capsys)
    assert code == 1 and "; NEW unused waiver; " in lines[0] and "has expired" in lines[1]


def test_a_mistake_is_one_line(folder, capsys):
    assert batch("new") == 1
    run(["batch", "batch.yaml", "--out", "part", "--shard", "1/2", "--jobs", "1", "--quiet"])
    assert run(["check", "batch.yaml"]) == 2
    capsys.readouterr()
    for typed, code, told in (
        (["old", "part"], 4, "part: this batch has no answer yet"),
        (["old", "."], 2, "one is a store, the other is a run"),
        (["old", "new", "--out", "page"], 2, "--out compares two runs"),
        (["old", "nothing"], 2, "one is a store, the other is a run"),
    ):
        assert run(["compare", *typed]) == code
        err = capsys.readouterr().err
        assert told in err and err.count("\n") == 1


def test_a_batch_tells_what_is_new_since_its_baseline_and_keeps_its_exit_code(folder, capsys):
    edit(folder / "cell.yaml", "xyz: [1, 0, 0]", "xyz: [0.94, 0, 0]")
    capsys.readouterr()
    asked = ["batch", "batch.yaml", "--jobs", "1", "--baseline", "old"]
    assert run([*asked, "--out", "new"]) == 1
    lines = [line.strip() for line in capsys.readouterr().out.splitlines()]
    page = lines.index("page        new/batch.html")
    assert lines[page + 1].startswith("since the baseline: NEW, WORSE OR LESS KNOWN in 2 cases")
    assert compared(capsys) == (1, lines[page + 1 :])
    assert run([*asked, "--out", "new", "--quiet"]) == 1
    assert capsys.readouterr().out == ""


def test_a_baseline_that_cannot_be_one_is_refused_before_anything_is_measured(folder, capsys):
    batch("part", "--shard", "1/2")
    before = sorted(folder.rglob("*"))
    for out, baseline, more, told in (
        ("old", "old", (), "--baseline is the store that --out writes"),
        ("new", "old", ("--shard", "1/2"), "--baseline compares whole batches"),
        ("new", "none", (), "none: not a store"),
        ("new", "part", (), "part: this batch has no answer yet"),
    ):
        capsys.readouterr()
        assert batch(out, "--baseline", baseline, *more) in (2, 4)
        assert told in capsys.readouterr().err and sorted(folder.rglob("*")) == before


def test_less_that_is_known_and_new_suspect_input_alarm(folder, capsys):
    assert batch("new", "--samples-only") == 1
    code, lines = compared(capsys)
    assert code == 1 and lines[0].startswith(
        "since the baseline: NEW, WORSE OR LESS KNOWN in 4 cases"
    )
    known = "less is known: the motion was proven, and now only the samples are measured"
    assert lines[1] == f"{known} (t000 and 3 more)"

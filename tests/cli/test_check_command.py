"""`clearance check`: exit codes, output, files, one line for each class of fault; what a killed run leaves."""

from __future__ import annotations

import json
import os
import signal
import subprocess
import sys
from dataclasses import replace

import pytest

import clearance.crosscheck.compare as compare
from clearance.case.case_file import load_case
from clearance.cli import run
from clearance.errors import MissingFile
from tests.cart import CASE, ROOT, files, write_cart


@pytest.fixture
def folder(tmp_path, monkeypatch):
    write_cart(tmp_path)
    monkeypatch.chdir(tmp_path)
    return tmp_path


def check(capsys, *arguments: str, case: str = "case.yaml") -> tuple[int, str, str]:
    """Exit code, output and errors."""
    capsys.readouterr()
    code = run(["check", case, *arguments])
    return (code, *capsys.readouterr())


def test_near_passes_and_nothing_is_written(folder, capsys):
    before = files(folder)
    code, out, err = check(capsys, "--cross-check")
    assert (code, err) == (0, "") and out.startswith("NEAR  rail: least clearance 100.0 mm")
    assert out.splitlines()[1].strip() == "self-collision not checked [CL531]"
    assert "slider - wall" in out and "agrees at all 3 steps" in out
    assert "certified   at least" in out and "joints moving linearly" in out
    assert files(folder) == before


def test_a_gap_below_rounding_is_a_warning_below_the_headline(folder, capsys):
    code, out, _ = check(capsys, "--certify-mm", "1e-300", "--need", "minimum")
    told = out.splitlines()[2]
    assert code == 0 and "rounding" in told and "warning" in told


@pytest.mark.parametrize("need", ["steps", "pairs", "limit", "minimum"])
def test_every_need_is_certified_and_json_is_all_that_is_printed(folder, capsys, need):
    peer = ("--cross-check",) if need in ("steps", "pairs") else ()
    code, out, err = check(capsys, "--need", need, "--json", "--certify-mm", "0.5", *peer)
    told = json.loads(out)
    assert (code, err, told["basis"], told["worst"]["link"]) == (0, "", "motion", "slider")
    assert told["certified"]["allowed_gap"] == 0.0005 >= told["certified"]["greatest_gap"]
    assert 0.0 < told["certified"]["lower_bound"] <= told["worst"]["clearance"]
    assert not peer or told["cross_check"]["agrees"]


@pytest.mark.peer
@pytest.mark.parametrize("limit", ["50", "150"])
def test_a_peer_that_disagrees_is_exit_3_whatever_the_verdict(folder, capsys, monkeypatch, limit):
    ask = compare.compared

    def asked_about_a_wrong_answer(record, pairs, progress):
        clearances = record.clearances.copy()
        clearances[1] += 1e-6
        wrong = record.rows.with_columns({"clearance": clearances})
        return ask(replace(record, table=wrong), pairs, progress)

    monkeypatch.setattr(compare, "compared", asked_about_a_wrong_answer)
    code, out, err = check(capsys, "--cross-check", "--fail-mm", limit)
    assert (code, err) == (3, "") and "DISAGREES at 1 step" in out


KILLED = """
import os, signal
from clearance import cli
from clearance.record.rows import resumable as resumable_rows
resumable_rows.SAVE_AFTER, note = 0.0, resumable_rows._ResumableLog.note
def killed(log, done, gathered, *, last):
    note(log, done, gathered, last=last)
    os.kill(os.getpid(), signal.SIGKILL)
resumable_rows._ResumableLog.note = killed
cli.main()
"""


@pytest.mark.cold
@pytest.mark.slow
def test_a_killed_run_is_resumed_and_leaves_nothing_behind(folder, capsys):
    """The same command again, one line on stderr, the bytes of a whole run."""
    rows = (f"{i},{0.7 * (i % 1000) / 1000}" for i in range(20_000))
    (folder / "path.csv").write_text("time,rail\n" + "\n".join(rows) + "\n")
    command = [sys.executable, "-c", KILLED, "check", "case.yaml", "--out", "report"]
    environment = os.environ | {"PYTHONPATH": str(ROOT)}
    killed = subprocess.run(command, cwd=folder, env=environment, check=False)
    assert killed.returncode == -signal.SIGKILL
    kept = folder / ".report.unfinished"
    assert list(kept.glob("*.state")) and not (folder / "report").exists()
    code, _, err = check(capsys, "--out", "report")
    assert code == 0 and err.startswith("resuming: ") and err.count("\n") == 1
    assert check(capsys, "--out", "whole")[2] == ""
    assert files(folder / "report") == files(folder / "whole") and not kept.exists()


BAD = {
    # a fault of each layer: file, what is there, what is put there, what is named
    "case": ("case.yaml", "limits:", "limit:", "limits"),
    "scene": ("case.yaml", "box: {size: [0.2, 1, 1]}", "mesh: {file: none.stl}", "none"),
    "pairs": ("case.yaml", "allow: []", "allow: [[slidr, wall]]", "slidr"),
    "trajectory": ("path.csv", "1,0.3", "1,nan", "path.csv"),
    "robot": ("cart.urdf", "<robot", "robot", "cart.urdf"),
}


@pytest.mark.parametrize("fault", BAD)
def test_bad_input_is_one_line_and_exit_2(folder, refusal, fault):
    name, good, bad, named = BAD[fault]
    text = (folder / name).read_text()
    assert good in text
    (folder / name).write_text(text.replace(good, bad, 1))
    (folder / "none.stl").write_text("solid none\nendsolid none\n")
    assert named in refusal("check", "case.yaml", "--out", "report")


@pytest.mark.parametrize(("case", "named"), [("gone.yaml",) * 2, ("caf\udce9.yaml", "not UTF-8")])
def test_a_case_that_is_not_there(folder, refusal, case, named):
    assert named in refusal("check", case, "--out", "report")


@pytest.mark.parametrize(
    ("arguments", "named"),
    [
        (("--fail-mm", "5", "--warn-mm", "2"), "the warn limit 2 mm is below the fail limit 5 mm"),
        (("--unproven-ok",), "--unproven-ok: the case has no tolerances"),
        (("--watch", "--receipt", "--out", "r"), "--watch and --receipt exclude each other"),
        (("--out", "case.yaml/below"), "case.yaml"),
        (("--out", "/proc/report"), "/proc/report"),
        (("--out", "link/deeper"), "leads nowhere"),
        (("--junit", "."), "--junit"),
        (("--out", "n" * 300), "name too long"),
        (("--junit", "n" * 250), "name too long"),  # with what is put around it while it is written
    ],
)
def test_bad_arguments_are_one_line_and_exit_2(folder, refusal, arguments, named):
    (folder / "link").symlink_to("nowhere")
    assert named in refusal("check", "case.yaml", *arguments)


def test_a_folder_names_the_cases_in_it(folder, refusal):
    """The case of that name, or else all; a file without a robot is none."""
    (folder / "other.yaml").write_text(CASE)
    (folder / "scene.yaml").write_text("obstacles: []\n")
    (folder / "empty").mkdir()
    for given, told in ((".", "a case in it: case.yaml ["), ("empty", "no case is in it")):
        assert told in refusal("check", given)
    (folder / "case.yaml").rename(folder / "empty" / "case.yaml")
    assert "a case in it: other.yaml [" in refusal("check", ".")
    (folder / "other.yaml").unlink()
    assert "a case in it: empty/case.yaml [" in refusal("check", ".")
    with pytest.raises(MissingFile, match="a case in it: "):
        load_case(folder / "empty")

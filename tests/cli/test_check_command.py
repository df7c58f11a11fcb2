"""The command line from outside: exit codes, output, files, every bad input."""

from __future__ import annotations

import json
import os
import signal
import subprocess
import sys
from pathlib import Path

import pytest

from clearance.files import LAST
from clearance.report.withdrawn import OLDER_SUMMARY
from tests.cart import URDF

ROOT = Path(__file__).parents[2]

CASE = """name: rail
robot: {urdf: cart.urdf}
scene:
  obstacles:
  - {name: wall, box: {size: [0.2, 1, 1]}, pose: {xyz: [1, 0, 0], quat_xyzw: [0, 0, 0, 1]}}
allow: []
trajectory: {file: path.csv}
limits: {fail: 0.05, warn: 0.3}
"""
PATH = "time,rail\n0,0\n1,0.3\n2,0.7\n"  # 0.8, 0.5 and 0.1 m from the wall


@pytest.fixture
def folder(tmp_path):
    (tmp_path / "cart.urdf").write_text(URDF)
    (tmp_path / "case.yaml").write_text(CASE)
    (tmp_path / "path.csv").write_text(PATH)
    return tmp_path


def clearance(folder: Path, *arguments: str, case: str = "case.yaml"):
    command = [sys.executable, "-m", "clearance", "check", str(folder / case), *arguments]
    environment = os.environ | {"PYTHONPATH": str(ROOT)}
    return subprocess.run(command, cwd=folder, env=environment, capture_output=True, text=True)


def files(folder: Path) -> dict[str, bytes]:
    return {
        str(path.relative_to(folder)): path.read_bytes()
        for path in sorted(folder.rglob("*"))
        if path.is_file()
    }


def test_near_passes_and_nothing_is_written(folder):
    before = files(folder)
    done = clearance(folder, "--cross-check")
    assert (done.returncode, done.stderr) == (0, "")
    assert done.stdout.startswith("NEAR  rail: least clearance 100.0 mm")
    assert done.stdout.splitlines()[1].strip() == "self-collision not checked"
    assert "slider - wall" in done.stdout and "agrees at all 3 steps" in done.stdout
    assert files(folder) == before


def test_limits_from_the_command_line_decide(folder):
    violated = clearance(folder, "--fail-mm", "150")
    assert violated.returncode == 1 and violated.stdout.startswith("VIOLATED")
    clear = clearance(folder, "--fail-mm", "1", "--warn-mm", "2", "--quiet")
    assert (clear.returncode, clear.stdout, clear.stderr) == (0, "", "")


def test_json_is_all_that_is_printed(folder):
    done = clearance(folder, "--json", "--motion", "simulated")
    summary = json.loads(done.stdout)
    assert done.stderr == "" and summary["motion"] == "simulated"
    assert summary["worst"]["link"] == "slider" and summary["n_steps"] > 480


def test_report_and_junit_are_where_they_were_asked_for(folder):
    done = clearance(folder, "--out", "deep/report", "--junit", "junit.xml")
    assert done.returncode == 0, done.stderr
    written = {path.name for path in (folder / "deep/report").iterdir()}
    assert {"steps.csv", "steps.parquet", "summary.json", "report.html"} <= written
    assert (folder / "junit.xml").read_bytes().startswith(b"<?xml")


DISAGREEING = """
from dataclasses import replace
import pyarrow as pa
import clearance.crosscheck as crosscheck
from clearance import cli
ask = crosscheck.cross_check
def asked_about_a_wrong_answer(record, progress=None):
    clearances = record.clearances.copy()
    clearances[1] += 1e-6
    i_column = record.steps.column_names.index("clearance")
    wrong = record.steps.set_column(i_column, "clearance", pa.array(clearances))
    return ask(replace(record, table=wrong), progress)
crosscheck.cross_check = asked_about_a_wrong_answer
cli.main()
"""


@pytest.mark.parametrize("limit", ["50", "150"])
def test_a_peer_that_disagrees_is_exit_3_whatever_the_verdict(folder, limit):
    command = [
        sys.executable,
        "-c",
        DISAGREEING,
        "check",
        "case.yaml",
        "--cross-check",
        "--fail-mm",
        limit,
    ]
    environment = os.environ | {"PYTHONPATH": str(ROOT)}
    done = subprocess.run(command, cwd=folder, env=environment, capture_output=True, text=True)
    assert (done.returncode, done.stderr) == (3, "")
    assert "DISAGREES at 1 step" in done.stdout


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


def test_a_killed_run_is_resumed_and_leaves_nothing_behind(folder):
    """The command line's own: the same command again, one line on stderr, the bytes of a whole run."""
    rows = (f"{i},{0.7 * (i % 1000) / 1000}" for i in range(20_000))
    (folder / "path.csv").write_text("time,rail\n" + "\n".join(rows) + "\n")
    command = [sys.executable, "-c", KILLED, "check", str(folder / "case.yaml"), "--out", "report"]
    killed = subprocess.run(
        command, cwd=folder, env=os.environ | {"PYTHONPATH": str(ROOT)}, check=False
    )
    assert killed.returncode == -signal.SIGKILL
    kept = folder / ".report.unfinished"
    assert list(kept.glob("*.state")) and not (folder / "report").exists()
    resumed = clearance(folder, "--out", "report")
    assert resumed.returncode == 0, resumed.stderr
    assert resumed.stderr.startswith("resuming: ") and resumed.stderr.count("\n") == 1
    whole = clearance(folder, "--out", "whole")
    assert whole.stderr == "" and files(folder / "report") == files(folder / "whole")
    assert not kept.exists()


BAD = {
    "unknown joint": ("path.csv", "time,rail", "time,rale", "rale"),
    "unknown link in allow": ("case.yaml", "allow: []", "allow: [[slidr, wall]]", "slidr"),
    "NaN in the trajectory": ("path.csv", "1,0.3", "1,nan", "path.csv"),
    "too few columns": ("path.csv", "1,0.3", "1", "path.csv"),
    "unknown key": ("case.yaml", "limits:", "limit:", "limits"),
    "mesh without faces": (
        "case.yaml", "box: {size: [0.2, 1, 1]}", "mesh: {file: none.stl}", "none",
    ),
    "negative radius": (
        "case.yaml", "box: {size: [0.2, 1, 1]}", "sphere: {radius: -1}", "radius",
    ),
    "bad quaternion": ("case.yaml", "[0, 0, 0, 1]", "[0, 0, 0, 2]", "quat_xyzw"),
    "time not increasing": ("path.csv", "2,0.7", "1,0.7", "time"),
    "URDF that is not XML": ("cart.urdf", "<robot", "robot", "cart.urdf"),
    "missing trajectory": ("case.yaml", "path.csv", "gone.csv", "gone.csv"),
}  # fmt: skip


@pytest.mark.parametrize("fault", BAD)
def test_bad_input_is_one_line_and_exit_2(folder, fault):
    name, good, bad, named = BAD[fault]
    text = (folder / name).read_text()
    assert good in text
    (folder / name).write_text(text.replace(good, bad, 1))
    (folder / "none.stl").write_text("solid none\nendsolid none\n")
    assert_refused(folder, clearance(folder, "--out", "report"), named)


def test_two_obstacles_with_one_name(folder):
    text = (folder / "case.yaml").read_text()
    row = next(line for line in text.splitlines() if "wall" in line)
    (folder / "case.yaml").write_text(text.replace(row, f"{row}\n{row}"))
    assert_refused(folder, clearance(folder, "--out", "report"), "wall")


def test_a_case_that_is_not_there(folder):
    assert_refused(folder, clearance(folder, "--out", "report", case="gone.yaml"), "gone.yaml")


@pytest.mark.parametrize(
    ("arguments", "named"),
    [
        (("--fail-mm", "-1"), "-1"),
        (("--warn-mm", "nan"), "nan"),
        (("--fail-mm", "5", "--warn-mm", "2"), "below"),
        (("--method", "fast"), "fast"),
        (("--colour",), "--colour"),
        (("--accept", "unit"), "unit"),
        (("--out", "case.yaml"), "case.yaml"),
        (("--out", "case.yaml/below"), "case.yaml"),
        (("--out", "/proc/report"), "/proc/report"),
        (("--junit", "."), "--junit"),
    ],
)
def test_bad_arguments_are_one_line_and_exit_2(folder, arguments, named):
    assert_refused(folder, clearance(folder, *arguments), named)


def assert_refused(folder: Path, done: subprocess.CompletedProcess, named: str) -> None:
    assert done.returncode == 2, done.stdout + done.stderr
    assert done.stdout == "" and done.stderr.startswith("error: ")
    assert done.stderr.count("\n") == 1 and named in done.stderr
    assert not (folder / "report").exists()


@pytest.mark.skipif(not Path("/dev/full").exists(), reason="no full device to write to")
def test_a_full_disk_under_stdout_is_no_verdict(folder):
    command = [sys.executable, "-m", "clearance", "check", str(folder / "case.yaml"), "--json"]
    with open("/dev/full", "w") as full:
        done = subprocess.run(
            command, cwd=ROOT, stdout=full, stderr=subprocess.PIPE, text=True, check=False
        )
    assert done.returncode not in (0, 1)


INTERRUPTED = """
import os, signal
signal.signal(signal.SIGINT, signal.default_int_handler)
import clearance.crosscheck.compare as compare
from clearance import cli
def interrupted(run, progress=None):
    os.kill(os.getpid(), signal.SIGINT)
compare.PeerRun.measure = interrupted
cli.main()
"""


def test_an_interrupted_run_leaves_the_older_report_marked_as_such(folder):
    assert clearance(folder, "--out", "report").returncode == 0
    before = files(folder / "report")
    (folder / "path.csv").write_text(PATH.replace("0.7", "0.6"))
    command = [
        sys.executable,
        "-c",
        INTERRUPTED,
        "check",
        "case.yaml",
        "--cross-check",
        "--out",
        "report",
    ]
    done = subprocess.run(
        command,
        cwd=folder,
        env=os.environ | {"PYTHONPATH": str(ROOT)},
        capture_output=True,
        text=True,
    )
    assert (done.returncode, done.stdout, done.stderr) == (130, "", "interrupted\n")
    left = files(folder / "report")
    assert left.pop(OLDER_SUMMARY) == before.pop(LAST)
    assert "what follows is older" in left.pop("report.html").decode()
    before.pop("report.html")
    assert left == before
    assert not list(folder.glob("**/*.partial"))

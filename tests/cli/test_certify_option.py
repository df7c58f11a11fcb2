"""`clearance check --certify` from the outside: what is printed and what the exit code says."""

import json
import subprocess
import sys
from pathlib import Path

SCENE = Path(__file__).parents[2] / "scenes" / "box_box" / "case.yaml"


def clearance(*arguments):
    command = [sys.executable, "-m", "clearance", "check", str(SCENE), *arguments]
    return subprocess.run(command, capture_output=True, text=True)


def test_the_bound_is_in_the_summary_and_below_the_steps():
    done = clearance("--certify-mm", "0.5", "--json")
    summary = json.loads(done.stdout)
    assert done.returncode == 0
    assert summary["certified"]["allowed_gap"] == 0.0005
    assert summary["certified"]["greatest_gap"] <= 0.0005
    assert summary["certified"]["lower_bound"] <= summary["worst"]["clearance"]


def test_a_person_reads_what_is_proven():
    done = clearance("--certify")
    assert "certified   at least 34." in done.stdout
    assert "joints moving linearly" in done.stdout


def test_a_limit_that_cannot_be_proven_is_violated():
    steps = json.loads(clearance("--json").stdout)["worst"]["clearance"]
    limit = ["--fail-mm", f"{steps * 1000.0 - 1e-6:.9f}"]
    assert clearance(*limit).returncode == 0
    assert clearance(*limit, "--certify").returncode == 1


def test_a_gap_of_zero_is_refused_in_one_line():
    done = clearance("--certify-mm", "0")
    assert done.returncode == 2
    assert done.stderr.count("\n") == 1
    assert "above 0" in done.stderr


def test_each_pass_has_its_own_bar(monkeypatch):
    from rich import progress as rich_progress

    from clearance.cli.progress import shown_progress

    told = []
    monkeypatch.setattr(sys.stderr, "isatty", lambda: True, raising=False)
    monkeypatch.setattr(
        rich_progress.Progress,
        "update",
        lambda bars, task, **values: told.append((task, values["completed"])),
    )
    with shown_progress(False, ["measuring", "certifying", "cross-checking"]) as progress:
        for done in (5, 10, 5, 10, 1, 10):
            progress(done, 10)
    assert told == [(0, 5), (0, 10), (1, 5), (1, 10), (2, 1), (2, 10)]


def test_an_out_that_is_a_dangling_link_is_refused_before_the_work(tmp_path):
    (tmp_path / "link").symlink_to(tmp_path / "nowhere")
    (tmp_path / "loop").symlink_to(tmp_path / "loop")
    for place in ("link", "loop", "link/deeper"):
        done = clearance("--out", str(tmp_path / place))
        assert done.returncode == 2
        assert "leads nowhere" in done.stderr
        assert done.stdout == ""

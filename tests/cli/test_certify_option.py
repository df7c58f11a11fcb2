"""What `clearance check` proves of the motion, from the outside: what is printed and what the exit code says."""

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
    done = clearance()
    assert "certified   at least 34." in done.stdout
    assert "joints moving linearly" in done.stdout


def test_a_limit_that_cannot_be_proven_is_violated():
    steps = json.loads(clearance("--json").stdout)["worst_sample"]["clearance"]
    limit = ["--fail-mm", f"{steps * 1000.0 - 1e-6:.9f}"]
    assert clearance(*limit, "--samples-only").returncode == 0
    assert clearance(*limit).returncode == 1
    assert clearance(*limit, "--certify").returncode == 1


def test_the_samples_alone_are_looked_at_where_that_is_asked_for_and_it_is_said():
    done = clearance("--samples-only")
    assert done.stdout.startswith("CLEAR at the samples only  box_box")
    assert "certified   no" in done.stdout
    summary = json.loads(clearance("--samples-only", "--json").stdout)
    assert (summary["certified"], summary["basis"]) == (None, "samples")
    assert summary["verdict_text"] == "clear at the samples only"
    paper = json.loads(clearance("--method", "paper", "--json").stdout)
    assert (paper["certified"], paper["verdict_text"]) == (None, "clear at the samples only")


def test_a_proof_and_the_samples_only_cannot_be_asked_for_together():
    done = clearance("--samples-only", "--certify-mm", "1")
    assert (done.returncode, done.stdout, done.stderr.count("\n")) == (2, "", 1)
    assert "--samples-only" in done.stderr


def test_a_gap_below_rounding_ends_with_a_warning_below_the_headline():
    done = clearance("--certify-mm", "1e-300", "--need", "minimum")
    assert done.returncode == 0
    assert "rounding" in done.stdout.splitlines()[2] and "warning" in done.stdout.splitlines()[2]


def test_every_need_is_certified_with_a_cross_check_where_that_goes():
    for need in ("steps", "pairs"):
        summary = json.loads(clearance("--need", need, "--cross-check", "--json").stdout)
        assert summary["basis"] == "motion" and summary["cross_check"]["agrees"]
    for need in ("limit", "minimum"):
        summary = json.loads(clearance("--need", need, "--json").stdout)
        assert summary["basis"] == "motion" and summary["certified"]["lower_bound"] > 0.0


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

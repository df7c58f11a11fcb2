"""The benchmarks run on a tiny setting, and what they say agrees with itself; absent peers are left out."""

from __future__ import annotations

import csv
import subprocess
import sys
from pathlib import Path

import pytest

ROOT = Path(__file__).parents[2]


def ran(script: str, *arguments: object) -> str:
    command = [sys.executable, ROOT / "scripts" / "bench" / script, *map(str, arguments)]
    done = subprocess.run(command, cwd=ROOT, capture_output=True, text=True, timeout=300)
    assert done.returncode == 0, done.stdout + done.stderr
    return done.stdout


def rows_of(path: Path) -> list[dict]:
    with path.open(encoding="utf-8") as lines:
        return list(csv.DictReader(lines))


def test_trajectory_agrees_with_every_peer(tmp_path):
    out = tmp_path / "rows.csv"
    said = ran(
        "trajectory.py", "--scenes", "box_box", "--seconds", 0.02, "--passes", 1, "--csv", out
    )
    rows = rows_of(out)
    assert rows[0]["method"] == "clearance: steps" and float(rows[0]["ratio_to_ours"]) == 1.0
    assert all(float(row["ms_per_step"]) > 0.0 for row in rows)
    assert {row["library"] for row in rows} >= {"clearance", "FCL"}
    assert max(float(row["greatest_difference_m"]) for row in rows) < 1e-12
    assert not any(row["false_contact_steps"] + row["missed_contact_steps"] for row in rows)
    assert "python-fcl" in said


@pytest.fixture(scope="module")
def error_time(tmp_path_factory) -> tuple[str, Path]:
    """What one run of it says, and where it wrote."""
    folder = tmp_path_factory.mktemp("error_time")
    least = ("--polygons", 2, "--poses", 1, "--steps", 0, "--seconds", 0.02)
    return ran("error_time.py", *least, "--out", folder), folder


def test_error_time_finds_ours_exact_and_balls_wrong(error_time):
    said, folder = error_time
    rows = rows_of(folder / "error_time.csv")
    ours = [row for row in rows if row["method"] == "clearance exact"]
    assert {row["group"] for row in ours} == {"polygons", "bodies"}
    assert len({row["family"] for row in ours if row["group"] == "polygons"}) >= 15
    assert all(float(row["error_worst"]) < 1e-9 for row in ours)
    assert all(row["no_answer"] == "0" for row in ours)
    balls = [row for row in rows if row["method"] == "bounding spheres"]
    assert max(float(row["error_worst"]) for row in balls) > 1e-2
    assert "run time against error" in said


def test_polytopes_measures_ours_and_the_peers(tmp_path):
    out = tmp_path / "rows.csv"
    said = ran("polytopes.py", "--largest", 50, "--seconds", 0.01, "--csv", out)
    rows = rows_of(out)
    assert all(0.0 < float(row["least_ms"]) <= float(row["median_ms"]) for row in rows)
    assert {(row["m"], row["n"]) for row in rows} == {("2", "50"), ("64", "50")}
    assert {"intersect", "common_point", "intersect, 2 threads", "common_point, warm, a pose"} <= {
        row["what"] for row in rows
    }
    assert "LP + Qhull" in said


def test_pictures_are_drawn(error_time):
    pytest.importorskip("matplotlib")
    _, folder = error_time
    for name in ("error_time.svg", "polygon_families.svg"):
        assert (folder / name).read_text(encoding="utf-8").startswith("<?xml")


def test_contact_tells_what_the_deepest_moments_cost(tmp_path):
    out = tmp_path / "rows.csv"
    ran("contact.py", "--cases", "--large", 2000, "--no-peers", "--csv", out)
    (row,) = rows_of(out)
    assert row["case"] == "torus_2000" and int(row["events"]) == 1
    assert 0 < int(row["steps_in_contact"]) == int(row["rows"])
    assert 0.0 < float(row["deepest_at_least_mm"]) <= float(row["deepest_mm"]) < 500.0


@pytest.mark.skipif(not (ROOT / ".git").exists(), reason="not a checkout of git")
def test_the_fence_finds_the_last_commit_the_same():
    verdicts = ("--verdicts", "waiver stale", "unknown key")
    said = ran("fence.py", "HEAD", "--cases", "box_box", "--cells", 1, "--passes", 1, *verdicts)
    lines = said.splitlines()
    assert [line.split()[0] for line in lines] == [
        "box_box",
        "cell",
        "waiver",
        "unknown",
        "start",
        "0",
    ]
    assert lines[2].endswith("exit code 1  same") and lines[3].endswith("exit code 2  same")
    assert said.endswith("0 differ\n")

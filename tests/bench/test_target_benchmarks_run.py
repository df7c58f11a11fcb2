"""The benchmarks of the targets run on a tiny setting, and their answers agree with the peers'."""

from __future__ import annotations

import csv
import subprocess
import sys
from pathlib import Path

import pytest

ROOT = Path(__file__).parents[2]


def rows_of(script: str, out: Path, *arguments: object) -> list[dict]:
    command = [sys.executable, ROOT / "scripts" / "bench" / script, "--csv", out, *arguments]
    done = subprocess.run(
        list(map(str, command)), cwd=ROOT, capture_output=True, text=True, timeout=300
    )
    assert done.returncode == 0, done.stdout + done.stderr
    with out.open(encoding="utf-8") as lines:
        return list(csv.DictReader(lines))


def test_worst_cases_agree_with_every_peer(tmp_path):
    given = ("--cases", "everything_equidistant", "--seconds", 0.02, "--passes", 1)
    rows = rows_of("worst_cases.py", tmp_path / "rows.csv", *given)
    assert {row["library"] for row in rows} >= {"clearance", "FCL"}
    assert max(float(row["greatest_difference_m"]) for row in rows) < 1e-12


def test_single_pairs_agree_with_every_peer(tmp_path):
    given = (
        "--pairs",
        "spheres 320",
        "linked tori 1k",
        "--poses",
        4,
        "--seconds",
        0.01,
        "--passes",
        1,
    )
    rows = rows_of("single_pairs.py", tmp_path / "rows.csv", *given)
    assert {"clearance: distance", "clearance: Query.distances"} <= {row["method"] for row in rows}
    assert max(float(row["greatest_difference_m"]) for row in rows) < 1e-12


def test_needs_are_held_against_steps(tmp_path):
    rows = rows_of("needs.py", tmp_path / "rows.csv", "--scenes", "box_box", "--passes", 1)
    ratios = {row["what"]: float(row["ratio_to_steps"]) for row in rows}
    assert ratios["steps"] == 1.0
    assert {"pairs", "limit", "minimum", "certificate to 0.1 mm", "steps, 2 threads"} <= set(ratios)


def test_growth_counts_more_work_for_more_triangles(tmp_path):
    pytest.importorskip("matplotlib")
    picture = tmp_path / "growth.svg"
    given = (
        "--fineness",
        4,
        8,
        "--steps",
        20,
        40,
        "--seconds",
        0.01,
        "--passes",
        1,
        "--picture",
        picture,
    )
    rows = rows_of("growth.py", tmp_path / "rows.csv", *given)
    few, many = (row for row in rows if row["what"] == "triangles")
    assert int(many["triangles"]) == 4 * int(few["triangles"])
    assert few["counters"] != many["counters"]
    assert picture.read_text(encoding="utf-8").startswith("<?xml")


def test_first_run_times_the_command(tmp_path):
    case = ROOT / "scenes" / "box_box" / "case.yaml"
    rows = rows_of(
        "first_run.py", tmp_path / "rows.csv", "--cases", case, "--fresh", 0, "--warm", 1
    )
    assert [row["run"] for row in rows] == ["first of the case", "warm", "warm, --out", "refused"]
    assert all(float(row["seconds"]) > 0.0 for row in rows)


def test_where_everything_moves_the_peers_agree(tmp_path):
    pytest.importorskip("pinocchio", reason="pin is not installed (pip install .[bench])")
    given = ("--rows", "two arms", "certificate of two arms", "--seconds", 0.1, "--passes", 1)
    rows = rows_of("actors.py", tmp_path / "rows.csv", *given)
    if not rows:
        pytest.skip("example-robot-data is not installed (pip install .[bench])")
    measured = [row for row in rows if row["what"] == "steps"]
    assert {"clearance: steps", "Pinocchio + Coal: computeDistances"} <= {
        row["method"] for row in measured
    }
    assert max(float(row["greatest_difference_m"]) for row in measured) < 1e-12
    assert {row["method"] for row in rows} >= {"certificate to 0.1 mm"}

"""Each benchmark starts and gives its figures on its smallest size; where peers are there, they agree with us."""

from __future__ import annotations

import csv
import subprocess
import sys
from pathlib import Path

import pytest

pytestmark = pytest.mark.cold

BENCH = Path(__file__).parents[2] / "scripts" / "bench"
NAMES = sorted(path.stem for path in BENCH.glob("*.py") if "\nSMALLEST = " in path.read_text())
LONG = {"first_run"}
"""It times whole commands, which other tests run."""

PROGRAMS = ("enclosure", "peers", "zones", "table")

Rows = list[dict[str, str]]


@pytest.fixture(scope="module")
def rows(tmp_path_factory) -> dict[str, Rows]:
    """The rows of each benchmark, all from one process."""
    out = tmp_path_factory.mktemp("rows")
    asked = [name for name in NAMES if name not in LONG]
    command = [sys.executable, BENCH / "harness.py", "--out", out, "--only", *asked]
    done = subprocess.run(command, capture_output=True, text=True, timeout=600)
    assert done.returncode == 0, done.stdout[-2000:] + done.stderr
    return {path.stem: list(csv.DictReader(path.open(encoding="utf-8"))) for path in out.iterdir()}


def test_each_gives_its_figures(rows):
    assert len(NAMES) >= 15 and set(rows) == set(NAMES) - LONG
    assert all(rows.values())


@pytest.mark.parametrize("name", ["trajectory", "single_pairs"])
def test_peers_agree_to_rounding(rows, name):
    assert {row["library"] for row in rows[name]} >= {"clearance", "FCL"}
    assert max(float(row["greatest_difference_m"]) for row in rows[name]) < 1e-12


def test_ours_is_exact_and_balls_are_wrong(rows):
    ours = [row for row in rows["error_time"] if row["method"] == "clearance exact"]
    assert {row["group"] for row in ours} == {"polygons", "bodies"}
    assert all(float(row["error_worst"]) < 1e-9 and row["no_answer"] == "0" for row in ours)
    balls = [row for row in rows["error_time"] if row["method"] == "bounding spheres"]
    assert max(float(row["error_worst"]) for row in balls) > 1e-2


def test_gains_are_kept_when_they_are_certified_anew(rows):
    assert [row["kind"] for row in rows["gain"]] == ["waypoints", "obstacle"]
    assert all(row["kept"] == row["checked"] == "True" for row in rows["gain"])
    assert all(float(r["lower_bound"]) <= float(r["size"]) for r in rows["gain"])


def test_nothing_that_is_sampled_is_below_what_is_proven(rows):
    assert all(float(row["worst_mm"]) >= float(row["proven_mm"]) for row in rows["budget"])
    assert all(float(row["grid_mm"]) >= float(row["proven_mm"]) for row in rows["unsynchronised"])


def test_needs_are_held_against_steps(rows):
    ratios = {row["what"]: float(row["ratio_to_steps"]) for row in rows["needs"]}
    assert ratios["steps"] == 1.0
    assert {"pairs", "limit", "minimum", "certificate to 0.1 mm", "steps, 2 threads"} <= set(ratios)


def test_programs_keep_what_they_promise(rows):
    of = {part: [row for row in rows["programs"] if row["part"] == part] for part in PROGRAMS}
    assert all(row["outside"] == "0" and float(row["ratio_max"]) < 3.0 for row in of["enclosure"])
    assert {row["library"] for row in of["peers"]} >= {"yourdfpy"}
    assert max(float(row[key]) for row in of["peers"] for key in ("way_m", "turn_rad")) < 1e-9
    assert all(row["nearer"] == "0" for row in of["zones"])
    proven, worst = ([float(row[key]) for row in of["table"]] for key in ("proven_mm", "worst_mm"))
    assert max(proven) <= min(worst) < max(proven) + 0.2

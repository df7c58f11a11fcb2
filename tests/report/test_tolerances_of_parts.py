"""What a report says of parts under tolerances: errors of which moment, and which grasps are taken as exact."""

from __future__ import annotations

import json

import pyarrow.csv
import pytest

import clearance as cl
from clearance.report.topics.tolerances import source_lines
from tests.budget.part_cases import passing


@pytest.fixture(scope="module")
def run():
    return cl.check(passing(0.2), certify=False)


def test_sources_are_named_by_robot_joint_and_moment(run):
    (one,) = run.record.budget
    worst = one, run.session.error_sources(one)
    told = " ".join(source_lines(run.record, *worst))
    assert "tracking of joint left/j at the grasp (0 s)" in told
    assert "tracking of joint left/j at the release (1 s)" in told


def test_tables_tell_the_moment(run, tmp_path):
    run.save(tmp_path)
    rows = pyarrow.csv.read_csv(tmp_path / "budget.csv").to_pylist()
    worst = rows[0]["time"]
    assert {row["moment"] for row in rows if row["time"] == worst} == {
        "grasp (0 s)",
        "release (1 s)",
    }
    summary = json.loads((tmp_path / "summary.json").read_text(encoding="utf-8"))
    (carry,) = summary["carries"]
    assert carry["grasp"] == "as driven"
    sources = summary["tolerances"]["rules"][0]["worst"][0]["sources"]
    assert {source["moment"] for source in sources} == {"grasp (0 s)", "release (1 s)"}


def test_an_exact_grasp_is_said(run, tmp_path):
    exact = cl.check(passing(0.2, exact_grasp=True), certify=False)
    said = "Grasps taken as exact: part by left/bar."
    assert said in exact.verdict.with_tolerances and said not in run.verdict.with_tolerances
    exact.save(tmp_path)
    summary = json.loads((tmp_path / "summary.json").read_text(encoding="utf-8"))
    assert summary["carries"][0]["grasp"] == "exact"
    assert said in summary["tolerances"]["lines"]
    assert said in (tmp_path / "report.html").read_text(encoding="utf-8")

"""What a run says of itself in Python: a short line, a notebook's few lines, events, summary, certificate."""

import json
from pathlib import Path

import numpy as np
import pytest

import clearance as cl
from clearance.errors import BadInput, MissingFile
from tests.made_cases import at
from tests.report.cells import sliding

CASE = "scenes/box_box/case.yaml"


@pytest.fixture(scope="module")
def run():
    return cl.check(CASE, limits=cl.Limits(0.03, 0.05))


def test_a_case_file_can_be_checked_by_its_path(run):
    again = cl.check(Path(CASE), limits=cl.Limits(0.03, 0.05))
    loaded = cl.check(cl.load_case(CASE), limits=cl.Limits(0.03, 0.05))
    assert run.steps.equals(again.steps) and run.steps.equals(loaded.steps)
    with pytest.raises(MissingFile):
        cl.check("nowhere.yaml")
    with pytest.raises(BadInput, match="a int is given"):
        cl.check(3)


def test_a_run_is_told_in_a_line(run):
    told = repr(run)
    assert "\n" not in told and len(told) < 200
    assert told.startswith(f"<Run {run.record.case.name}: {run.verdict.text()}, ")
    assert run.worst["link"] in told and run.worst["obstacle"] in told


@pytest.mark.parametrize("certify", [True, False])
def test_the_worst_moment_names_its_bodies_in_both_ways_whatever_moves(certify):
    """Two cubes of 0.1 m pass each other, 0.11 m apart in height; at both samples they are 0.9 m aside too."""
    one = sliding("left", [(0, 0), (1, 1)])
    other = sliding("right", [(0, 1), (1, 0)], base=at(z=0.71))
    apart = cl.check(cl.Case("passing", (one, other), ()), certify=certify)
    for row in (apart.worst, apart.worst_sample):
        assert (row["link"], row["obstacle"]) == ("left/tool", "right/tool")
        for side, name in (("body_a", "link"), ("body_b", "obstacle")):
            stem = side.removeprefix("body_")
            assert row[side] == row[name]
            assert [row[f"{stem}_{x}"] for x in "xyz"] == [row[f"{name}_{x}"] for x in "xyz"]
    assert apart.worst.get("between", False) == certify
    assert apart.worst["clearance"] == pytest.approx(0.11 if certify else np.hypot(0.9, 0.11))


def test_summary_and_events_are_those_of_the_report(run, tmp_path):
    folder = run.save(tmp_path / "out")
    assert folder == tmp_path / "out"
    written = json.loads((folder / "summary.json").read_text())
    assert json.loads(json.dumps(run.summary)) == written
    assert [event.what for event in run.events] == [event["what"] for event in written["events"]]
    assert run.events

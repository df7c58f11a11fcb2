"""The summary says what the record says, as JSON, without a trace of this machine."""

from __future__ import annotations

import dataclasses
import json
from pathlib import Path

import numpy as np
import pytest

import clearance as cl
from clearance.errors import BadInput, MissingFile
from clearance.report.summary import json_text
from clearance.report.topics.provenance import public_path
from clearance.world.robot import Joint, JointKind
from tests.made_cases import at
from tests.report.cells import sliding
from tests.report.made import summary_of, write
from tests.report.records import record


def test_joints_without_limits_are_null_and_not_infinity(tmp_path):
    run = record(n_steps=5)
    robot = run.motions[0].placed.robot
    turning = Joint("pan", JointKind.CONTINUOUS, "base", "upper", np.eye(4), np.array([0.0, 0, 1]))
    placed = dataclasses.replace(
        run.motions[0].placed,
        robot=dataclasses.replace(robot, joints=(turning, *robot.joints[1:])),
    )
    run = dataclasses.replace(run, motions=(dataclasses.replace(run.motions[0], placed=placed),))
    joint = json.loads(json_text(summary_of(run)))["worst"]["joints"][0]
    assert (joint["lower"], joint["upper"]) == (None, None)
    write(run, tmp_path / "out")
    assert "no limits" in (tmp_path / "out" / "report.html").read_text()


def test_tracking_error_is_told_when_the_motion_is_simulated():
    run = record(n_steps=5)
    error = np.array([0.0, 0.1, 0.5, 0.2, 0.0])
    steps = run.rows.with_columns({"tracking_error": error})
    assert summary_of(run)["tracking_error"] is None
    told = summary_of(dataclasses.replace(run, table=steps))["tracking_error"]
    assert told == {"greatest": 0.5, "step": 2}


@pytest.mark.parametrize(
    ("path", "shown"),
    [
        ("case.yaml", "case.yaml"),
        ("/home/someone/cell/case.yaml", "case.yaml"),
        ("/home/someone/robots/arm.urdf", "../robots/arm.urdf"),
        (
            "/x/lib/python3.11/site-packages/pybullet_data/kuka_iiwa/model.urdf",
            "pybullet_data:kuka_iiwa/model.urdf",
        ),
    ],
)
def test_paths_name_no_machine(path, shown):
    assert public_path(path, Path("/home/someone/cell")) == shown


def test_no_file_of_a_report_names_the_folder_it_was_made_in(tmp_path):
    write(record(n_steps=20), tmp_path / "out")
    for path in (tmp_path / "out").iterdir():
        assert b"/home/someone" not in path.read_bytes()
        assert str(tmp_path).encode() not in path.read_bytes()


CASE = "scenes/box_box/case.yaml"


@pytest.fixture(scope="module")
def run():
    return cl.check(CASE, limits=cl.Limits(0.03, 0.05))


def test_a_case_file_can_be_checked_by_its_path(run):
    loaded = cl.check(cl.load_case(Path(CASE)), limits=cl.Limits(0.03, 0.05))
    assert run.steps.equals(loaded.steps)
    with pytest.raises(MissingFile):
        cl.check("nowhere.yaml")
    with pytest.raises(BadInput, match="a int is given"):
        cl.check(3)


def test_a_run_is_told_in_a_line(run):
    told = repr(run)
    assert "\n" not in told and len(told) < 200
    assert told.startswith(f"<Run {run.record.case.name}: {run.verdict.headline()}, ")
    assert run.worst["link"] in told and run.worst["obstacle"] in told
    unchecked = "self-collision not checked [CL531]"
    assert str(run).startswith(told) and str(run).splitlines()[1].strip() == unchecked
    assert run.verdict.text() == f"{run.verdict.headline()}; {unchecked}"


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

"""The summary says what the record says, as JSON, without a trace of this machine."""

from __future__ import annotations

import dataclasses
import json
from pathlib import Path

import numpy as np
import pytest

from clearance.report.summary import json_text
from clearance.report.topics.provenance import public_path
from clearance.world.robot import Joint, JointKind
from tests.made_cases import with_copies
from tests.report.made import summary_of, write
from tests.report.records import record


def test_the_worst_step_is_the_least_row_of_the_table():
    run = record()
    worst = summary_of(run)["worst"]
    row = min(run.steps.to_pylist(), key=lambda row: row["clearance"])
    assert worst["step"] == row["step"]
    assert worst["point_link"] == [row["link_x"], row["link_y"], row["link_z"]]
    positions = run.motions[0].positions[row["step"]].tolist()
    assert [joint["position"] for joint in worst["joints"]] == positions
    assert [joint["name"] for joint in worst["joints"]] == ["pan", "lift", "slide"]


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
    steps = run.steps.append_column("tracking_error", [[0.0, 0.1, 0.5, 0.2, 0.0]])
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


def test_a_mesh_that_holds_each_face_once_for_each_side_is_told_as_two_sided():
    made = record()
    first = made.case.obstacles[0]
    both = with_copies(first.body.shape, range(first.body.shape.n_faces), turned_round=True)
    doubled = dataclasses.replace(first, body=dataclasses.replace(first.body, shape=both))
    case = dataclasses.replace(made.case, obstacles=(doubled, *made.case.obstacles[1:]))
    told = summary_of(dataclasses.replace(made, case=case))["obstacles"]
    assert [body["two_sided"] for body in told] == [True] + [False] * (len(told) - 1)

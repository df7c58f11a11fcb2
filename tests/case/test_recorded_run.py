"""A recorded run in place of what was asked: what it is held against, what becomes of it, what is refused."""

from dataclasses import replace

import numpy as np
import pytest

import clearance as cl
from clearance.case.recorded_run import with_recorded
from clearance.cli import run
from clearance.errors import (
    BadInput,
    BadTime,
    ClearanceError,
    MissingKey,
    UnknownJoint,
    UnknownRobot,
)
from clearance.world.budget import Budget, JointTolerance, RobotTolerance
from clearance.world.recording import motion_left_out, recording_of
from clearance.world.timing import AS_GIVEN, Timing
from clearance.world.trajectory import Trajectory
from tests.formats.making_case import TWO_JOINTS, load_small
from tests.formats.making_cell import load_cell

PATH = "time,shoulder,lift\n0,0,0\n1,0.1,0.01\n2,0.3,0.01\n"
APART = "it covers 5 to 6 s, and the commanded motion 0 to 1 s; --recorded-offset -5 if both begin"
FAR_OFF = (
    "joint 'shoulder' is 0.5 rad off the commanded motion at 0.000 s; at most 0.2 rad, "
    "of joints with the zeros and signs of the URDF (`axes` of a program is not applied); "
    "--recorded-offset, if its clock is another"
)
DRIVEN = "time,shoulder,lift\n0,0,0\n0.5,0.06,0.006\n2,0.298,0.01\n2.5,0.298,0.01\n"


def trajectory(times, *columns, names=("a", "b")):
    return Trajectory(np.array(times, float), names[: len(columns)], np.array(columns, float).T)


def held(driven, asked, timing=AS_GIVEN, resting=None):
    return recording_of("run.csv", 0.0, driven, asked, timing, resting or {})


def case(folder, driven=DRIVEN, **files):
    found = load_small(folder, urdf=TWO_JOINTS, trajectory=PATH, **files)
    (folder / "run.csv").write_text(driven)
    return found


def test_the_greatest_error_is_found_at_the_samples_of_either():
    asked = trajectory([0, 1, 2], [0.0, 1.0, 0.0])
    driven = trajectory([0, 2], [0.0, 0.0])
    (one,) = held(driven, asked).joints
    assert (one.joint, one.greatest, one.time) == ("a", 1.0, 1.0)
    (one,) = held(asked, driven).joints
    assert (one.greatest, one.time) == (1.0, 1.0)


def test_most_samples_are_no_farther_off_than_what_is_told():
    times = np.linspace(0.0, 1.0, 201)
    off = np.where(np.arange(201) == 100, 0.5, 0.01)
    (one,) = held(trajectory(times, off), trajectory([0, 1], [0.0, 0.0])).joints
    assert (one.greatest, one.usual) == (0.5, 0.01)


def test_only_the_time_that_both_are_of_counts():
    asked = trajectory([1, 2], [0.0, 0.0])
    driven = trajectory([0, 1, 2, 3], [9.0, 0.1, 0.2, 9.0])
    found = held(driven, asked)
    assert (found.start, found.end, found.joints[0].greatest) == (1.0, 2.0, 0.2)
    timed = held(driven, trajectory([0, 2], [0.0, 0.0]), Timing(start=1.0, rate=2.0))
    assert (timed.start, timed.end) == (1.0, 2.0)


def test_joints_that_were_to_stay_are_held_against_where():
    asked = trajectory([0, 1], [0.0, 0.0])
    driven = trajectory([0, 1], [0.0, 0.0], [0.5, 0.6])
    assert held(driven, asked, resting={"b": 0.5}).joints[1].greatest == pytest.approx(0.1)


@pytest.mark.parametrize(
    ("driven", "timing", "kind", "told"),
    [
        (trajectory([5, 6], [0, 0], [0, 0]), AS_GIVEN, BadTime, APART),
        (trajectory([0, 1], [0, 0]), AS_GIVEN, MissingKey, "does not have joints b of the commanded motion"),
        (trajectory([0, 1], [0, 0], [0, 0]), Timing(after="loop"), BadInput, "begins again and again"),
    ],
)  # fmt: skip
def test_what_cannot_be_held_against_it_is_refused(driven, timing, kind, told):
    with pytest.raises(kind) as caught:
        held(driven, trajectory([0, 1], [0, 0], [0, 0]), timing)
    assert told in str(caught.value)


def test_its_errors_become_the_tracking(tmp_path):
    found = with_recorded(case(tmp_path), tmp_path / "run.csv")
    joints = found.tolerance.robots["arm"].joints
    assert joints["shoulder"].tracking == pytest.approx(0.06 + 0.238 / 3 - 0.1)
    assert joints["lift"].tracking == pytest.approx(0.01 - 0.006 - 0.004 / 3)
    assert found.tolerance.sources == ("tracking: the greatest errors of the run run.csv",)
    assert (
        found.robots[0].given_trajectory.n_steps == 4
        and found.robots[0].recording.commanded.n_steps == 3
    )
    told = " | ".join(found.notes)
    assert (
        "recorded run run.csv: compared with what was asked from 0.000 to 2.000 s; its clock is taken"
        in told
    )
    assert "run.csv" in [one.path for one in found.sources]


def test_an_offset_is_added_to_its_times(tmp_path):
    own = with_recorded(case(tmp_path), tmp_path / "run.csv")
    head, *rows = DRIVEN.splitlines()
    late = [f"{float(row.split(',')[0]) + 10},{row.split(',', 1)[1]}" for row in rows]
    found = with_recorded(case(tmp_path, "\n".join([head, *late, ""])), tmp_path / "run.csv", -10.0)
    assert found.robots[0].recording.joints == own.robots[0].recording.joints
    assert "-10 s are added to its times" in " ".join(found.notes)


@pytest.mark.parametrize(
    ("text", "kind", "told"),
    [
        ("time,shoulder\n0,0\n2,0.3\n", MissingKey, "recorded: run.csv: it does not have joints lift"),
        ("time,shoulder,elbow\n0,0,0\n", UnknownJoint, "unknown joint 'elbow'"),
        ("time,shoulder,lift\n", ClearanceError, "run.csv"),
        ("time,shoulder,lift\n9,0,0\n10,0,0\n", BadTime, "it covers 9 to 10 s"),
        ("time,shoulder,lift\n0,0.5,0\n2,0.5,0\n", BadInput, FAR_OFF),
    ],
)  # fmt: skip
def test_what_is_refused(tmp_path, text, kind, told):
    with pytest.raises(kind) as caught:
        with_recorded(case(tmp_path, text), tmp_path / "run.csv")
    assert told in str(caught.value)


@pytest.mark.parametrize(
    ("text", "span", "rest"),
    [
        ("time,shoulder,lift\n0,0,0\n1,0.1,0.01\n", "0.000 to 1.000 s", "0.2 rad"),
        ("time,shoulder,lift\n1,0.1,0.01\n2,0.3,0.01\n", "1.000 to 2.000 s", "0.1 rad"),
    ],
)
def test_a_recording_of_a_part_of_the_motion_says_so_beside_the_verdict(tmp_path, text, span, rest):
    found = cl.check(case(tmp_path, text), motion="recorded", recorded=tmp_path / "run.csv")
    (told,) = [line for line in found.verdict.warnings if "run.csv" in line]
    assert f"recorded from {span} of 0.000 to 2.000 s: nothing is said of the other 1 s, in" in told
    assert f"joint 'shoulder' was to move by {rest}" in told


def test_a_recording_that_leaves_out_much_of_the_motion_is_refused(tmp_path):
    short = "time,shoulder,lift\n0,0,0\n0.5,0.05,0.005\n"
    with pytest.raises(BadInput) as caught:
        with_recorded(case(tmp_path, short), tmp_path / "run.csv")
    assert "in the rest joint 'shoulder' was to move by 0.25 rad" in str(caught.value)
    assert "a recording that misses at most 0.2 rad of it" in str(caught.value)


def test_time_in_which_nothing_was_to_move_may_be_left_out():
    asked = trajectory([0, 1, 2], [0.0, 0.1, 0.1])
    assert not motion_left_out(held(trajectory([0, 1], [0.0, 0.1]), asked))


def test_of_several_robots_one_must_be_named(tmp_path):
    cell = load_cell(tmp_path, "joints: {shoulder: 0.2}", "trajectory: path.csv")
    with pytest.raises(UnknownRobot, match="--recorded-robot left or right"):
        with_recorded(cell, tmp_path / "path.csv")
    found = with_recorded(cell, tmp_path / "path.csv", robot="right")
    assert found.robots[0].recording is None and found.robots[1].recording.joints[0].greatest == 0.0
    (told,) = (one.text for one in found.notices if one.kind == "recorded run")
    assert told.startswith("path.csv is a run of right alone: left is taken to move exactly")
    errors = RobotTolerance(joints={"shoulder": JointTolerance(tracking=0.01)})
    known = replace(cell, tolerance=Budget(robots={"left": errors}))
    assert not with_recorded(known, tmp_path / "path.csv", robot="right").notices
    standing = load_cell(tmp_path)
    with pytest.raises(UnknownRobot, match="robot 'right' was asked for nothing"):
        with_recorded(standing, tmp_path / "path.csv", robot="right")


def test_the_run_is_measured_as_driven_beside_what_was_asked(tmp_path):
    base = case(tmp_path)
    found = cl.check(base, motion="recorded", recorded=tmp_path / "run.csv")
    own = Trajectory(
        np.array([0, 0.5, 2, 2.5]),
        ("shoulder", "lift"),
        np.array([[0, 0], [0.06, 0.006], [0.298, 0.01], [0.298, 0.01]]),
    )
    driven = cl.check(base.with_trajectory(own.times, own.positions, joint_names=own.joint_names))
    assert found.steps["clearance"].to_pylist() == driven.steps["clearance"].to_pylist()
    asked = cl.check(base)
    assert found.record.commanded.clearances.tolist() == asked.steps["clearance"].to_pylist()
    assert found.summary["motion"] == "recorded"
    told = found.summary["recordings"]
    assert told["asked"]["clearance"] == asked.worst_sample["clearance"]
    assert [one["joint"] for one in told["runs"][0]["joints"]] == ["shoulder", "lift"]


def test_on_the_command_line(tmp_path, capsys):
    case(tmp_path)
    file, own = str(tmp_path / "case.yaml"), str(tmp_path / "run.csv")
    code = run(["check", file, "--motion", "recorded", own, "--unproven-ok"])
    told = capsys.readouterr().out
    assert code == 0 and "recorded    as commanded " in told
    assert "run.csv is off by at most (99 % of samples): shoulder 0.0393 rad (0.0393 rad)" in told
    for wrong, says in (
        ([file, "--motion", "recorded"], "RUN: nothing is given; motion 'recorded' needs the file"),
        ([file, own], "says nothing without --motion recorded"),
        ([file, "--recorded-offset", "1"], "--recorded-offset says nothing"),
        ([file, "--motion", "recorded", own, "--recorded-robot", "amr"], "there is no one robot 'amr'"),
    ):  # fmt: skip
        assert run(["check", *wrong]) == 2 and says in capsys.readouterr().err

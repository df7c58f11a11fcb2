"""Holes in recordings: found by what is usual, never bridged without a word, and treated as the case says."""

from dataclasses import replace

import numpy as np
import pytest

import clearance as cl
from clearance.case.case_file import load_case
from clearance.case.recorded_run import with_recorded
from clearance.errors import BadInput
from clearance.formats.motion.joint_states import JointState, trajectory_of_states
from clearance.formats.motion.recording_gaps import tracks_of
from clearance.report.motion_file import motion_content
from clearance.world.body import Body, Obstacle
from clearance.world.motion import kinematic_motion
from clearance.world.pairs import selected_pairs
from clearance.world.plausibility import notices_of
from clearance.world.pose_table import PoseTable
from clearance.world.timeline import timeline_of
from tests.formats.making import write_case
from tests.formats.making_case import TWO_JOINTS, changed
from tests.formats.making_cell import load_cell
from tests.formats.refusal import refusal

STEP = 0.02
"""[s] Between two messages, 50 a second."""


def states(times, column, names=("shoulder",), swing=lambda t: 0.0):
    """Messages at times [s] in which one joint goes as `swing` says and others stand."""
    return [
        JointState(round((5.0 + t) * 1e9), names, [swing(t) if name == column else 0.0 for name in names])
        for t in times
    ]  # fmt: skip


def with_hole(start=1.0, end=3.0, last=4.0):
    times = STEP * np.arange(round(last / STEP) + 1)
    return [t for t in times.tolist() if t <= start + 1e-9 or t >= end - 1e-9]


def swing(t):
    """[rad] Over to 2.1 rad and back from 1 s to 3 s, still otherwise."""
    return 2.1 * np.sin(np.pi * (t - 1.0) / 2.0) if 1.0 < t < 3.0 else 0.0


def read(messages, gaps=None):
    return trajectory_of_states(messages, {}, gaps)


@pytest.mark.parametrize(
    ("times", "starts"),
    [
        ([0.0], []),
        ([0.0, 990.0], []),  # nothing is usual
        ([0.0, 1.0, 11.0], []),  # ten times as long
        ([0.0, 1.0, 11.1], [1]),
        ([0.0, 990.0, 990.02], [0]),  # stamped long before
        ([0.0, 0.02, 0.04, 0.3, 0.32, 0.9], [2, 4]),
    ],
)
def test_a_hole_is_more_than_ten_usual_intervals(times, starts):
    tracks = tracks_of({"j": (np.array(times), np.zeros(len(times)))})
    assert tracks["j"].holes.tolist() == starts


def test_joints_that_are_recorded_at_different_rates_have_their_own_holes():
    """The arm's messages are a tenth of a second apart, the finger's a second but for one of 15."""
    arm = states(np.arange(400) * 0.1, "shoulder")
    told = [0.05, *np.arange(1.0, 5.0), *np.arange(20.0, 40.0)]
    messages = sorted(arm + states(told, "finger", ("finger",)))
    (hole,) = read(messages).trajectory.holes
    assert hole.joints == ("finger",)
    assert (hole.start, hole.end) == pytest.approx(
        (4.0 - 0.05, 20.0 - 0.05)
    )  # all are known from 0.05 s


def test_a_joint_that_is_told_of_a_few_times_only_has_holes_between():
    """Twice in 10 s, as by a latched topic, where the arm is told of 50 times a second."""
    arm = states(STEP * np.arange(501), "shoulder")
    messages = sorted(
        arm + states([-990.0, 5.0], "finger", ("finger",), lambda t: 0.02 * (t > 0.0))
    )
    hole, before = read(messages, "hold").trajectory.holes
    assert (before.joints, before.start, before.means) == (("shoulder",), -990.0, "not_measured")
    assert (hole.joints, hole.usual) == (("finger",), pytest.approx(STEP))
    assert (hole.start, hole.end) == pytest.approx((0.0, 5.0))
    found = read(messages, "hold").trajectory
    at = np.interp([4.9, 4.98, 4.99, 5.0, 10.0], found.times, found.positions[:, 0])
    assert at == pytest.approx([0.0, 0.0, 0.01, 0.02, 0.02])


def test_ends_at_which_some_joints_are_unknown_are_said_not_to_be_measured():
    arm = states(STEP * np.arange(501), "shoulder")
    finger = states(0.4 + STEP * np.arange(456), "finger", ("finger",))
    (start, end) = read(sorted(arm + finger)).trajectory.holes
    assert (start.joints, start.means, end.means) == (("finger",), "not_measured", "not_measured")
    assert (start.start, start.end, end.start, end.end) == pytest.approx((-0.4, 0.0, 9.1, 9.6))


@pytest.mark.parametrize(("way", "n_holes"), [(0.009, 0), (0.02, 1)])
def test_a_few_messages_at_an_end_are_a_hole_if_a_joint_moves_in_them(way, n_holes):
    arm = states(STEP * np.arange(501), "shoulder", swing=lambda t: way * (t > 9.95))
    finger = states(STEP * np.arange(496), "finger", ("finger",), swing=lambda t: 0.0)
    holes = read(sorted(arm + finger)).trajectory.holes
    assert [(one.joints, one.means) for one in holes] == [(("finger",), "not_measured")] * n_holes


@pytest.mark.parametrize(
    "times",
    [
        (np.arange(50)[:, None] * 0.025 + np.arange(4) * 0.001).ravel(),  # four at a time, 40 times a second
        np.delete(np.arange(500) * 0.002, np.arange(200, 260)),  # a driver at 500 Hz pauses for 0.122 s
    ],
)  # fmt: skip
def test_pauses_as_short_as_slow_recordings_have_throughout_are_no_holes(times):
    assert not read(states(times, "shoulder")).trajectory.holes


def test_a_joint_that_holds_moves_within_a_usual_interval_before_its_next_message():
    messages = states(with_hole(), "shoulder", swing=lambda t: 0.0 if t <= 1.0 else 0.4)
    trajectory, _ = read(messages, "hold")
    at = np.interp([1.5, 2.97, 2.98, 2.99, 3.0], trajectory.times, trajectory.positions[:, 0])
    assert at == pytest.approx([0.0, 0.0, 0.0, 0.2, 0.4], abs=1e-9)
    straight, _ = read(messages, "linear")
    at = np.interp([1.5, 2.5], straight.times, straight.positions[:, 0])
    assert at == pytest.approx([0.1, 0.3])


def test_a_joint_that_is_told_of_once_holds_to_the_end():
    messages = sorted(
        states(STEP * np.arange(100), "shoulder")
        + states([0.0101], "lift", ("lift",), lambda t: 0.05)
    )
    assert "joint 'lift' is known from" in refusal(read, messages, of=BadInput)
    trajectory, _ = read(messages, "hold")
    assert trajectory.positions[:, 1] == pytest.approx(0.05)
    assert trajectory.times[-1] == pytest.approx(99 * STEP - 0.0101)


LOG = "time,shoulder,lift\n" + "".join(f"{t},0,0\n" for t in with_hole())


EPOCH_LOG = "time,shoulder,lift\n" + "".join(f"{1.7e9 + t},0,0\n" for t in with_hole())


def suspects(case):
    return [n for n in notices_of(case) if n.severity == "suspect"]


def test_a_table_is_a_recording_where_it_is_given_as_one(tmp_path):
    asked = "time,shoulder,lift\n0,0,0\n4,0,0\n"
    case = load_case(write_case(tmp_path, urdf=TWO_JOINTS, trajectory=asked))
    (tmp_path / "run.csv").write_text(LOG)
    (told,) = suspects(with_recorded(case, tmp_path / "run.csv"))
    assert told.kind == "gaps"
    assert told.text == (
        "the recording has a hole, bridged by a straight line: no position of shoulder, lift from 1 to 3 s "
        "(2 s, usually 0.02 s); say how joints move in it with gaps: hold | linear | not_measured "
        "beside the file (--recorded-gaps)"
    )
    held = with_recorded(case, tmp_path / "run.csv", 0.5, gaps="not_measured")
    assert not suspects(held)
    (hole,) = held.robots[0].given_trajectory.holes
    assert (hole.start, hole.end) == pytest.approx((1.5, 3.5))
    with pytest.raises(BadInput, match="gaps is 'straight'"):
        with_recorded(case, tmp_path / "run.csv", gaps="straight")


def test_what_is_not_measured_says_nothing_of_how_far_a_joint_was_off(tmp_path):
    asked = "time,shoulder,lift\n0,0,0\n2,0.5,0\n4,0,0\n"
    case = load_case(write_case(tmp_path, urdf=TWO_JOINTS, trajectory=asked))
    rows = [f"{t},{0.25 * min(t, 4 - t)},0\n" for t in with_hole()]
    (tmp_path / "run.csv").write_text("time,shoulder,lift\n" + "".join(rows))
    found = with_recorded(case, tmp_path / "run.csv", gaps="not_measured")
    assert found.robots[0].recording.joints[0].greatest < 1e-12
    with pytest.raises(BadInput, match=r"joint 'shoulder' is 0\.25 rad off"):
        with_recorded(case, tmp_path / "run.csv", gaps="linear")


def test_steps_at_which_nothing_is_measured_have_no_status(tmp_path):
    """Those of a door that moves while the arm's positions are not known."""
    text = changed("file: path.csv", "file: path.csv, gaps: not_measured")
    case = load_case(write_case(tmp_path, text, urdf=TWO_JOINTS, trajectory=LOG))
    places, stands = np.full((9, 3), 9.0), np.tile([0.0, 0.0, 0.0, 1.0], (9, 1))
    door = Obstacle(
        Body("door", cl.box((0.1, 0.1, 0.1))),
        moves=PoseTable(np.linspace(0.0, 4.0, 9), places, stands),
    )
    run = cl.check(replace(case, obstacles=(door,)))
    status, times = run.steps["status"].to_pylist(), run.steps["time"].to_pylist()
    hole = [1.0 < time < 3.0 for time in times]
    assert sum(hole) == 3 and [one is None for one in status] == hole
    assert run.summary["status_counts"]["clear"] == len(times) - 3


def test_a_case_says_what_a_hole_means(tmp_path):
    files = {"urdf": TWO_JOINTS, "trajectory": LOG}
    text = changed("file: path.csv", "file: path.csv, gaps: not_measured")
    run = cl.check(load_case(write_case(tmp_path, text, **files)))
    assert run.verdict.headline().endswith(", not measured from 1 to 3 s")
    assert run.verdict.shade == "near"  # no green for a part
    assert run.verdict.passed
    told = [text for text in run.verdict.warnings if text.startswith("not measured:")]
    assert told == [
        "not measured: no position of shoulder, lift from 1 to 3 s (2 s, usually 0.02 s) [CL421]"
    ]
    assert run.summary["certified"]["not_measured"] == [[1.0, 3.0]]
    bound = run.record.certificate.lower_bound[run.record.steps["time"].to_numpy() == 1.0]
    assert not np.isfinite(bound).any()
    assert motion_content(run.record.motions, "out.csv").notes == (
        "no position of shoulder, lift from 1 to 3 s (2 s, usually 0.02 s); out.csv bridges it by a straight line",
    )
    held = changed("file: path.csv", "file: path.csv, gaps: hold")
    (told,) = [
        notice.text
        for notice in notices_of(load_case(write_case(tmp_path, held, **files)))
        if "hold" in notice.text
    ]
    assert told == (
        "assumed: joints stay until one usual interval before their next message (gaps: hold); no position of "
        "shoulder, lift from 1 to 3 s (2 s, usually 0.02 s)"
    )
    none = changed("file: path.csv", "file: path.csv, gaps: none")
    assert "gaps" in refusal(load_case, write_case(tmp_path, none, **files), of=BadInput)
    again = changed("file: path.csv", "file: path.csv, gaps: not_measured, after: loop")
    with pytest.raises(BadInput, match="has holes and repeats"):
        load_case(write_case(tmp_path, again, **files))


def test_what_a_robot_carries_is_left_out_with_it_and_others_are_measured(tmp_path):
    """Left's recording has a hole within the time in which it carries the part; the door comes near right then."""
    times = [t for t in (0.01 * np.arange(101)).tolist() if not 0.3 < t < 0.6]
    log = "time,shoulder\n" + "".join(f"{t},0.1\n" for t in times)
    case = load_cell(
        tmp_path,
        "trajectory: path.csv",
        "trajectory: {file: path.csv, gaps: not_measured}",
        trajectory=log,
    )
    line = timeline_of(case, [kinematic_motion(placed) for placed in case.robots])
    left_out = [phase for phase in line.phases if phase.absent_robots]
    assert [left_out[0].span[0], left_out[-1].span[1]] == pytest.approx([0.3, 0.6])
    names = [obstacle.name for obstacle in case.obstacles]
    for phase in left_out:
        assert phase.absent_robots == {0}
        assert {names[i] for i in phase.absent_obstacles} == {"fixture", "workpiece"}
        bodies = [body for pair in selected_pairs(phase).pairs for body in pair]
        measured = {body.name_in(phase.case) for body in bodies}
        assert measured == {"right/base", "right/upper", "door", "post"}


@pytest.mark.parametrize("gaps", ["linear", "hold"])
def test_a_column_that_is_not_read_is_told_whatever_a_hole_means(tmp_path, gaps):
    chosen = f"file: path.csv, gaps: {gaps}, columns: {{time: time, shoulder: shoulder}}"
    case = load_case(
        write_case(tmp_path, changed("file: path.csv", chosen), urdf=TWO_JOINTS, trajectory=LOG)
    )
    assert "columns" in {notice.kind for notice in notices_of(case)}


def test_a_hole_in_times_of_the_epoch_is_told_to_the_millisecond(tmp_path):
    files = {"urdf": TWO_JOINTS, "trajectory": EPOCH_LOG}
    text = changed("file: path.csv", "file: path.csv, gaps: not_measured")
    verdict = cl.check(load_case(write_case(tmp_path, text, **files))).verdict
    assert verdict.headline().endswith(", not measured from 1700000001 to 1700000003 s")
    assert "from 1700000001 to 1700000003 s (2 s, usually 0.02 s)" in verdict.warnings[0]

"""One sample is no motion: the verdict is of a pose, a goal needs its start, and what messages say is used."""

import io
import json
import re
from dataclasses import replace

import numpy as np
import pytest

from clearance import check, load_case
from clearance.cli import run
from clearance.errors import BadInput, BadTime, MissingKey
from clearance.formats.motion.requests import TrajectoryRequest, read_trajectory
from clearance.formats.schema.timed import Choice
from clearance.world.cubic import positions_along
from clearance.world.plausibility import notices_of
from tests.formats.making_case import TWO_JOINTS, changed, load_small
from tests.formats.refusal import refusal

SRDF = (
    '<robot name="arm"><group_state name="home" group="arm"><joint name="shoulder" value="-0.5"/>'
    '<joint name="lift" value="0.02"/></group_state></robot>'
)


def point(time, *positions, **more):
    return {"positions": list(positions), "time_from_start": time, **more}


def plan(*points, names=("shoulder",), **more):
    return {"joint_names": list(names), "points": list(points), **more}


def state(positions, velocities=(), **more):
    joints = {"name": [*positions], "position": [*positions.values()], "velocity": [*velocities]}
    return {"joint_state": joints, **more}


def displayed(trajectory, start, **more):
    """A DisplayTrajectory of one segment."""
    return {"trajectory": [{"joint_trajectory": trajectory}], "trajectory_start": start, **more}


def read(message, which=None):
    data = json.dumps(message).encode()
    choice = Choice.model_construct(which=which)
    request = TrajectoryRequest(lambda: io.BytesIO(data), choice=choice)
    return read_trajectory(request, "path.json")


def load(folder, message, key="", urdf=TWO_JOINTS, robot="", **files):
    case = changed(
        "file: path.csv", f"file: path.json{key}", "urdf: arm.urdf", f"urdf: arm.urdf{robot}"
    )
    return load_small(folder, case, urdf=urdf, path__json=json.dumps(message), **files)


def new_case(folder):
    """The case that `clearance new` makes of the files of the small case and a scene."""
    (folder / "scene.yaml").write_text("obstacles: [{name: post, box: {size: [0.1, 0.1, 1]}}]\n")
    files = {"robot": "arm.urdf", "trajectory": "path.json", "scene": "scene.yaml"}
    asked = [word for key, name in files.items() for word in (f"--{key}", str(folder / name))]
    assert run(["new", str(folder / "made"), *asked]) == 0
    return load_case(folder / "made" / "case.yaml")


def kinds(case):
    return [one.kind for one in notices_of(case)]


GOAL = plan(point(4.0, 1.0, 0.05), names=("shoulder", "lift"))


@pytest.mark.parametrize("time", ["0", "-1"])
def test_a_table_of_one_row_is_a_single_pose(tmp_path, capsys, time):
    case = load_small(tmp_path, trajectory=f"time,shoulder\n{time},0.5\n")
    assert kinds(case) == []
    found = check(case)
    assert found.verdict.headline() == "clear at a single pose" and found.verdict.basis == "pose"
    assert run(["check", str(tmp_path / "case.yaml")]) == 0
    told = capsys.readouterr().out
    assert "CLEAR at a single pose" in told and "every moment" not in told
    assert " mm at this pose\n" in told
    assert run(["check", str(tmp_path / "case.yaml"), "--samples-only"]) == 0
    assert "CLEAR at a single pose" in capsys.readouterr().out


def test_a_goal_without_a_start_is_suspect_in_whatever_format(tmp_path):
    says = (
        "the trajectory of robot 'arm' has one sample, at 4 s: the motion to this goal is not measured; give its "
        "start at 0 s with trajectory: {start_state: …}, or give the sample the time 0 to check a single pose"
    )
    for case in (load(tmp_path, GOAL), load_small(tmp_path, trajectory="time,shoulder\n4,1\n")):
        assert [(one.kind, one.text) for one in notices_of(case)] == [("start", says)]
        found = check(case, need="minimum")
        assert found.verdict.exit_code == 2
        assert found.verdict.headline() == "suspect (would be clear at a single pose)"


LATE = plan(point(4.0, 1.0, 0.05), point(6.0, 0.0, 0.05), names=("shoulder", "lift"))


def test_the_way_to_a_first_point_after_0_s_is_said_in_the_headline(tmp_path):
    says = (
        "not measured: how robot 'arm' comes to its first point at 4 s; "
        "give its start at 0 s with trajectory: {start_state: …}"
    )
    case = load(tmp_path, LATE)
    assert [one.text for one in notices_of(case)] == [says]
    found = check(case, need="minimum").verdict
    assert found.exit_code == 0 and list(found.warnings) == [f"{says} [CL420]"]
    assert kinds(load(tmp_path, LATE, ", start_state: {shoulder: 0, lift: 0}")) == []
    both = plan(point(0.0, 0.1, 0.05), point(1.0, 0.2, 0.05), names=("shoulder", "lift"))
    start = displayed(both, state({"shoulder": 0.3, "lift": 0.05}))
    assert [one.text for one in notices_of(load(tmp_path, start))] == [
        "not measured: how robot 'arm' comes to its first point at 0 s: trajectory_start has joint 'shoulder' "
        "0.2 rad or m off it; plan from where the robot is, or give the points later times"
    ]
    start = state({"shoulder": 0.0, "lift": 0.0})
    assert kinds(load(tmp_path, displayed(LATE, start))) == []
    assert kinds(load_small(tmp_path, trajectory="time,shoulder\n4,1\n6,0\n")) == []


def test_a_new_case_keeps_that_the_way_to_the_first_point_is_not_known(tmp_path, capsys):
    load(tmp_path, LATE)
    case = new_case(tmp_path)
    assert kinds(case) == ["start"]
    assert "start_state: {shoulder: 0.0, lift: 0.0}" in (tmp_path / "made/case.yaml").read_text()


def test_a_start_in_the_case_makes_it_a_motion(tmp_path):
    case = load(tmp_path, GOAL, ", start_state: {shoulder: -0.5, lift: 0.02}")
    asked = case.robots[0].trajectory
    assert kinds(case) == [] and asked.times.tolist() == [0.0, 4.0]
    assert asked.positions.tolist() == [[-0.5, 0.02], [1.0, 0.05]]
    said = "joints start from rest in start_state at 0 s and go to the first sample at 4 s as between samples"
    assert any(said in note for note in case.notes)
    assert check(case, need="minimum").verdict.headline() == "clear"
    named = load(tmp_path, GOAL, ", start_state: home", robot=", srdf: arm.srdf", arm__srdf=SRDF)
    assert named.robots[0].trajectory.positions.tolist() == asked.positions.tolist()


def test_with_accelerations_it_goes_on_a_quintic_from_rest(tmp_path):
    """From rest to rest the quintic is s^3 (10 - 15 s + 6 s^2): at a quarter 0.103516 of the way."""
    goal = plan(point(4.0, 1.0, velocities=[0.0], accelerations=[0.0]))
    for message, key in (
        (goal, ", start_state: {shoulder: 0}"),
        (displayed(goal, state({"shoulder": 0.0})), ""),
    ):
        asked = load(tmp_path, message, key).robots[0].trajectory
        assert asked.points.times.tolist() == [0.0, 4.0]
        assert positions_along(asked, np.array([1.0]))[0, 0] == pytest.approx(0.103516, abs=2e-6)


@pytest.mark.parametrize(
    ("key", "fault", "says"),
    [
        ("{shoulder: 0}", MissingKey, "start_state: it has no position of 'lift'"),
        ("1.5", BadInput, "start_state"),
        ("[]", BadInput, r"start_state: \[\] is given; names of states"),
        ("home", MissingKey, "start_state: state 'home' is in no file"),
    ],
)  # fmt: skip
def test_a_start_that_is_none_is_refused(tmp_path, key, fault, says):
    assert re.search(says, refusal(load, tmp_path, GOAL, f", start_state: {key}", of=fault))


def test_a_start_is_refused_where_nothing_comes_before_the_first_sample(tmp_path):
    message = plan(point(0.0, 0.1), point(1.0, 0.2))
    with pytest.raises(BadTime, match="the trajectory begins at 0 s itself; no start_state"):
        load(tmp_path, message, ", start_state: {shoulder: 0}")
    with pytest.raises(BadInput, match="the trajectory does not move 'lift'"):
        load(tmp_path, plan(point(1.0, 0.1)), ", start_state: {shoulder: 0, lift: 0}")


def test_the_start_of_a_message_is_used():
    trajectory, notes = read(displayed(plan(point(4.0, 1.0)), state({"shoulder": -0.5})))
    assert trajectory.times.tolist() == [0.0, 4.0]
    assert trajectory.positions.tolist() == [[-0.5], [1.0]]
    assert notes == (
        "path.json: joints start in trajectory_start at 0 s and go to the first point at 4 s as between points",
    )
    moving = displayed(plan(point(4.0, 1.0, velocities=[0.0])), state({"shoulder": -0.5}, [0.25]))
    assert read(moving).trajectory.velocities.tolist() == [[0.25], [0.0]]


def test_what_the_start_says_of_other_joints_and_another_place_is_told():
    start = state({"shoulder": 0.3, "finger": 0.04, "thumb": 0.0})
    trajectory, notes = read(displayed(plan(point(0.0, 0.1), point(1.0, 0.2)), start))
    assert trajectory.positions[0, 0] == 0.1
    told = " | ".join(notes)
    assert (
        "trajectory_start also has joints that the trajectory does not move {finger: 0.04, thumb: 0}"
        in told
    )
    assert "has joint 'shoulder' 0.2 off the first point, at 0 s; the point is used" in told
    assert trajectory.has_way_in and trajectory.start_off == (
        "trajectory_start has joint 'shoulder' 0.2 rad or m off it"
    )
    _, notes = read(displayed(plan(point(1.0, 0.1, 0.0), names=("shoulder", "lift")), start))
    assert any("trajectory_start is not used: it has no position of lift" in note for note in notes)


START = state({"shoulder": 0.1, "lift": 0.04, "elsewhere": 1.0})
MOVE = displayed(plan(point(0.0, 0.1), point(1.0, 0.2)), START)


@pytest.mark.parametrize(
    ("joints", "told"),
    [
        ("", "robot 'arm' rests otherwise than its message starts: joint 'lift' at 0, and there at 0.04; "),
        (", joints: {lift: 0.01}", "joint 'lift' at 0.01, and there at 0.04; "),
        (", joints: {lift: 0.04}", ""),
    ],
)  # fmt: skip
def test_joints_that_rest_otherwise_than_a_message_has_them_stand_in_the_headline(
    tmp_path, joints, told
):
    found = [one for one in notices_of(load(tmp_path, MOVE, robot=joints)) if one.kind == "rest"]
    assert len(found) == bool(told)
    assert all(told in one.text and "joints: {lift: 0.04}" in one.text for one in found)


@pytest.mark.parametrize(("rests", "is_told"), [(0.0, False), (-0.1, True)])
def test_whole_turns_are_no_other_rest_of_a_continuous_joint(tmp_path, rests, is_told):
    endless = TWO_JOINTS.replace(
        'name="shoulder" type="revolute"', 'name="shoulder" type="continuous"'
    )
    start = state({"lift": 0.0, "shoulder": 6.283185307})
    move = displayed(plan(point(0.0, 0.0), point(1.0, 0.02), names=("lift",)), start)
    case = load(tmp_path, move, robot=f", joints: {{shoulder: {rests}}}", urdf=endless)
    assert [one.kind for one in notices_of(case) if one.kind == "rest"] == ["rest"] * is_told


def test_the_remedy_of_a_rest_among_several_robots_names_the_robot(tmp_path):
    """Such a case has `robots`, whose rows have names."""
    case = load(tmp_path, MOVE)
    other = replace(case.robots[0], robot=replace(case.robots[0].robot, name="second"))
    told = [one.text for one in notices_of(replace(case, robots=(*case.robots, other)))]
    assert any(
        one.endswith("; robots: [{name: arm, joints: {lift: 0.04}}] has them as there")
        for one in told
    )
    assert any("robots: [{name: second, joints: {lift: 0.04}}]" in one for one in told)


@pytest.mark.parametrize("is_moved", [False, True])
def test_a_later_segment_has_joints_at_rest_where_none_has_moved_them(tmp_path, is_moved):
    both = plan(point(0.0, 0.1, 0.04), point(1.0, 0.2, 0.0), names=("shoulder", "lift"))
    before = both if is_moved else plan(point(0.0, 0.1), point(1.0, 0.2))
    after = plan(point(0.0, 0.2), point(1.0, 0.3))
    segments = [{"joint_trajectory": one} for one in (before, after)]
    case = load(tmp_path, {"trajectory": segments, "trajectory_start": START}, ", which: 2")
    told = [one.text for one in notices_of(case) if one.kind == "rest"]
    assert any("joint 'lift' at 0, and there at 0.04" in one for one in told) is not is_moved


def test_a_new_case_has_joints_at_rest_where_the_message_has_them(tmp_path):
    load(tmp_path, MOVE)
    case = new_case(tmp_path)
    assert case.robots[0].fixed_positions == {"lift": 0.04} and kinds(case) == []


def test_a_later_segment_does_not_begin_at_the_start():
    segments = [{"joint_trajectory": plan(point(t, 0.1))} for t in (1.0, 2.0)]
    message = {"trajectory": segments, "trajectory_start": state({"shoulder": 0.0})}
    assert read(message, 1).trajectory.times.tolist() == [0.0, 1.0]
    trajectory, notes = read(message, 2)
    assert trajectory.times.tolist() == [2.0]
    assert notes == (
        "path.json: the first point is at 2 s; how the robot gets there is not in the file",
        "path.json: fields beside the points, not read: trajectory[0].joint_trajectory, trajectory_start",
    )


def test_segments_that_are_not_chosen_stand_in_the_headline(tmp_path):
    """Other messages of the file are other plans, as are those of a list."""
    segments = [{"joint_trajectory": plan(point(0.0, 0.1), point(t, 0.2))} for t in (1.0, 2.0, 3.0)]
    message = {"trajectory": segments, "trajectory_start": state({"shoulder": 0.1})}
    case = load(tmp_path, message, ", which: 2")
    (told,) = (one for one in notices_of(case) if one.kind == "columns")
    assert told.text.endswith(
        "not read: trajectory[0].joint_trajectory, trajectory[2].joint_trajectory"
    )
    plans = [{"trajectory": segments[0]}, {"trajectory": segments[1]}]
    trajectory, notes = read(plans, 2)
    assert trajectory.unread == ()
    assert "path.json: trajectories in other messages, not read: 1" in notes


@pytest.mark.parametrize(
    ("start", "says"),
    [
        ({"name": ["a"], "position": []}, "trajectory_start.joint_state: position is"),
        ({"name": ["a"], "position": ["x"]}, "a finite number for each name"),
        ({"name": ["a"], "position": [0.0], "velocity": [1, 2]}, "velocity is"),
        ({"name": ["a"], "position": [0.0], "velocty": [1]}, "unknown field 'velocty'; did you mean 'velocity'"),
    ],
)  # fmt: skip
def test_a_start_that_is_no_state_is_refused(start, says):
    with pytest.raises(BadInput, match=says):
        read(displayed(plan(point(1.0, 0.1), names=("a",)), {"joint_state": start}))


def test_a_start_under_a_name_that_is_misspelt_is_refused():
    message = {"trajectory_strat": state({"shoulder": 0.0}), "trajectory": plan(point(1.0, 0.1))}
    with pytest.raises(BadInput, match="'trajectory_strat'; did you mean 'trajectory_start'"):
        read(message)


def test_parts_and_bases_of_a_start_that_are_not_read_stand_in_the_headline(tmp_path):
    joints = {"name": ["shoulder"], "position": [0.1]}
    base = {"joint_names": ["world_joint"], "transforms": [{"translation": {"x": 0.5}}]}
    start = {"joint_state": joints, "multi_dof_joint_state": base}
    start["attached_collision_objects"] = [{"link_name": "tool", "object": {"id": "part"}}]
    case = load(tmp_path, displayed(plan(point(1.0, 0.1)), start))
    (told,) = (one for one in notices_of(case) if one.kind == "columns")
    left_out = ("multi_dof_joint_state", "attached_collision_objects")
    assert told.text.endswith(": " + ", ".join(f"trajectory_start.{one}" for one in left_out))


UNREAD = [
    ("header", {"frame_id": "base", "stamp": {"sec": 3, "nanosec": 0}}, "header.frame_id 'base'"),
    ("path_tolerance", [{"name": "shoulder", "position": 0.1}], "path_tolerance"),
    ("model_id", "arm", "model_id 'arm'"),
    ("goal_time_tolerance", {"sec": 1, "nanosec": 0}, "goal_time_tolerance"),
    ("header", {"frame_id": "", "stamp": {"sec": 3, "nanosec": 0}}, None),
    ("pose", {"orientation": {"x": 0.0, "y": 0.0, "z": 0.0, "w": 1.0}}, None),
]


@pytest.mark.parametrize(("key", "value", "named"), UNREAD)
def test_what_a_message_says_beside_its_points_is_named(key, value, named):
    trajectory = plan(point(0.0, 0.1), point(1.0, 0.2))
    for message in ({key: value, "trajectory": trajectory}, trajectory | {key: value}):
        notes = read(message).notes
        assert notes == (
            (f"path.json: fields beside the points, not read: {named}",) if named else ()
        )


@pytest.mark.parametrize("key", ["multi_dof_joint_trajectory", "multi_dof_trajectory"])
@pytest.mark.parametrize("depth", [0, 1, 2])
def test_what_a_base_does_beside_is_refused_at_any_depth(key, depth):
    """A base that moves is never left out, wherever the message has it."""
    base = {"joint_names": ["world_joint"], "points": [{"time_from_start": 0.0}]}
    message = {"trajectory": plan(point(0.0, 0.1), point(1.0, 0.2)), key: base}
    for _ in range(depth):
        message = {"goal": message}
    where = "goal." * depth
    with pytest.raises(BadInput, match=rf"{where}{key}: 1 points of joints with several degrees"):
        read(message)

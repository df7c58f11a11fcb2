"""Bags in all three containers: what was planned, what was done, which topic, and nothing but our own errors."""

import re
from pathlib import Path

import pytest

from clearance import check
from clearance.cli import run
from clearance.errors import BadInput, BadShape, BadTime, NotFinite
from clearance.formats.schema.timed import Choice
from clearance.formats.timed_files import load_trajectory
from clearance.report.motion_file import motion_content
from tests.formats.making import write_case
from tests.formats.making_case import TWO_JOINTS, changed
from tests.formats.refusal import refusal

pytest.importorskip("rosbags", reason="bags are made by rosbags")

from tests.examples import first_fast
from tests.formats.making_bags import (
    CONTAINERS,
    EVENT,
    displayed,
    goal,
    goal_event,
    planned,
    state,
    without_definitions,
    write_bag,
)

MOVE = planned([0.1, 0.0], [0.3, 0.05])
STATES = [state(i, [0.1 * i, 0.0]) for i in range(3)]


def read(path: Path, **choice):
    return load_trajectory(path, Choice(**choice))


@pytest.mark.slow
@pytest.mark.parametrize("container", CONTAINERS)
def test_of_several_topics_one_is_chosen_and_comes_back(tmp_path, container):
    path = write_bag(tmp_path, container, {"/plan": [MOVE, MOVE], "/joint_states": STATES})
    told = refusal(read, path, of=BadInput)
    assert "several topics: /joint_states (JointState), /plan (Joint" in told
    done, notes = read(path, topic="/joint_states")
    assert done.times.tolist() == [0.0, 1.0, 2.0]
    assert done.positions.tolist() == [[0.0, 0.0], [0.1, 0.0], [0.2, 0.0]]
    assert done.velocities is None
    assert "recorded joint states: joints move linearly between them" in notes[0]
    assert "the file holds 2 trajectories" in refusal(read, path, topic="/plan", of=BadInput)
    planned, _ = read(path, topic="/plan", which=2)
    assert planned.joint_names == ("shoulder", "lift")
    assert planned.times.tolist() == [0.0, 1.1]
    assert planned.positions.tolist() == [[0.1, 0.0], [0.3, 0.05]]
    assert planned.velocities.tolist() == [[0.0, 0.5], [0.0, 0.5]]
    assert "did you mean '/plan'" in refusal(read, path, topic="/plam", of=BadInput)
    told = refusal(read, path, topic="/joint_states", which=1, of=BadInput)
    assert "'which' says nothing about recorded joint states" in told
    told = refusal(read, path, topic="/plan", units={"angle": "deg"}, of=BadInput)
    assert "'units' says nothing about messages in a bag" in told and "convert` makes" in told


@pytest.mark.parametrize("container", first_fast(CONTAINERS[1:], 1))
def test_a_message_of_moveit_brings_its_definition(tmp_path, container):
    path = write_bag(tmp_path, container, {"/display": [displayed(MOVE)]})
    assert read(path).trajectory.positions.tolist() == [[0.1, 0.0], [0.3, 0.05]]
    path = write_bag(tmp_path / "more", container, {"/display": [displayed(MOVE, MOVE)]})
    assert "holds 2 trajectories: 1: trajectory[0].joint_trajectory, 2 points" in refusal(
        read, path, of=BadInput
    )


def test_a_goal_of_an_action_is_a_topic_in_ros_1(tmp_path):
    path = write_bag(tmp_path, "bag", {"/arm/follow_joint_trajectory/goal": [goal(MOVE)]})
    assert read(path).trajectory.positions.tolist() == [[0.1, 0.0], [0.3, 0.05]]


@pytest.mark.slow
@pytest.mark.parametrize("container", CONTAINERS[1:])
def test_a_goal_of_an_action_is_an_event_in_ros_2(tmp_path, container):
    """Client and server tell of one goal, and of its response, which holds none."""
    topic = "/arm/follow_joint_trajectory/_action/send_goal/_service_event"
    other = planned([0.2, 0.0], [0.4, 0.0], [0.5, 0.0])
    events = [goal_event(1, MOVE), goal_event(1, MOVE), goal_event(1)]
    path = write_bag(tmp_path / "one", container, {topic: events})
    assert read(path).trajectory.positions.tolist() == [[0.1, 0.0], [0.3, 0.05]]
    path = write_bag(tmp_path / "two", container, {topic: [*events, goal_event(2, other)]})
    assert "holds 2 trajectories" in refusal(read, path, of=BadInput)
    assert read(path, which=2).trajectory.n_steps == 3
    assert re.search(f"{topic.split('_')[0]}", refusal(read, path, topic="/arm", of=BadInput))
    assert EVENT.endswith("_SendGoal_Event")


def test_a_message_without_a_stamp_begins_as_it_is_received(tmp_path):
    """What MoveIt shows is not followed then."""
    topics = {"/plan": [MOVE, MOVE], "/display": [displayed(MOVE)]}
    path = write_bag(tmp_path, "mcap", topics)
    assert read(path, topic="/plan", which=2).trajectory.began == 2.0
    assert read(path, topic="/display").trajectory.began is None


@pytest.mark.slow
def test_a_bag_without_definitions_is_read_by_ours(tmp_path):
    bag = without_definitions(write_bag(tmp_path / "a", "rosbag2 sqlite3", {"/plan": [MOVE]}))
    assert read(bag).trajectory.n_steps == 2
    bag = write_bag(tmp_path / "b", "rosbag2 sqlite3", {"/display": [displayed(MOVE)]})
    trajectory, _ = read(without_definitions(bag))
    assert trajectory.positions.tolist() == [[0.1, 0.0], [0.3, 0.05]]


@pytest.mark.parametrize("container", CONTAINERS)
def test_drivers_that_tell_of_different_joints_are_put_together(tmp_path, container):
    """Each joint has its own samples exactly, and lies straight between them at the other's times."""
    arm = [state(2 * i, [float(i), 1.0 - i]) for i in range(16)]
    grip = [state(2 * i + 1, [0.01 * i], ["finger"]) for i in range(15)]
    mixed = [one for pair in zip(arm, grip, strict=False) for one in pair] + [arm[-1]]
    trajectory, notes = read(write_bag(tmp_path, container, {"/joint_states": mixed}))
    assert trajectory.joint_names == ("shoulder", "lift", "finger")
    assert trajectory.times.tolist() == list(range(29))
    shoulder, lift, finger = trajectory.positions.T
    assert shoulder.tolist() == [0.5 * i for i in range(1, 30)]
    assert (shoulder + lift == 1.0).all() and finger[::2].tolist() == [0.01 * i for i in range(15)]
    assert finger[1] == pytest.approx(0.005, abs=1e-17)
    assert any("2 messages at the ends are left out" in note for note in notes)


@pytest.mark.slow
@pytest.mark.parametrize("container", CONTAINERS)
def test_joints_of_a_topic_that_is_not_chosen_stand_in_the_headline(tmp_path, container):
    """The case may say otherwise of them than the robot did; joints of other robots are not meant."""
    topics = {"/arm": [state(i, [0.1 * i], ["shoulder"]) for i in range(3)]}
    topics["/same"] = topics["/arm"]
    others = [state(i, [1.0], ["elsewhere"]) for i in range(150)]  # before the lift's driver starts
    topics["/lift"] = [*others, state(150, [0.02], ["lift"])]
    topics["/plan"] = [MOVE]
    bag = write_bag(tmp_path, container, topics)
    unread = ("elsewhere, lift of topic /lift", "lift of topic /plan")
    assert read(bag, topic="/arm").trajectory.unread == unread
    assert read(bag, topic="/plan").trajectory.unread == ()
    named = changed("file: path.csv", f"file: {bag.relative_to(tmp_path)}, topic: /arm")
    warned = check(write_case(tmp_path, named, urdf=TWO_JOINTS)).verdict.warnings
    assert any("not read: lift of topic /lift, lift of topic /plan" in one for one in warned)


def test_states_that_do_not_follow_each_other_are_refused(tmp_path):
    bag = write_bag(tmp_path / "a", "mcap", {"/joint_states": [STATES[1], STATES[0]]})
    with pytest.raises(BadTime, match=r"message 2: its time is not later than .* cut the bag"):
        read(bag)
    twice = write_bag(tmp_path / "twice", "mcap", {"/joint_states": [STATES[0], STATES[0]]})
    with pytest.raises(BadTime, match="if a message was recorded twice, leave out one of the two"):
        read(twice)
    other = state(3, [0.0], ["gripper"])
    bag = write_bag(tmp_path / "b", "mcap", {"/joint_states": [*STATES, other]})
    assert "joint 'gripper' is known from 3 s on, 'shoulder' until 2 s" in refusal(
        read, bag, of=BadInput
    )
    for names in (["shoulder", "lift", "x"], ["shoulder", "shoulder"]):
        bag = write_bag(
            tmp_path / names[-1], "mcap", {"/joint_states": [state(0, [0.0, 1.0], names)]}
        )
        assert "message 1: 2 positions of shoulder, " in refusal(read, bag, of=BadShape)


def test_a_case_names_a_bag(tmp_path, capsys):
    bag = write_bag(
        tmp_path,
        "rosbag2 sqlite3",
        {"/s": [state(i, [0.1 * i, 0.0, 7.0], ["shoulder", "lift", "x"]) for i in range(3)]},
    )
    case = write_case(tmp_path, changed("file: path.csv", f"file: {bag.name}"), urdf=TWO_JOINTS)
    record = check(case).record
    assert len(record.clearances) == 3
    assert any("joints that cannot be set are left out: x" in note for note in record.case.notes)
    assert {source.path for source in record.case.sources} >= {f"{bag.name}/metadata.yaml"}
    capsys.readouterr()
    assert run(["convert", str(bag), str(tmp_path / "out.csv")]) == 0
    warned = capsys.readouterr().err
    assert warned.startswith("warning: out.csv: the first sample is stamped ")
    assert "checks no longer see that another recording begins at another time" in warned
    inside = bag / "metadata.yaml"
    before = inside.read_bytes()
    assert run(["convert", str(bag), str(inside), "--force"]) == 2
    assert "which this run reads" in capsys.readouterr().err and inside.read_bytes() == before
    write_case(tmp_path, changed("file: path.csv", f"file: {bag.name}, topic: /t"), urdf=TWO_JOINTS)
    capsys.readouterr()
    assert run(["check", str(case)]) == 2
    told = capsys.readouterr().err.strip()
    assert f"{bag.name}: the bag has no trajectories or joint states of topic '/t'" in told
    assert told.count("\n") == 0


@pytest.mark.parametrize("container", CONTAINERS)
def test_messages_without_a_stamp_are_of_the_time_of_their_receipt(tmp_path, container):
    bare = [state(None, [0.1 * i, 0.0]) for i in range(3)]
    trajectory, notes = read(write_bag(tmp_path, container, {"/joint_states": bare}))
    assert trajectory.times.tolist() == [0.0, 1.0, 2.0]
    assert any("3 of 3 messages have no stamp: the time of receipt is used" in n for n in notes)


@pytest.mark.parametrize("container", first_fast(CONTAINERS, 2))
def test_positions_that_are_no_numbers_are_left_out_by_message_and_joint(tmp_path, container):
    """The lift is not known at 0 s, the shoulder not at 10 s: it goes straight from 9 to 11 s."""
    states = [[0.1 * i, 0.01 * i] for i in range(21)]
    states[0][1], states[10][0] = float("nan"), float("inf")
    messages = [state(i, row) for i, row in enumerate(states)]
    trajectory, notes = read(write_bag(tmp_path, container, {"/joint_states": messages}))
    assert trajectory.times.tolist() == list(range(20))
    assert trajectory.positions[0].tolist() == [0.1, 0.01]
    assert trajectory.positions[9] == pytest.approx([1.0, 0.1], abs=1e-15)
    told = "positions that are NaN or infinite are left out: 'shoulder' in message 11, 'lift' in message 1"
    assert any(note.endswith(told) for note in notes)
    hole, before = trajectory.holes
    assert (before.joints, before.means) == (("lift",), "not_measured")
    assert (hole.joints, hole.start, hole.end) == (("shoulder",), 8.0, 10.0)


def test_a_recording_of_which_an_end_is_not_known_is_not_converted(tmp_path, capsys):
    """The lift's driver stops at 19 s, and the shoulder goes on: a table would end there, as if all did."""
    states = [state(i, [0.1 * i], ["shoulder"]) for i in range(21)]
    states += [state(i, [0.01 * i], ["lift"]) for i in range(20)]
    bag = write_bag(tmp_path, "mcap", {"/joint_states": states})
    assert run(["convert", str(bag), str(tmp_path / "out.csv")]) == 2
    told = capsys.readouterr().err
    assert "no position of lift from 19 to 20 s" in told and "out.csv leaves it out" in told
    assert not (tmp_path / "out.csv").exists()
    text = changed("file: path.csv", f"file: {bag.relative_to(tmp_path)}")
    found = check(write_case(tmp_path, text, urdf=TWO_JOINTS))
    (note,) = motion_content(found.record.motions, "out.csv").notes
    assert note.endswith("out.csv leaves it out")


def test_a_joint_without_any_number_is_refused(tmp_path):
    messages = [state(i, [0.1 * i, float("nan")]) for i in range(3)]
    path = write_bag(tmp_path, "mcap", {"/joint_states": messages})
    assert "no message has a finite position of joint 'lift'" in refusal(read, path, of=NotFinite)

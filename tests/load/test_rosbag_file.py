"""Bags in all three containers: what was planned, what was done, which topic, and nothing but our own errors."""

from pathlib import Path

import pytest

from clearance import check
from clearance.cli import run
from clearance.errors import BadInput, BadShape, BadTime, ClearanceError
from clearance.load.timed_files import load_trajectory
from clearance.load.trajectory_request import Choice
from tests.load.making import write_case
from tests.load.making_case import TWO_JOINTS, changed

pytest.importorskip("rosbags", reason="bags are made by rosbags")

from tests.examples import some_slow
from tests.load.making_bags import CONTAINERS, displayed, planned, state, write_bag

MOVE = planned([0.1, 0.0], [0.3, 0.05])
STATES = [state(i, [0.1 * i, 0.0]) for i in range(3)]


def read(path: Path, **choice):
    return load_trajectory(path, Choice(**choice))


@pytest.mark.parametrize("container", CONTAINERS)
def test_what_was_planned_comes_back(tmp_path, container):
    path = write_bag(tmp_path, container, {"/plan": [MOVE]})
    trajectory, _ = read(path)
    assert trajectory.joint_names == ("shoulder", "lift")
    assert trajectory.times.tolist() == [0.0, 1.1]
    assert trajectory.positions.tolist() == [[0.1, 0.0], [0.3, 0.05]]
    assert trajectory.velocities.tolist() == [[0.0, 0.5], [0.0, 0.5]]


@pytest.mark.parametrize("container", CONTAINERS)
def test_what_was_done_comes_back(tmp_path, container):
    trajectory, notes = read(write_bag(tmp_path, container, {"/joint_states": STATES}))
    assert trajectory.times.tolist() == [0.0, 1.0, 2.0]
    assert trajectory.positions.tolist() == [[0.0, 0.0], [0.1, 0.0], [0.2, 0.0]]
    assert trajectory.velocities is None
    assert "recorded joint states: joints move linearly between them" in notes[0]


@pytest.mark.parametrize("container", CONTAINERS)
def test_of_several_topics_one_is_chosen(tmp_path, container):
    path = write_bag(tmp_path, container, {"/plan": [MOVE, MOVE], "/joint_states": STATES})
    with pytest.raises(
        BadInput, match=r"several topics: /joint_states \(JointState\), /plan \(Joint"
    ):
        read(path)
    assert read(path, topic="/joint_states").trajectory.n_steps == 3
    with pytest.raises(BadInput, match="the file holds 2 trajectories"):
        read(path, topic="/plan")
    assert read(path, topic="/plan", which=2).trajectory.n_steps == 2
    with pytest.raises(BadInput, match="did you mean '/plan'"):
        read(path, topic="/plam")
    with pytest.raises(BadInput, match="'which' says nothing about recorded joint states"):
        read(path, topic="/joint_states", which=1)
    with pytest.raises(BadInput, match="'units' says nothing about messages in a bag"):
        read(path, topic="/plan", units=("deg", "m"))


@pytest.mark.parametrize("container", CONTAINERS[1:])
def test_a_message_of_moveit_brings_its_definition(tmp_path, container):
    path = write_bag(tmp_path, container, {"/display": [displayed(MOVE)]})
    assert read(path).trajectory.positions.tolist() == [[0.1, 0.0], [0.3, 0.05]]
    path = write_bag(tmp_path / "more", container, {"/display": [displayed(MOVE, MOVE)]})
    with pytest.raises(
        BadInput, match=r"holds 2 trajectories: 1: trajectory\[0\].joint_trajectory, 2 points"
    ):
        read(path)


def test_states_that_do_not_follow_each_other_are_refused(tmp_path):
    bag = write_bag(tmp_path / "a", "mcap", {"/joint_states": [STATES[1], STATES[0]]})
    with pytest.raises(BadTime, match="message 2: its time is not after"):
        read(bag)
    other = state(3, [0.0], ["gripper"])
    bag = write_bag(tmp_path / "b", "mcap", {"/joint_states": [*STATES, other]})
    with pytest.raises(BadShape, match="message 4: 1 positions of gripper; those of the first"):
        read(bag)


@pytest.mark.parametrize("container", some_slow(CONTAINERS, {"rosbag2 sqlite3", "rosbag2 mcap"}))
def test_a_bag_cut_off_is_refused_in_one_line_or_is_read(tmp_path, container):
    path = write_bag(tmp_path, container, {"/joint_states": STATES})
    file = max(path.iterdir(), key=lambda one: one.stat().st_size) if path.is_dir() else path
    data = file.read_bytes()
    for end in range(0, len(data), max(1, len(data) // 150)):
        file.write_bytes(data[:end])
        try:
            assert read(path).trajectory.n_steps <= 3
        except ClearanceError as error:
            assert "\n" not in str(error)


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
    assert run(["convert", str(bag), str(tmp_path / "out.csv")]) == 0
    write_case(tmp_path, changed("file: path.csv", f"file: {bag.name}, topic: /t"), urdf=TWO_JOINTS)
    capsys.readouterr()
    assert run(["check", str(case)]) == 2
    told = capsys.readouterr().err.strip()
    assert f"{bag.name}: the bag has no trajectories or joint states of topic '/t'" in told
    assert told.count("\n") == 0

"""`clearance convert` of trajectories and poses: what is written is read back bit for bit."""

from __future__ import annotations

import json
from io import BytesIO
from pathlib import Path

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from clearance.cli import run
from clearance.errors import BadInput, BadTime
from clearance.formats.known_formats import Kind, suffixes_written
from clearance.formats.motion.pose_writer import written_poses
from clearance.formats.motion.requests import (
    PoseRequest,
    PoseSamples,
    parse_trajectory,
    read_samples,
)
from clearance.formats.motion.trajectory_writer import written
from clearance.world.trajectory import Trajectory
from tests.examples import examples
from tests.formats.making_messages import MESSAGE, ROS2, dumped
from tests.formats.motion.test_poses_in_files import STAMPED, pose


def convert(*arguments: object) -> int:
    return run(["convert", *map(str, arguments)])


NUMBERS = st.floats(-1e3, 1e3)
TIMES = st.lists(st.integers(-(10**12), 10**13), min_size=1, max_size=5, unique=True)


@examples(60)
@given(st.data(), TIMES, st.sampled_from(suffixes_written(Kind.TRAJECTORY)), st.booleans())
def test_any_trajectory_comes_back_bit_for_bit(data, nanoseconds, suffix, moving):
    times = np.array([whole / 10**9 for whole in sorted(nanoseconds)])
    names = data.draw(
        st.lists(
            st.sampled_from(["a", "b c", "é", '"', "x,y", "1", "~", "#"]), min_size=1, unique=True
        )
    )
    rows = st.lists(NUMBERS, min_size=len(names), max_size=len(names))
    table = [np.array([data.draw(rows) for _ in times]) for _ in range(1 + moving)]
    if suffix == ".csv" and names[0] == "#":
        names = names[::-1]
    trajectory = Trajectory(times, tuple(names), *table)
    content, notes = written(trajectory, f"path{suffix}")
    back = parse_trajectory(content, f"path{suffix}")
    assert back.joint_names == trajectory.joint_names and not notes
    assert back.times.tobytes() == times.tobytes()
    assert back.positions.tobytes() == table[0].tobytes()
    assert back.velocities is None or back.velocities.tobytes() == table[1].tobytes()


def test_times_that_are_no_whole_nanoseconds_are_told(tmp_path, capsys):
    (tmp_path / "a.csv").write_text("time,a\n0,0\n0.3333333333333333,1\n")
    assert convert(tmp_path / "a.csv", tmp_path / "b.yaml") == 0
    assert "note: b.yaml: 1 of 2 times are rounded to nanoseconds" in capsys.readouterr().out
    near = Trajectory(np.array([0.0, 1e-10]), ("a",), np.zeros((2, 1)))
    with pytest.raises(BadTime, match="less than a nanosecond"):
        written(near, "b.yaml")
    zero = Trajectory(np.array([-0.0, 1.0]), ("a",), np.zeros((2, 1)))
    assert written(zero, "b.yaml").notes == ()
    assert parse_trajectory(written(near, "b.csv").content, "b.csv").times.tolist() == [0.0, 1e-10]


def test_a_name_that_ends_in_a_unit_is_told_where_no_robot_says_whose_it_is(tmp_path, capsys):
    (tmp_path / "a.csv").write_text("time,a [deg],b_deg\n0,0,0\n1,90,45\n")
    assert convert(tmp_path / "a.csv", tmp_path / "b.yaml") == 0
    told = capsys.readouterr().out
    assert "read in degrees: 'a'" in told
    assert "read in rad or m, whatever the name ends in: 'b_deg'" in told


ATTACHED = """
trajectory:
- joint_trajectory:
    joint_names: [x]
    points:
    - {positions: [0.0], time_from_start: {sec: 0, nanosec: 0}}
    - {positions: [0.2], time_from_start: {sec: 2, nanosec: 0}}
trajectory_start:
  joint_state: {name: [x], position: [0.0]}
  attached_collision_objects: [{link_name: tool, object: {id: part}}]
"""
OFF = ATTACHED.replace("position: [0.0]", "position: [0.3]")
LATE = """
joint_names: [x]
points:
- {positions: [0.0], time_from_start: {sec: 1, nanosec: 0}}
- {positions: [0.2], time_from_start: {sec: 2, nanosec: 0}}
"""


@pytest.mark.parametrize(
    ("name", "given", "target", "says"),
    [
        ("a.yaml", ATTACHED, "b.csv", "trajectory_start.attached_collision_objects"),
        ("a.yaml", LATE, "b.csv", "how the robot comes to its first point at 1 s"),
        ("a.yaml", OFF, "b.yaml", "trajectory_start has joint 'x' 0.3 rad or m off it"),
        ("a.csv", "time,a [deg],b [deg]\n0,0,0\n1,0.5,1.5\n", "b.csv", "all angles are within 6.28"),
    ],
)  # fmt: skip
def test_a_motion_of_which_samples_do_not_say_all_is_refused(
    tmp_path, monkeypatch, refusal, name, given, target, says
):
    monkeypatch.chdir(tmp_path)
    (tmp_path / name).write_text(given)
    told = refusal("convert", name, target)
    assert says in told and "name the file itself in a case" in told


@pytest.mark.parametrize("name", ["a [deg]", "time", "b/velocity", "x\ty;z"])
def test_names_that_a_table_would_read_otherwise_are_refused(name):
    trajectory = Trajectory(np.arange(2.0), (name,), np.ones((2, 1)))
    if name != "x\ty;z":
        with pytest.raises(BadInput, match=r"b\.csv"):
            written(trajectory, "b.csv")
        assert written(trajectory, "b.yaml").content


def test_one_of_several_is_chosen(tmp_path):
    (tmp_path / "a.yaml").write_text(ROS2 + dumped(MESSAGE).replace("shoulder", "elbow") + "\n")
    assert convert(tmp_path / "a.yaml", tmp_path / "b.csv", "--which", 2) == 0
    assert (tmp_path / "b.csv").read_text().startswith("time,elbow,lift,")


@pytest.mark.parametrize(
    ("arguments", "says"),
    [
        (["a.yaml", "b.csv"], "b.csv: already exists; --force overwrites it"),
        (["a.yaml", "a.yaml", "--force"], "would overwrite"),
        (
            ["a.yaml", "c.txt"],
            "no suffix to write for a trajectory; one of .csv, .json, .yaml, .yml",
        ),
        (["a.yaml", "c.csv", "--which", "3"], "which is 3, the file holds 1"),
    ],
)
def test_the_command_line_says_it_in_one_line(tmp_path, monkeypatch, refusal, arguments, says):
    monkeypatch.chdir(tmp_path)
    (tmp_path / "a.yaml").write_text(ROS2)
    (tmp_path / "b.csv").write_text("mine")
    assert says in refusal("convert", *arguments)
    assert convert("a.yaml", "b.csv", "--force") == 0
    assert (tmp_path / "b.csv").read_text() != "mine"


SUFFIXES = suffixes_written(Kind.POSES)
TABLE = (
    "time,x,y,z,qx,qy,qz,qw\n"
    "0.0,4.0,0.1,0.30000000000000004,0.0,0.0,0.0,1.0\n"
    "0.4,4.0,0.5,-0.0,0.18257418583505536,0.3651483716701107,0.5477225575051661,0.7302967433402214\n"
    "1.0,4.0,1.0,1e-07,0.0,0.0,1.0,0.0\n"
)


@pytest.fixture(autouse=True)
def here(tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)


def samples_in(content: bytes, name: str) -> PoseSamples:
    return read_samples(PoseRequest(lambda: BytesIO(content)), name).samples


def test_frames_and_stamps_are_kept_between_messages_and_told_of_tables(capsys):
    Path("a.yaml").write_text(STAMPED)
    assert convert("a.yaml", "b.json") == 0
    assert convert("b.json", "c.yaml") == 0
    back = samples_in(Path("c.yaml").read_bytes(), "c.yaml")
    assert (back.frame, back.child, back.stamp) == ("map", "", 1_700_000_000_100_000_000)
    capsys.readouterr()
    assert convert("c.yaml", "d.csv") == 0
    told, warned = capsys.readouterr()
    assert "in frame 'map', taken for what the poses are seen from" in told
    assert "d.csv: the poses are in frame 'map', which a table cannot say" in told
    assert warned.startswith("warning: d.csv: the first sample is stamped 1700000000.1 s, which it")
    assert "`start:`" in warned
    assert convert("d.csv", "e.yaml") == 0
    assert "e.yaml: frame_id is empty" in capsys.readouterr().out


def test_a_frame_that_may_move_is_not_lost_in_a_table(refusal):
    Path("a.yaml").write_text(STAMPED.replace("map", "wrist_camera"))
    assert convert("a.yaml", "b.json") == 0
    told = refusal("convert", "b.json", "c.csv")
    assert "b.json: the poses are in frame 'wrist_camera', which a table cannot say" in told
    assert "on: wrist_camera" in told


def test_transforms_stay_transforms(capsys):
    where = {
        "translation": {"x": 1.0, "y": 0, "z": 0},
        "rotation": {"x": 0, "y": 0, "z": 0, "w": 1},
    }
    moved = [pose(0.0, t) | {"child_frame_id": "door", "transform": where} for t in (1, 2)]
    Path("a.json").write_text(json.dumps({"transforms": moved}))
    assert convert("a.json", "b.yaml") == 0
    back = samples_in(Path("b.yaml").read_bytes(), "b.yaml")
    assert (back.frame, back.child, back.times.tolist()) == ("map", "door", [0.0, 1.0])
    assert convert("b.yaml", "c.csv") == 0
    told = capsys.readouterr().out
    assert "the poses are those of frame 'door', which a table cannot say" in told


def test_times_that_messages_keep_otherwise_are_told(refusal, capsys):
    rows = TABLE.replace("0.4,", "0.3333333333333333,").replace("\n0.0,", "\n0.25,")
    Path("a.csv").write_text(rows)
    assert convert("a.csv", "b.yaml") == 0
    told = capsys.readouterr().out
    assert "note: b.yaml: 1 of 3 times are rounded to nanoseconds" in told
    assert "count from their first, here at 0.25 s: moves: {file: …, start: 0.25}" in told
    assert convert("b.yaml", "c.csv") == 0
    assert Path("c.csv").read_text().splitlines()[2].startswith("0.083333333,4.0")
    Path("a.csv").write_text(TABLE.replace("0.4,", "1e-10,"))
    assert "less than a nanosecond after the one before" in refusal("convert", "a.csv", "d.yaml")


LATER_TIMES = st.lists(st.integers(1, 10**13), max_size=4, unique=True)
QUATERNIONS = st.tuples(*[st.floats(-1, 1)] * 4).filter(lambda q: np.linalg.norm(q) > 0.1)


@examples(60)
@given(
    st.data(),
    LATER_TIMES,
    st.sampled_from(SUFFIXES),
    st.sampled_from(["", "map", "a: b", "~", "1"]),
)
def test_any_poses_come_back_bit_for_bit(data, nanoseconds, suffix, child):
    times = np.array([whole / 10**9 for whole in (0, *sorted(nanoseconds))])
    positions = np.array([[data.draw(NUMBERS) for _ in "xyz"] for _ in times])
    turned = np.array([data.draw(QUATERNIONS) for _ in times])
    turned /= np.linalg.norm(turned, axis=1)[:, None]
    stamp = 0 if suffix == ".csv" else 17_000_000_000
    names = ("", "") if suffix == ".csv" else ("o'e", child)
    samples = PoseSamples(times, positions, turned, *names, stamp)
    content, notes = written_poses(samples, f"door{suffix}")
    back = samples_in(content, f"door{suffix}")
    assert not notes and (back.frame, back.child, back.stamp) == (*names, stamp)
    for one, other in (
        (back.times, times), (back.positions, positions), (back.quaternions, turned),
    ):  # fmt: skip
        assert one.tobytes() == other.tobytes()


@pytest.mark.parametrize(
    ("words", "says"),
    [
        (["a.yaml", "b.csv", "--topic", "/a"], "a.yaml: --topic says nothing about a table of poses"),
        (["far.csv", "b.yaml"], "far.csv: line 4: a position is 1e+160 m away"),
        (["off.yaml", "b.csv"], "off.yaml: the quaternion"),
    ],
)  # fmt: skip
def test_a_mistake_about_poses_is_one_line(refusal, words, says):
    Path("a.yaml").write_text(STAMPED)
    Path("off.yaml").write_text(STAMPED.replace("w: 1.0", "w: 0.5"))
    Path("far.csv").write_text(TABLE.replace("1e-07", "1e160"))
    assert says in refusal("convert", *words)


def test_a_table_of_places_without_turns_is_told_to_be_of_joints(tmp_path, capsys):
    (tmp_path / "a.csv").write_text("time,x,y,z\n0,0,0,0\n1,1,0,0\n")
    assert convert(tmp_path / "a.csv", tmp_path / "b.yaml") == 0
    assert "x, y and z are joints; poses also need qx, qy, qz, qw" in capsys.readouterr().out

"""`clearance convert`: what is written is read back bit for bit, nothing is overwritten unasked."""

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from clearance.cli import run
from clearance.errors import BadInput, BadTime
from clearance.formats.known_formats import Kind, suffixes_written
from clearance.formats.motion.requests import parse_trajectory
from clearance.formats.motion.trajectory_writer import written
from clearance.world.trajectory import Trajectory
from tests.examples import examples
from tests.formats.making_messages import MESSAGE, ROS2, dumped


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


def test_a_late_first_point_stays_one_in_a_message(tmp_path):
    (tmp_path / "a.yaml").write_text(LATE)
    assert convert(tmp_path / "a.yaml", tmp_path / "b.json") == 0
    assert parse_trajectory((tmp_path / "b.json").read_bytes(), "b.json").has_way_in


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

"""Columns of tables as logs have them: called otherwise, of joints that follow others, of no joint at all."""

import numpy as np
import pytest

from clearance.errors import (
    BadInput,
    BadPose,
    BadShape,
    BadSyntax,
    BadTime,
    DuplicateName,
    MissingKey,
    UnknownJoint,
)
from clearance.geometry.pose import pose_from_quaternion, pose_from_rpy
from clearance.world.plausible_motion import notices_on_motion
from tests.formats.making import ARM
from tests.formats.making_case import TWO_JOINTS, changed, load_small
from tests.formats.motion.test_joint_tables import read
from tests.formats.refusal import refusal

ABOVE, BLANKS = "above the header, passed over:", "columns are separated by tabs or blanks"

WAYS = [
    ("Time,shoulder,lift\n0,1,2\n1,3,4\n", []),
    ("t,shoulder,lift\n0,1,2\n1,3,4\n", ["column 't' is taken for time"]),
    ("t_ms,shoulder,lift\n0,1,2\n1000,3,4\n", ["column 't_ms' is taken for time", "read in milliseconds: 'time'"]),
    (
        "timestamp_ns,shoulder,lift\n0,1,2\n1000000000,3,4\n",
        ["column 'timestamp_ns' is taken for time", "read in nanoseconds: 'time'"],
    ),
    ("time_us,shoulder,lift\n0,1,2\n1000000,3,4\n", ["read in microseconds: 'time'"]),
    ("% time shoulder lift\n0 1 2\n1 3 4\n", [BLANKS]),
    ("# run 7\n# of arm\ntime,shoulder,lift\n0,1,2\n1,3,4\n", [f"{ABOVE} 'run 7', 'of arm'"]),
    ("\ufeff# run 7, 1 kHz\n\n#time,shoulder,lift\n0,1,2\n1,3,4\n", [f"{ABOVE} 'run 7, 1 kHz'"]),
    (
        "% run; 7\ntime;shoulder;lift\n0;1,0;2\n1;3;4\n",
        [f"{ABOVE} 'run; 7'", "columns are separated by semicolons, decimals written with commas"],
    ),
    ("time,shoulder/position,lift/position\n0,1,2\n1,3,4\n", []),
    ("time shoulder   lift\n0 1 2\n 1 3 4 \n\n", [BLANKS]),
    ("# t shoulder lift\r\n0.0 1 2\r\n1.0 3 4\r\n", [BLANKS, "column 't' is taken for time"]),
    (
        "time\tshoulder\tlift\n0\t1,0\t2\n1\t3\t4,0\n",
        ["columns are separated by tabs or blanks, decimals written with commas"],
    ),
    ("time,shoulder,lift,\n0,1,2,\n1,3,4,\n", ["the empty column at the end is left out"]),
    ("time,shoulder,lift\n0,1,2,\n1,3,4,\n", ["the empty column at the end is left out"]),
]  # fmt: skip


@pytest.mark.parametrize(("text", "notes"), WAYS)
def test_headers_of_other_programs_are_taken(text, notes):
    trajectory, told = read(text)
    assert trajectory.joint_names == ("shoulder", "lift")
    assert trajectory.times.tolist() == [0.0, 1.0]
    assert trajectory.positions.tolist() == [[1, 2], [3, 4]]
    assert list(told) == [f"path.csv: {note}" for note in notes]


def test_a_joint_that_is_called_t_is_no_time():
    with pytest.raises(MissingKey, match="no column 'time'"):
        read("t,shoulder\n0,1\n", {"t": True, "shoulder": True})


@pytest.mark.parametrize(
    ("text", "fault", "says"),
    [
        ("t,timestamp,shoulder\n0,1,2\n", MissingKey, "'t', 'timestamp' could each be it; did you mean 't'?"),
        ("0,1,2\n1,3,4\n", MissingKey, "'0,1,2', begins with a number: there is no header; joints: [the names"),
        (",time,shoulder\n0,0,1\n", BadSyntax, "column 1 of the header has no name"),
        ("time,shoulder,\n0,1,\n1,2\n", BadShape, "line 3: 2 columns; the header has 3"),
        ("# run 7\n\n#\ntime,shoulder\n0,1\n1,2,3\n", BadShape, "line 6: 3 columns; the header has 2"),
        ("# run 7\n# time shoulder\n0 1\n1 x\n", BadSyntax, "line 4: 'x' in column 'shoulder' is not a number"),
    ],
)  # fmt: skip
def test_what_could_be_meant_otherwise_is_refused(text, fault, says):
    assert says in refusal(read, text, of=fault)


@pytest.mark.parametrize(
    ("header", "columns"),
    [
        ("sec,nanosec", ""),
        ("sec,nanosec", "time: sec"),
        ("header.stamp.secs,header.stamp.nsecs", "time: header.stamp.secs"),
        ("seconds,nanos", "time: seconds"),
        ("sec,usec", "time: sec"),
        ("sec [s],nanosec [ns]", ""),
    ],
)
def test_half_of_a_time_is_no_time(tmp_path, header, columns):
    """The second row is 10 ms before the third, and not a second."""
    table = f"{header},shoulder\n0,0,0\n1,990000000,0.1\n2,0,0.2\n"
    said = f"path.csv, columns: {{{columns}, shoulder: shoulder}}" if columns else "path.csv"
    first, second = header.split(",")
    line = refusal(load_small, tmp_path, changed("path.csv", said), trajectory=table, of=BadTime)
    told = line
    assert f"'{first}' and '{second}' are a time together; a column time [s] in their place" in told


def test_a_time_beside_a_stamp_in_two_columns_is_taken(tmp_path):
    table = "__time,sec,nanosec,shoulder\n0,5,0,0\n0.5,5,500000000,0.1\n"
    said = "path.csv, columns: {time: __time, shoulder: shoulder}"
    case = load_small(tmp_path, changed("path.csv", said), trajectory=table)
    assert case.robots[0].trajectory.times.tolist() == [0.0, 0.5]


NOT_TAKEN = [
    (",shoulder,lift", '{time: "(column 1)", shoulder: shoulder, lift: lift}'),
    ("__time,/js/lift/position,/js/lift/effort,/js/shoulder/position",
     "{time: __time, shoulder: /js/shoulder/position, lift: /js/lift/position}"),
    ("time_from_start,shoulder,lift", "{time: time_from_start, shoulder: shoulder, lift: lift}"),
    ("time,shoulder,Lift", "{time: time, shoulder: shoulder, lift: Lift}"),
    ("time,shoulder,lift,shoulder_velocity,vel_lift", "{time: time, shoulder: shoulder, lift: lift, "
     "shoulder/velocity: shoulder_velocity, lift/velocity: vel_lift}"),
    ("time,shoulder,lift,shoulder/velocity,lift/velocity,shoulder/effort,lift/effort",
     "[time, shoulder, lift, shoulder/velocity, lift/velocity]"),
]  # fmt: skip


@pytest.mark.parametrize(("header", "hint"), NOT_TAKEN)
def test_each_error_on_a_header_has_columns_that_can_be_pasted(tmp_path, header, hint):
    n = header.count(",")
    log = f"{header}\n" + "".join(
        ",".join([str(i), *[repr(0.01 * i)] * n]) + "\n" for i in range(3)
    )
    with pytest.raises((UnknownJoint, MissingKey)) as caught:
        load_small(tmp_path, urdf=TWO_JOINTS, trajectory=log)
    assert f"columns: {hint} " in str(caught.value)
    case = changed("path.csv", f"path.csv, columns: {hint}")
    asked = load_small(tmp_path, case, urdf=TWO_JOINTS, trajectory=log).robots[0].trajectory
    assert sorted(asked.joint_names) == ["lift", "shoulder"] and asked.n_steps == 3


def test_an_unknown_column_is_told_by_what_it_looks_like(tmp_path):
    for name, meant in (
        ("Lift", "lift"),
        ("shoulder_speed", "shoulder/velocity"),
        ("dshoulder", "shoulder/velocity"),
    ):
        with pytest.raises(UnknownJoint, match=f"unknown joint '{name}'; did you mean '{meant}'"):
            load_small(tmp_path, urdf=TWO_JOINTS, trajectory=f"time,shoulder,{name}\n0,0,0\n")
    with pytest.raises(
        UnknownJoint, match="'lift/acceleration'; tables have positions and velocities"
    ):
        load_small(tmp_path, urdf=TWO_JOINTS, trajectory="time,shoulder,lift/acceleration\n0,0,0\n")


FASTER = "'shoulder_vel' (shoulder/velocity), 'shoulder_acc' (shoulder/acceleration)"


@pytest.mark.parametrize(
    ("columns", "left_out"),
    [
        ("[time, shoulder]", f"'Lift' (lift), {FASTER}"),
        ("{time: time, shoulder: shoulder, lift: Lift}", FASTER),
    ],
)
def test_columns_that_look_like_motion_and_are_left_out_stand_in_the_headline(
    tmp_path, columns, left_out
):
    table = "time,shoulder,Lift,shoulder_vel,shoulder_acc,lift_effort\n0,0,0,0,0,0\n1,0,0,0,0,0\n"
    case = changed("path.csv", f"path.csv, columns: {columns}")
    made = load_small(tmp_path, case, urdf=TWO_JOINTS, trajectory=table)
    (told,) = (one.text for one in notices_on_motion(made.robots[0]))
    assert told.endswith(
        "look like motion of robot 'arm', or parts that it holds, are not read: " + left_out
    )


def test_columns_of_a_base_that_moves_stand_in_the_headline_if_left_out(tmp_path):
    table = (
        "time,world/x,world/y,world/theta,tool/x,tool/y,shoulder\n0,0,0,0,0,0,0\n1,1,0,0,0,0,0\n"
    )
    case = changed("path.csv", "path.csv, columns: [time, shoulder]")
    unread = load_small(tmp_path, case, trajectory=table).robots[0].given_trajectory.unread
    assert unread == tuple(f"'world/{one}' (a base)" for one in ("x", "y", "theta"))


def test_columns_that_are_renamed_keep_the_unit_that_they_end_in():
    text = "stamp_ms,q0 [deg],q1_mm\n0,90,20\n1000,180,30\n"
    columns = {"time": "stamp_ms", "shoulder": "q0 [deg]", "lift": "q1_mm"}
    trajectory, _ = read(text, columns=columns)
    assert trajectory.times.tolist() == [0, 1]
    assert trajectory.positions == pytest.approx(np.array([[np.pi / 2, 0.02], [np.pi, 0.03]]))


@pytest.mark.parametrize(
    ("columns", "fault", "says"),
    [
        ("[time, sholder]", MissingKey, "'sholder', which `columns` names; did you mean 'shoulder'"),
        ("{time: time, lift: shoulder}", BadInput, "which has the name of joint 'shoulder', to 'lift'"),
        ("{time: time, shoulder: q, lift: q}", DuplicateName, "`columns` gives 'q' twice"),
        ("[shoulder]", MissingKey, "`columns` names no 'time'"),
        ("[]", BadInput, "trajectory.columns: [] is given; 1 values are needed"),
    ],
)  # fmt: skip
def test_columns_that_are_not_there_are_refused(tmp_path, columns, fault, says):
    with pytest.raises(fault) as caught:
        case = changed("path.csv", f"path.csv, columns: {columns}")
        load_small(tmp_path, case, urdf=TWO_JOINTS, trajectory="time,shoulder,q\n0,0,0\n")
    assert says in str(caught.value)


FINGERS = TWO_JOINTS.replace(
    "</robot>",
    '<link name="finger"/><joint name="other" type="prismatic"><parent link="upper"/>'
    '<child link="finger"/><mimic joint="lift" multiplier="-2" offset="0.01"/>'
    '<limit lower="-1" upper="1"/></joint></robot>',
)


def test_a_column_of_a_joint_that_follows_is_taken_where_it_agrees(tmp_path):
    rows = "time,shoulder,other [mm],lift\n0,0.1,-30.01,0.02\n1,0.2,-49.95,0.03\n"
    made = load_small(tmp_path, urdf=FINGERS, trajectory=rows)
    assert made.robots[0].trajectory.joint_names == ("shoulder", "lift")
    assert made.robots[0].trajectory.positions.tolist() == [[0.1, 0.02], [0.2, 0.03]]
    assert (
        "path.csv: columns of mimic joints agree with the joints that they follow: 'other'"
        in made.notes
    )
    off = rows.replace("-49.95", "-49.8")
    with pytest.raises(BadInput, match=r"'other' follows 'lift', and is 0\.0002 m off that at 1 s"):
        load_small(tmp_path, urdf=FINGERS, trajectory=off)
    alone = "time,other\n0,0.1\n"
    with pytest.raises(UnknownJoint, match="joint 'other' mimics 'lift' and cannot be set"):
        load_small(tmp_path, urdf=FINGERS, trajectory=alone)


FREE = ARM.replace('type="revolute"', 'type="floating"')
WAY = [
    (0.0, [0, 0, 1], [0, 0, 0, 1]),
    (1.0, [1, 0, 1], [0, 0, 0.6, 0.8]),
    (2.0, [1, 2, 1], [0.1, 0.2, 0.98**0.5 * 0.6, 0]),
    (3.0, [1, 2, 3], [0, 0, -0.6, 0.8]),
]


def logged(header, turned=lambda quaternion: quaternion):
    """The way as a log, its quaternions of length one but for `turned`."""
    rows = []
    for time, place, quaternion in WAY:
        unit = turned(np.array(quaternion) / np.linalg.norm(quaternion))
        rows.append(",".join(map(repr, [time, *place, *unit.tolist()])))
    return "\n".join([header, *rows, ""])


PARTS = [f"shoulder/{part}" for part in ("x", "y", "z", "qx", "qy", "qz", "qw")]


def test_a_free_base_may_be_logged_with_a_quaternion(tmp_path):
    made = load_small(tmp_path, urdf=FREE, trajectory=logged(",".join(["time", *PARTS])))
    trajectory = made.robots[0].trajectory
    parts = ("x", "y", "z", "yaw", "pitch", "roll")
    assert trajectory.joint_names == tuple(f"shoulder/{part}" for part in parts)
    for row, (_, place, quaternion) in zip(trajectory.positions, WAY, strict=True):
        unit = np.array(quaternion) / np.linalg.norm(quaternion)
        expected = pose_from_quaternion(place, unit)
        assert np.allclose(pose_from_rpy(row[:3], row[:2:-1]), expected, atol=1e-14)
    assert np.abs(np.diff(trajectory.positions[:, [3, 5]], axis=0)).max() <= np.pi
    assert any("quaternions of 'shoulder' are read as yaw, pitch and roll" in n for n in made.notes)


def test_quaternions_of_a_base_that_say_no_angles_are_refused(tmp_path):
    header = ",".join(["time", *PARTS])
    with pytest.raises(BadPose, match="line 2: the quaternion"):
        load_small(tmp_path, urdf=FREE, trajectory=logged(header, lambda q: 0.9 * q))
    up = np.array([0.0, 0.5**0.5, 0.0, 0.5**0.5])
    with pytest.raises(BadInput, match=r"line 2: 'shoulder' is pitched by 90\.0 degrees"):
        load_small(tmp_path, urdf=FREE, trajectory=logged(header, lambda q: up))

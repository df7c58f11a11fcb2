"""Tables of joints: columns by name, exact numbers, and as other programs write them; notes say how."""

from __future__ import annotations

import io
import math

import numpy as np
import pytest

from clearance import check
from clearance.errors import (
    BadDimension,
    BadInput,
    BadShape,
    BadSyntax,
    BadTime,
    DuplicateName,
    MissingKey,
    NotFinite,
)
from clearance.formats.motion.requests import TrajectoryRequest, parse_trajectory, read_trajectory
from clearance.formats.schema.timed import Choice
from tests.formats.making_case import TWO_JOINTS, changed, load_small
from tests.formats.refusal import refusal


def parse(text: str):
    return parse_trajectory(text.encode(), "path.csv")


PLAIN = [
    "time,b,a\n0,1,2\n1,3,4\n",
    "b,a,time\n1,2,0\n3,4,1\n",
    "b,time,a\r\n1,0,2\r\n3,1,4",
    "\n\nb, time ,a\n\n 1 , 0 , 2\n\n\n3,1,4\n\n",
    '\ufeff"b","time","a"\n"1","0","2"\n3,1,4\n',
    "time,b,a\n0,1e0,+2.0\n1,3.,4E+0\n",
]
WITH_VELOCITIES = [
    "time,b,a,b/velocity,a/velocity\n0,1,2,5,6\n1,3,4,7,8\n",
    "a/velocity,b,time,b/velocity,a\n6,1,0,5,2\n8,3,1,7,4\n",
    "time, b ,a, a/velocity ,b/velocity\r\n0,1,2,6,5\r\n1,3,4,8,7",
]


@pytest.mark.parametrize("text", PLAIN + WITH_VELOCITIES)
def test_columns_may_stand_anywhere_and_joints_keep_their_order(text):
    trajectory = parse(text)
    assert trajectory.joint_names == ("b", "a")
    assert trajectory.times.tolist() == [0, 1]
    assert trajectory.positions.tolist() == [[1, 2], [3, 4]]
    assert text in PLAIN or trajectory.velocities.tolist() == [[5, 6], [7, 8]]


def test_numbers_are_read_to_the_last_bit():
    values = np.random.default_rng(7).normal(size=300) * 10.0 ** np.arange(-150, 150)
    rows = "".join(f"{i},{value!r}\n" for i, value in enumerate(values.tolist()))
    assert parse("time,a\n" + rows).positions[:, 0].tolist() == values.tolist()


@pytest.mark.parametrize(
    ("text", "fault", "says"),
    [
        ("", BadSyntax, "path.csv: the file is empty"),
        ("time,a\n", BadShape, "no rows"),
        ("time\n0\n", BadShape, "no joint column"),
        ("a,b\n0,1\n", MissingKey, "no column 'time'"),
        ("time,a,a\n0,1,2\n", DuplicateName, "column 'a' is there twice"),
        ("time,,a\n0,1,2\n", BadSyntax, "column 2 of the header"),
        ("time,a\n0,1\n1\n", BadShape, "line 3: 1 columns; the header has 2"),
        ('time,a,b\n0,1,"x\n1,2,x\n2,3,x"\n', BadSyntax, "line 2: a quotation mark is not closed"),
        ("time,a\n0,1_0\n", BadSyntax, "'1_0' in column 'a'"),
        ("time;a\n0;1,5\n1;\x1c2,5\n", BadSyntax, r"line 3: '\x1c2,5' in column 'a'"),
        ("time,a\n0,1\n\n1,nan\n", NotFinite, "line 4: nan in column 'a'"),
        ("time,a\n0,1\n1,1\n\n1,2\n", BadTime, "line 5: time 1.0 follows 1.0"),
        ("time,arm,amr/velocity\n0,1,2\n", MissingKey, "'amr/velocity' is the velocity of 'amr'"),
        ("time,a,b,b/velocity\n0,1,1,1\n", MissingKey, "joint 'a' has no column 'a/velocity', joint 'b'"),
        ("time,a,a/velocity\n0,1,1\n1,1,1e200\n", BadDimension, "joint 'a' has a velocity"),
    ],
)  # fmt: skip
def test_each_fault_is_one_line_with_its_place(text, fault, says):
    said = refusal(parse, text, of=fault)
    assert says in said
    assert said.startswith("path.csv: ")


TURNS = {"shoulder": True, "lift": False}
DEGREES = {"angle": "deg", "length": "mm"}


def read(text: str | bytes, turns=TURNS, **choice):
    data = text.encode() if isinstance(text, str) else text
    request = TrajectoryRequest(lambda: io.BytesIO(data), choice=Choice(**choice), turns=turns)
    return read_trajectory(request, "path.csv")


DEG = math.pi / 180
WAYS = {
    "brackets": ("time [s],shoulder [deg],lift [mm]\n0,10,5\n1,20,7\n", {}),
    "endings": ("time_ms,shoulder_deg,lift_mm\n0,10,5\n1000,20,7\n", {}),
    "units": ("time,shoulder,lift\n0,10,5\n1,20,7\n", {"units": DEGREES}),
    "semicolons": ("time;shoulder [deg];lift\n0;10.0;0.005\n1;20;0.007\n", {}),
    "decimal commas": ("time;shoulder_deg;lift\n0;10,0;0,005\n1,0;2e1;7e-3\n", {}),
    "no header": ("0,10,5\n1,20,7\n", {"joints": ["shoulder_deg", "lift [mm]"]}),
    "time last": ("10,5,0\n20,7,1\n", {"joints": ["shoulder", "lift", "time"], "units": DEGREES}),
    "period": ("shoulder [deg],lift\n10,0.005\n20,0.007\n", {"period": 1.0}),
    "numbers alone": ("\n10;5\n\n20;7\n", {"joints": ["shoulder", "lift"], "period": 1.0, "units": DEGREES}),
}  # fmt: skip


@pytest.mark.parametrize("way", WAYS)
def test_every_way_gives_the_same_motion(way):
    text, choice = WAYS[way]
    trajectory, notes = read(text, **choice)
    assert trajectory.joint_names == ("shoulder", "lift")
    assert trajectory.times.tolist() == [0.0, 1.0]
    assert trajectory.positions.tolist() == [[10 * DEG, 0.005], [20 * DEG, 0.007]]
    assert any("in degrees: 'shoulder'" in note for note in notes)


def test_velocities_are_in_the_unit_of_their_joint_a_second():
    text = "time,shoulder [deg],shoulder/velocity [deg/s]\n0,10,90\n1,20,0\n"
    assert read(text).trajectory.velocities.tolist() == [[90 * DEG], [0.0]]
    text = "time,lift,lift/velocity\n0,10,90\n1,20,0\n"
    assert read(text, units=DEGREES).trajectory.velocities.tolist() == [[0.09], [0.0]]


def test_a_joint_that_is_called_so_is_that_joint():
    turns = {"shoulder_deg": True, "shoulder": True, "a [deg]": False}
    trajectory, notes = read("time,shoulder_deg,a [deg]\n0,1,2\n", turns)
    assert trajectory.joint_names == ("shoulder_deg", "a [deg]") and not notes
    assert trajectory.positions.tolist() == [[1, 2]]
    assert read("time,elbow_deg\n0,1\n").trajectory.joint_names == ("elbow_deg",)


@pytest.mark.parametrize(
    ("text", "choice", "fault", "says"),
    [
        ("time,shoulder [mm]\n0,1\n", {}, BadInput, "column 'shoulder [mm]' is an angle, not in mm; rad or deg"),
        ("time,shoulder,shoulder_deg\n0,1,2\n", {}, DuplicateName, "column 'shoulder' is there twice"),
        ("time,shoulder [deg],shoulder/velocity\n0,1,2\n", {}, BadInput, "units of both, or of none"),
        ("time;shoulder;lift\n0;1,5;2.5\n", {}, BadSyntax, "'2.5' in column 'lift' is not a number; decimals"),
        ("time,shoulder\n0,1\n", {"period": 0.1}, BadInput, "a column 'time', and a period of 0.1 s"),
        ("time,shoulder\n0,1\n", {"joints": ["shoulder"]}, BadSyntax, "line 1: 'time' in column 'time'"),
        ("0,1,2\n", {"joints": ["shoulder"]}, BadShape, "line 1: 3 columns; there are 2 names"),
        ("1\n2\n3\n", {"joints": ["shoulder"], "period": 1e308}, BadInput, "a time or a position is NaN"),
    ],
)  # fmt: skip
def test_each_fault_of_another_way_is_one_line_with_its_place(text, choice, fault, says):
    told = refusal(read, text, **choice, of=fault)
    assert says in told
    assert told.startswith("path.csv: ")


def as_case(folder, rows: str, given: str = "file: path.csv"):
    return load_small(folder, changed("file: path.csv", given), urdf=TWO_JOINTS, trajectory=rows)


def test_a_case_says_how_its_table_is_written(tmp_path):
    given = "file: path.csv, joints: [shoulder, lift], period: 0.5, units: {angle: deg, length: mm}"
    case = as_case(tmp_path, "10;5,0\n20;7,0\n", given)
    assert case.robots[0].trajectory.positions.tolist() == [[10 * DEG, 0.005], [20 * DEG, 0.007]]
    assert "path.csv: read in degrees: 'shoulder'; in millimetres: 'lift'" in case.notes
    plain = as_case(tmp_path, f"time,shoulder,lift\n0,{10 * DEG!r},0.005\n0.5,{20 * DEG!r},0.007\n")
    assert (check(case).record.clearances == check(plain).record.clearances).all()


def test_a_table_in_radians_that_is_read_in_degrees_is_odd():
    turns, units = {"a": True, "b": True}, {"angle": "deg"}
    table = "time,a,b\n0,0.3,{}\n1,1.0,-6.2\n".format
    (told,) = read(table(-1.5), turns, units=units)[0].odd
    assert "within 6.28 degrees of 0: is the table in radians" in told
    assert not read(table(-1.5), turns)[0].odd  # in radians, as it says
    assert not read(table(-6.3), turns, units=units)[0].odd
    assert not read(table(-1.5).replace("1.0,-6.2", "0.3,-1.5"), turns, units=units)[0].odd
    assert not read("time,a\n0,0.3\n1,1.0\n", turns, units=units)[0].odd

"""Poses as people have them: other units and separators in tables, stamped messages; each way told in a note."""

import json
import re
from io import BytesIO

import numpy as np
import pytest

import clearance as cl
from clearance.cli import run
from clearance.errors import BadInput, BadTime
from clearance.formats.motion.requests import PoseRequest, read_samples
from tests.formats.making_cell import DOOR, load_cell, write_cell
from tests.formats.refusal import refusal

STAMPED = """header:
  stamp:
    sec: 1700000000
    nanosec: 100000000
  frame_id: map
pose:
  position:
    x: 4.0
    y: 0.0
    z: 0.0
  orientation:
    x: 0.0
    y: 0.0
    z: 0.0
    w: 1.0
---
header:
  stamp:
    sec: 1700000001
    nanosec: 100000000
  frame_id: map
pose:
  position:
    x: 4.0
    y: 1.0
    z: 0.0
  orientation:
    x: 0.0
    y: 0.0
    z: 0.6
    w: 0.8
---
"""


def read(text: str | bytes, name: str = "door.yaml", length: str | None = None):
    data = text if isinstance(text, bytes) else text.encode()
    samples, notes = read_samples(PoseRequest(lambda: BytesIO(data), length), name)
    return samples.table(), notes


def pose(x: float, seconds: float, **changes):
    header = {"stamp": {"secs": int(seconds), "nsecs": 0}, "frame_id": "map"}
    where = {"position": {"x": x, "y": 0, "z": 0}, "orientation": {"x": 0, "y": 0, "z": 0, "w": 1}}
    return {"header": header, "pose": where} | changes


def test_a_table_in_other_units_with_semicolons_is_the_same_table():
    plain = read(DOOR, "door.csv")[0]
    rows = (
        "time [ms];x_mm;y [mm];z (mm);qx;qy;qz;qw\n"
        "0;4000;0;0;0;0;0;1\n400;4000;500;0;0;0;0,6;0,8\n1e3;4e3;1000;0;0;0;1;0\n"
    )
    table, notes = read(rows, "door.csv")
    assert np.array_equal(table.columns, plain.columns) and np.array_equal(table.times, plain.times)
    assert notes == (
        "columns are separated by semicolons, decimals written with commas",
        "read in millimetres: 'x', 'y', 'z'; in milliseconds: 'time'",
    )


@pytest.mark.parametrize(
    "header, said",
    [
        ("time,x,y,z,qx [deg],qy,qz,qw", "column 'qx [deg]' names a unit; a quaternion has none"),
        ("time,x [deg],y,z,qx,qy,qz,qw", "column 'x [deg]' is a length, not in deg"),
        ("time,x,x_mm,y,z,qx,qy,qz,qw", "column 'x' is there twice"),
    ],
)
def test_units_that_a_column_cannot_have_are_refused(header, said):
    with pytest.raises(BadInput, match=said.replace("[", r"\[").replace("]", r"\]")):
        read(f"{header}\n{','.join('0' * (header.count(',') + 1))}\n", "door.csv")


def test_stamped_poses_count_from_the_first():
    table, notes = read(STAMPED)
    assert table.times.tolist() == [0.0, 1.0]
    assert table.positions.tolist() == [[4, 0, 0], [4, 1, 0]]
    assert table.quaternions.tolist() == [[0, 0, 0, 1], [0, 0, 0.6, 0.8]]
    assert "2 stamped poses in frame 'map', taken for what the poses are seen from" in notes[0]


@pytest.mark.parametrize(
    ("frame", "on", "is_told"),
    [
        ("map", "", False),
        ("tip", "", True),
        ("camera", "", True),
        ("tip", ", on: left/tip", False),
        ("map", ", on: left/tip", True),
    ],
)
def test_poses_in_another_frame_than_the_case_reads_them_in_are_suspect(
    tmp_path, frame, on, is_told
):
    stamped = STAMPED.replace("frame_id: map", f"frame_id: {frame}")
    case = load_cell(tmp_path, "moves: door.csv", f"moves: door.yaml{on}", door__yaml=stamped)
    told = [one.text for one in case.notices if one.kind == "frame"]
    assert len(told) == is_told
    assert all(f"poses of obstacle 'door' are in frame {frame!r}" in text for text in told)


def test_paths_transforms_and_covariances_are_poses_too():
    stamped = [pose(1.0, 1), pose(2.0, 3)]
    path = {"header": {"frame_id": "map"}, "poses": stamped}
    covered = [one | {"pose": {"pose": one["pose"], "covariance": [0.0] * 36}} for one in stamped]
    moved = [
        {
            "header": one["header"],
            "child_frame_id": "door",
            "transform": {
                "translation": one["pose"]["position"],
                "rotation": one["pose"]["orientation"],
            },
        }
        for one in stamped
    ]
    expected = read("\n".join(map(json.dumps, stamped)), "a.json")[0]
    for given in ([path], covered, moved, [{"transforms": moved}]):
        found = read("\n".join(map(json.dumps, given)), "a.json")[0]
        assert np.array_equal(found.columns, expected.columns)
        assert found.times.tolist() == [0.0, 2.0]


@pytest.mark.parametrize(
    "messages, fault, said",
    [
        ([pose(0, 2), pose(1, 2)], BadTime, "message 2: header.stamp: its stamp is not after"),
        ([pose(0, 2), pose(1, 3, child_frame_id="b")], BadInput, "poses of '' and 'b'"),
        ([pose(0, 2, header={"frame_id": "a"})], BadTime, "message 1: header.stamp: None is given"),
        ([{"poses": [{"position": {"x": 1}}]}], BadInput, r"poses\[0\].*has no header"),
        ([[1]], BadInput, "a list of 1 is not a message"),
        ([pose(0, 2, offset=1)], BadInput, "message 1: unknown field 'offset'"),
        (
            [pose(0, 2) | {"pose": pose(0, 2)["pose"] | {"scale": 2}}],
            BadInput,
            "pose: unknown field 'scale'",
        ),
    ],
)
def test_what_is_no_motion_of_one_thing_is_refused(messages, fault, said):
    assert re.search(said, refusal(read, "\n".join(map(json.dumps, messages)), "a.json", of=fault))


def test_a_case_follows_stamped_poses_and_says_so(tmp_path, capsys):
    case = load_cell(tmp_path, "moves: door.csv", "moves: door.yaml", door__yaml=STAMPED)
    assert cl.check(case).record.steps.num_rows >= 3
    assert any("door.yaml: 2 stamped poses" in note for note in case.notes)
    assert case.obstacles[0].moves.began == pytest.approx(1700000000.1, abs=1e-6)
    write_cell(
        tmp_path,
        "moves: door.csv",
        "moves: {file: door.yaml, units: {length: mm}}",
        door__yaml=STAMPED,
    )
    assert run(["check", str(tmp_path / "case.yaml")]) == 2
    assert "'units' is given, and messages are in metres" in capsys.readouterr().err

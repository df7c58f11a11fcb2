"""Poses as people have them: tables in any units, stamped messages; no cut-off file is read otherwise."""

from __future__ import annotations

import io
import json
import re
from io import BytesIO

import numpy as np
import pytest

import clearance as cl
from clearance.cli import run
from clearance.errors import (
    BadInput,
    BadPose,
    BadShape,
    BadSyntax,
    BadTime,
    DuplicateName,
    MissingKey,
    NotFinite,
    UnknownKey,
)
from clearance.formats.motion.requests import PoseRequest, read_samples
from tests.formats.making_cell import DOOR, load_cell, write_cell
from tests.formats.refusal import refusal

TEXT = "time,x,y,z,qx,qy,qz,qw\n0,1,-2.5,3e-1,0,0,0,1\n1.5,0,0,0,0.6,0,0,0.8\n2,0,0,0.125,1,0,0,0\n"


def samples_of(text, name):
    data = text.encode()
    return read_samples(PoseRequest(lambda: io.BytesIO(data)), name)


def test_each_cut_is_refused_or_reads_whole_rows_or_shorter_numbers():
    whole = samples_of(TEXT, "door.csv").samples
    header = TEXT.index("\n") + 1
    for n in range(len(TEXT)):
        try:
            cut = samples_of(TEXT[:n], "door.csv").samples
        except BadInput:
            continue
        assert n > header
        rows = len(cut.times)
        assert np.array_equal(cut.times, whole.times[:rows])
        assert np.array_equal(cut.positions, whole.positions[:rows])
        assert np.abs(cut.quaternions - whole.quaternions[:rows]).max() < 1e-6


STAMPED = "".join(
    f"header:\n  stamp: {{sec: {1700000000 + i}, nanosec: 100000000}}\n  frame_id: map\npose:\n"
    f"  position: {{x: 4.0, y: {i}, z: 0.0}}\n  orientation: {{x: 0.0, y: 0.0, z: {z}, w: {w}}}\n---\n"
    for i, (z, w) in enumerate([(0.0, 1.0), (0.6, 0.8)])
)

DIGITS = (
    "time,x,y,z,qx,qy,qz,qw\n0,0,0,0,0,0,0,1\n1,0,0,0,0,0,0.707,0.707\n2,0,0,0,0.5,0.5,0.5,0.5\n"
)


@pytest.mark.parametrize(
    ("name", "text"),
    [("a.csv", DIGITS), ("a.yaml", STAMPED.replace("0.6", "0.707").replace("0.8", "0.707"))],
)
def test_quaternions_of_three_digits_are_made_of_length_one_with_a_note(name, text):
    samples, notes = samples_of(text, name)
    assert samples.table().quaternions[1].tolist() == pytest.approx(
        [0, 0, 0.5**0.5, 0.5**0.5], abs=1e-15
    )
    told = "1 quaternion is rounded to three digits or so and made of length 1"
    assert [note for note in notes if "rounded" in note] == [told]
    assert "0.98994" in refusal(samples_of, text.replace("0.707", "0.7"), name, of=BadInput)


HEADER = "time,x,y,z,qx,qy,qz,qw\n"
FIRST = HEADER + "0,0,0,0,0,0,0,1\n"


@pytest.mark.parametrize(
    ("table", "fault", "says"),
    [
        ("", BadSyntax, "the file is empty"),
        (HEADER, BadShape, "there are no rows"),
        (HEADER.replace(",qw", ""), MissingKey, "there is no column 'qw'"),
        (FIRST.replace("time", "when"), MissingKey, "there is no column 'time'"),
        (FIRST.replace("\n", ",w\n", 1), UnknownKey, "column 'w' is not of a table of poses"),
        (FIRST.replace("y", "x", 1), DuplicateName, "column 'x' is there twice"),
        (FIRST + "\n1,0,0,0,0,0,0.1,1\n", BadPose, "line 4: the quaternion [0.0, 0.0, 0.1, 1.0] has"),
        (HEADER + "0,0,0,0,1e200,0,0,1\n", BadPose, "line 2: the quaternion"),
        (FIRST + "0,0,0,0,0,0,0,1\n", BadTime, "line 3: time 0.0 follows 0.0"),
        (HEADER + "0,0,0,nan,0,0,0,1\n", NotFinite, "line 2: nan in column 'z'"),
        (HEADER + "0,0,0,1e160,0,0,0,1\n", BadPose, "line 2: a position is 1e+160 m away"),
        (HEADER + "0,0,0,0,0,0,0\n", BadShape, "line 2: 7 columns; the header has 8"),
        (HEADER + "0,0,0,a,0,0,0,1\n", BadSyntax, "line 2: 'a' in column 'z' is not a number"),
    ],
)  # fmt: skip
def test_faults_name_file_and_row(table, fault, says):
    assert refusal(samples_of, table, "door.csv", of=fault).startswith(f"door.csv: {says}")


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
    for messages in ([path], covered, moved, [{"transforms": moved}]):
        found = read("\n".join(map(json.dumps, messages)), "a.json")[0]
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
        ([pose(0, 2) | {"pose": pose(0, 2)["pose"] | {"scale": 2}}], BadInput, "pose: unknown field 'scale'"),
    ],
)  # fmt: skip
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

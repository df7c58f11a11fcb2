"""Tables of poses: columns by name, exact numbers, and no cut-off file that is read as something else."""

import io

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

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
from tests.formats.refusal import refusal

TEXT = "time,x,y,z,qx,qy,qz,qw\n0,1,-2.5,3e-1,0,0,0,1\n1.5,0,0,0,0.6,0,0,0.8\n2,0,0,0.125,1,0,0,0\n"


def read(text, name):
    data = text.encode()
    return read_samples(PoseRequest(lambda: io.BytesIO(data)), name)


def test_each_cut_is_refused_or_reads_whole_rows_or_shorter_numbers():
    whole = read(TEXT, "door.csv").samples
    header = TEXT.index("\n") + 1
    for n in range(len(TEXT)):
        try:
            cut = read(TEXT[:n], "door.csv").samples
        except BadInput:
            continue
        assert n > header
        rows = len(cut.times)
        assert np.array_equal(cut.times, whole.times[:rows])
        assert np.array_equal(cut.positions, whole.positions[:rows])
        assert np.abs(cut.quaternions - whole.quaternions[:rows]).max() < 1e-6


@given(st.lists(st.floats(-10, 10, allow_subnormal=False), min_size=4, max_size=4))
def test_a_quaternion_is_read_or_its_line_is_named(numbers):
    length = float(np.linalg.norm(numbers))
    cells = ",".join(map(repr, numbers))
    try:
        table = read(f"time,x,y,z,qx,qy,qz,qw\n0,0,0,0,{cells}\n", "a.csv").samples.table()
    except BadInput as error:
        assert "a.csv: line 2: the quaternion" in str(error) and abs(length - 1) > 0.9e-3
    else:
        assert np.abs(table.quaternions[0] * length - numbers).max() < 1e-12


DIGITS = (
    "time,x,y,z,qx,qy,qz,qw\n0,0,0,0,0,0,0,1\n1,0,0,0,0,0,0.707,0.707\n2,0,0,0,0.5,0.5,0.5,0.5\n"
)
STAMPED = "\n---\n".join(
    f"header: {{stamp: {{sec: {i}, nanosec: 0}}, frame_id: map}}\n"
    f"pose: {{position: {{x: 0, y: 0, z: 0}}, orientation: {{x: 0, y: 0, z: {z}, w: {w}}}}}"
    for i, (z, w) in enumerate([(0, 1), (0.707, 0.707)])
)


@pytest.mark.parametrize(("name", "text"), [("a.csv", DIGITS), ("a.yaml", STAMPED)])
def test_quaternions_of_three_digits_are_made_of_length_one_with_a_note(name, text):
    samples, notes = read(text, name)
    assert samples.table().quaternions[1].tolist() == pytest.approx(
        [0, 0, 0.5**0.5, 0.5**0.5], abs=1e-15
    )
    told = "1 quaternion is rounded to three digits or so and made of length 1"
    assert [note for note in notes if "rounded" in note] == [told]
    assert "0.98994" in refusal(read, text.replace("0.707", "0.7"), name, of=BadInput)


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
    assert refusal(read, table, "door.csv", of=fault).startswith(f"door.csv: {says}")

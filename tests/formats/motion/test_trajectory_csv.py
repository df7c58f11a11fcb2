"""CSV trajectories: columns by name, exact numbers, and the line of every fault."""

import numpy as np
import pytest

from clearance.errors import (
    BadDimension,
    BadShape,
    BadSyntax,
    BadTime,
    DuplicateName,
    MissingKey,
    NotFinite,
)
from clearance.formats.motion.requests import parse_trajectory
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

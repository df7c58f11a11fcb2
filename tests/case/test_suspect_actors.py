"""Wrong units of what moves, rides, or is one of several robots are told by name; right ones are not."""

import pytest

from clearance.world.plausibility import notices_of
from tests.formats.making import ARM
from tests.formats.making_cell import DOOR, load_cell

HEADER, *ROWS = DOOR.splitlines()


def table(length: float, time: float = 1.0) -> str:
    lines = [HEADER]
    for row in ROWS:
        t, x, y, z, *turn = row.split(",")
        moved = (str(float(t) * time), *(str(float(number) * length) for number in (x, y, z)))
        lines.append(",".join((*moved, *turn)))
    return "\n".join(lines) + "\n"


def told(folder, *changes, **files):
    return [notice.text for notice in notices_of(load_cell(folder, *changes, **files))]


def test_a_cell_in_metres_and_seconds_is_not_suspect(tmp_path):
    assert told(tmp_path) == []


def test_a_far_cell_whose_robots_stand_on_its_table_is_not_suspect(tmp_path):
    """All stands 500 m from the origin, the robots by way of what they are on."""
    changes = ("trajectory: path.csv", "base: {on: post}, trajectory: path.csv", "{xyz: [6", "{on: post, xyz: [6",
               "xyz: [2, 0, 2]", "xyz: [500, 0, 2]", "xyz: [2, 2, 0]", "xyz: [502, 2, 0]", "moves: door.csv",
               "on: post, moves: door.csv")  # fmt: skip
    assert told(tmp_path, *changes) == []


def test_a_table_in_millimetres(tmp_path):
    place, travel = told(tmp_path, door=table(1000.0))
    assert place.startswith("CHECK UNITS: obstacle 'door' stands 2993 m away from every robot's")
    assert travel.startswith("CHECK UNITS: obstacle 'door' moves 1000 m; lengths are in metres")


@pytest.mark.parametrize("turn", ["0,0,1,0", "0,0.707,-0.707,0.0005"])
def test_a_turn_by_half_a_turn_in_one_step_can_go_either_way(tmp_path, turn):
    door = f"{HEADER}\n0,4,0,0,0,0,0,1\n1,4,0,0,{turn}\n"
    (text,) = told(tmp_path, door=door)
    assert text == (
        "obstacle 'door' turns by half a turn in one step, from 0 to 1 s, and its table does not say which way "
        "round; give a row between"
    )
    between = door.replace("\n1,", "\n0.5,4,0,0,0,0,0.6,0.8\n1,").replace(
        "0,0.707,-0.707,0.0005", "0,0,1,0"
    )
    assert told(tmp_path, door=between) == []


@pytest.mark.slow
def test_a_table_in_milliseconds_unless_its_rate_says_so(tmp_path):
    slow = "path.csv", "{file: path.csv, after: loop}"
    (text,) = told(tmp_path, *slow, door=table(0.3, 1000.0))
    assert text.startswith("CHECK UNITS: obstacle 'door' moves no faster than 0.4 mm/s")
    assert told(tmp_path, "door.csv", "{file: door.csv, rate: 1000}", door=table(1.0, 1000.0)) == []


def test_a_robot_in_milliseconds_unless_its_rate_says_so(tmp_path):
    path = "time,shoulder\n0,0\n500,0.25\n1000,0.5\n"
    change = "limits:\n  fail: 0.005", "limits:\n  fail: 0.005"
    (text,) = told(tmp_path, *change, trajectory=path)
    assert "no joint of robot 'left' moves faster" in text
    assert told(tmp_path, "path.csv", "{file: path.csv, rate: 1000}", trajectory=path) == []


def test_joints_are_told_with_their_robot_even_where_it_stands(tmp_path):
    texts = told(
        tmp_path, "{shoulder: 0.2}", "{shoulder: 1.2}", trajectory="time,shoulder\n0,0\n2,1.1\n"
    )
    assert [text.split(" leaves")[0] for text in texts] == [
        "joint 'left/shoulder'",
        "joint 'right/shoulder'",
    ]


@pytest.mark.parametrize(
    ("changes", "says"),
    [
        (("fail: 0.001,", "fail: 1, warn: 2,"), "limits.rules[0].fail is 1 m and limits.rules[0].warn is 2 m"),
        (("name: post,", "name: post, padding: 2,"), "the padding of obstacle 'post' is 2 m; paddings are"),
        (("name: right,", "name: right, padding: {upper: 2},"), "the padding of link 'right/upper' is 2 m"),
    ],
)  # fmt: skip
def test_limits_and_paddings_in_millimetres(tmp_path, changes, says):
    (text,) = told(tmp_path, *changes)
    assert says in text


def test_what_a_file_of_two_robots_shows_is_told_once_with_both(tmp_path):
    turned = ARM.replace(
        '<origin xyz="0 0 0.1" rpy="0 0 0"/>', '<origin xyz="0 0 0.1" rpy="0 0 90"/>'
    )
    (text,) = told(tmp_path, urdf=turned)
    assert "90 rad" in text and text.endswith("(robot 'left', 'right')")

"""Input that is valid but looks wrong: what of a case's files becomes a notice, of which severity and kind."""

import numpy as np
import pytest

from clearance.errors import BadInput, BadPose
from clearance.formats.plausibility import odd_angles
from clearance.world.notice import KINDS, Severity
from clearance.world.plausibility import notices_of
from tests.formats.making import ARM
from tests.formats.making_case import CASE, TWO_JOINTS, changed, load_small, with_obstacle
from tests.formats.making_cell import DOOR, load_cell

FENCE = "v 0 0 0\nv 3000 0 0\nv 3000 0 2000\nv 0 0 2000\nf 1 2 3 4\n"
"""A fence of 3 m by 2 m, drawn in millimetres."""


def found(folder, case=CASE, **changes):
    """(severity, kind, text) of every notice of the small case, changed."""
    notices = notices_of(load_small(folder, case, **changes))
    return [(notice.severity, notice.kind, notice.text) for notice in notices]


FOLLOWS = '<mimic joint="shoulder" multiplier="0.3"/>'
MIMIC = TWO_JOINTS.replace('upper="0.1"/>', f'upper="0.1"/>{FOLLOWS}')
NOBODY_SAYS = TWO_JOINTS.replace('lower="0" upper="0.1"', 'lower="0.02" upper="0.1"')


@pytest.mark.parametrize(
    ("case", "urdf", "kinds", "says"),
    [
        (changed("arm.urdf", "arm.urdf, joints: {lift: 0.13}"), TWO_JOINTS, ["limits"], "0.03 m all the time"),
        (CASE, NOBODY_SAYS, ["rest", "limits"], "joint 'lift' leaves its limits 0.02 to 0.1 m by up to 0.02 m"),
        (CASE, MIMIC, ["limits"], "joint 'lift' leaves its limits 0 to 0.1 m by up to 0.05 m in 1 of 3 steps"),
    ],
    ids=["one that rests", "one that nobody gives", "one that follows"],
)  # fmt: skip
def test_a_joint_a_little_beyond_its_limits_is_a_warning(tmp_path, case, urdf, kinds, says):
    told = found(tmp_path, case, urdf=urdf)
    assert [(severity, kind) for severity, kind, _ in told] == [
        (Severity.WARNING, kind) for kind in kinds
    ]
    assert says in told[-1][2]


def test_kinds_of_suspect_input_are_accepted_by_name(tmp_path):
    assert load_small(tmp_path).accept == ()
    case = load_small(tmp_path, CASE + f"accept: [{', '.join(KINDS)}]\n")
    assert case.accept == KINDS
    with pytest.raises(BadInput, match=rf"accept\[1\]: 'unit' is given; .*{', '.join(KINDS)}"):
        load_small(tmp_path, CASE + "accept: [limits, unit]\n")


def turned_joint(old: str, new: str) -> dict[str, str]:
    """The small arm with something else in its URDF."""
    assert old in ARM
    return {"urdf": ARM.replace(old, new)}


@pytest.mark.parametrize(
    ("case", "files", "says"),
    [
        (changed("urdf: arm.urdf", "urdf: arm.urdf, base: {rpy: [0, 0, 90]}"), {}, "base has an angle of 90 rad"),
        (changed("urdf: arm.urdf", "urdf: arm.urdf, base: {xyz: [-1200, 0, 0]}"), {}, "base stands 1200 m away"),
        (changed("xyz: [1.2, 0, 0]", "rpy: [0, -45, 0]"), {}, "obstacle 'post' has an angle of 45 rad"),
        (with_obstacle("cylinder: {radius: 40, length: 1}"), {}, "obstacle 'post' has a radius of 40 m"),
        (with_obstacle("mesh: {file: fence.obj}"), {"fence__obj": FENCE}, "3000 m long where the robot reaches"),
        (CASE, turned_joint('xyz="0 0 0.1" rpy="0 0 0"', 'rpy="0 0 90"'), "'shoulder' has an angle of 90 rad"),
        (CASE, turned_joint('lower="-1" upper="1"', 'lower="-140" upper="140"'), "has a limit of 140 rad"),
        (CASE, turned_joint('xyz="0 0 0.5"', 'xyz="0 0 500"'), "shape of link 'upper' stands 500 m away"),
    ],
)  # fmt: skip
def test_what_stands_or_measures_in_other_units_is_suspect(tmp_path, case, files, says):
    told = [text for _, kind, text in found(tmp_path, case, **files) if kind == "units"]
    assert sum(says in text for text in told) == 1, told
    assert all(text.startswith("CHECK UNITS: ") for text in told)
    assert "fence__obj" not in files or "scale 0.001" in told[0]


def test_the_usual_is_not_suspect(tmp_path):
    floor = "  - {name: floor, pose: {xyz: [0, 0, -0.1]}, box: {size: [80, 80, 0.02]}}\n"
    pin = "  - {name: pin, pose: {xyz: [1, 0, 0]}, cylinder: {radius: 0.002, length: 0.03}}\n"
    case = CASE.replace("trajectory:", floor + pin + "trajectory:")
    turned = case.replace("xyz: [1.2, 0, 0]", "xyz: [1.2, 0, 0], rpy: [4.71, 6.2832, -5.1234567]")
    assert found(tmp_path, turned) == []
    hall = CASE.replace("xyz: [1.2, 0, 0]", "xyz: [112, 0, 0]")
    hall = hall.replace("urdf: arm.urdf", "urdf: arm.urdf, base: {xyz: [110.8, 0, 0]}")
    assert found(tmp_path, hall) == []


def test_time_in_milliseconds_is_suspect(tmp_path):
    path = "time,shoulder\n0,0\n500,0.25\n1000,0.5\n"
    ((_, _, text),) = found(tmp_path, trajectory=path)
    assert "is this milliseconds" in text
    assert found(tmp_path, trajectory="time,shoulder\n0,0\n50,0.25\n100,0.5\n") == []
    assert found(tmp_path, trajectory="time,shoulder\n0,0.5\n500,0.5\n1000,0.5\n") == []
    fast_for_once = "time,shoulder\n0,0\n500,0.25\n500.25,0.5\n"
    assert found(tmp_path, trajectory=fast_for_once) == []


def test_parts_of_a_turn_of_few_digits_are_no_degrees_and_others_may_be():
    for angle in (3.15, -3.15, 3.1, 4.7, 4.72, 6.3, 6.28):
        assert odd_angles("it", [0.0, angle, 0.0]) == []
    for angle in (3.2, 4, 4.6, 6.4, 315):
        assert odd_angles("it", [0, 0, angle]) == [f"it has an angle of {angle:g} rad in its rpy"]


def test_quaternions_of_three_digits_stand_in_a_case_with_a_note(tmp_path):
    quaternion = "quat_xyzw: [0, 0.707, 0, 0.707]"
    case = changed("xyz: [1.2, 0, 0]", f"xyz: [1.2, 0, 0], {quaternion}",
                   "arm.urdf", f"arm.urdf, base: {{{quaternion}}}")  # fmt: skip
    made = load_small(tmp_path, case)
    upright = [[0, 0, 1], [0, 1, 0], [-1, 0, 0]]
    for pose in (made.obstacles[0].world_from_body, made.robots[0].world_from_base):
        assert np.allclose(pose[:3, :3], upright, atol=1e-15)
    told = "1 quaternion is rounded to three digits or so and made of length 1"
    assert [note for note in made.notes if told in note] == [f"robot.base: {told}", told]
    with pytest.raises(BadPose, match=r"0\.98994"):
        load_small(tmp_path, case.replace("0.707", "0.7"))


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


def test_a_far_cell_whose_robots_stand_on_its_table_is_not_suspect(tmp_path):
    """All stands 500 m from the origin, the robots by way of what they are on."""
    changes = ("trajectory: path.csv", "base: {on: post}, trajectory: path.csv", "{xyz: [6", "{on: post, xyz: [6",
               "xyz: [2, 0, 2]", "xyz: [500, 0, 2]", "xyz: [2, 2, 0]", "xyz: [502, 2, 0]", "moves: door.csv",
               "on: post, moves: door.csv")  # fmt: skip
    assert told(tmp_path, *changes) == []


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
    text, loops = told(tmp_path, *slow, door=table(0.3, 1000.0))
    assert text.startswith("CHECK UNITS: obstacle 'door' moves no faster than 0.4 mm/s")
    assert "(after: loop) ends elsewhere" in loops
    assert told(tmp_path, "door.csv", "{file: door.csv, rate: 1000}", door=table(1.0, 1000.0)) == []


def test_a_robot_in_milliseconds_unless_its_rate_says_so(tmp_path):
    path = "time,shoulder\n0,0\n500,0.25\n1000,0.5\n"
    change = "limits:\n  fail: 0.005", "limits:\n  fail: 0.005"
    (text,) = told(tmp_path, *change, trajectory=path)
    assert "no joint of robot 'left' moves faster" in text
    assert told(tmp_path, "path.csv", "{file: path.csv, rate: 1000}", trajectory=path) == []


IN_MILLISECONDS = "time,shoulder\n0,0\n1000,0.5\n2000,9\n"
"""A robot's path that is faster than creeping."""


@pytest.mark.parametrize(
    ("files", "says"),
    [
        ({"door": table(1.0, 1000.0)}, "obstacle 'door' takes 1000 s, and moves no faster than "),
        ({"trajectory": IN_MILLISECONDS}, "robot 'left' takes 2000 s, and moves no faster than "),
    ],
)
def test_a_slow_table_that_takes_a_hundred_times_as_long_as_all_else(tmp_path, files, says):
    (text,) = [text for text in told(tmp_path, **files) if "takes" in text]
    assert text.startswith(f"CHECK UNITS: {says}")
    assert text.endswith("times are in seconds, is this milliseconds?")


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

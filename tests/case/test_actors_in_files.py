"""Case files of several robots, and of what moves, rides and is carried, mean what they say."""

import math

import numpy as np
import pytest

from clearance.errors import BadInput, UnknownLink
from clearance.world.carry import Carry
from clearance.world.case import Clock
from clearance.world.rules import Allowance, Rule
from clearance.world.timing import Timing, Window
from tests.formats.making import CASE
from tests.formats.making_case import changed, load_small
from tests.formats.making_cell import load_cell


def test_a_robot_may_stand_on_a_link_of_another(tmp_path):
    case = load_cell(tmp_path, "base: {xyz: [6", "base: {on: left/tip, xyz: [6")
    right = case.robots[1]
    assert right.mount.on == "left/tip" and right.mount.pose[:3, 3].tolist() == [6, 0, 0]
    assert np.array_equal(right.world_from_base, np.eye(4))


def test_carries_rules_allowances(tmp_path):
    case = load_cell(tmp_path)
    assert case.carries == (Carry("workpiece", "left/tip", Window(0.25, 0.75), ("left/*",)),)
    assert case.limits.rules == (
        Rule(("left/*", "fixture"), Window(0.5, 1), None, "at the fixture", 0.001),
        Rule(("workpiece", "*"), Window(), "workpiece", "workpiece - *", None, 0.03),
    )
    levels = [case.limits.of_rule(i) for i in (1, 2)]
    assert [(one.fail, one.warn) for one in levels] == [(0.001, 0.001), (0.005, 0.03)]
    assert case.allow == (
        Allowance(("left/base", "post")),
        Allowance(("door", "post"), Window(end=0.5)),
    )
    assert case.clock == Clock(0.0)


@pytest.mark.parametrize(
    ("given", "slack"),
    [("common", 0), ("unsynchronised", math.inf), ("{slack: 0.2}", 0.2), ("{slack: 0}", 0)],
)
def test_clocks(tmp_path, given, slack):
    assert load_small(tmp_path, CASE + f"clock: {given}\n").clock.slack == slack


TIMED = "trajectory: {file: path.csv, start: 0.5, rate: 2, after: loop}"


@pytest.mark.parametrize(
    "case",
    [
        changed("trajectory: {file: path.csv}", TIMED),
        changed("arm.urdf", f"arm.urdf, {TIMED}", "trajectory: {file: path.csv}\n", ""),
        changed("robot: {urdf: arm.urdf}", "robots: [{urdf: arm.urdf}]", "trajectory: {file: path.csv}", TIMED),
    ],
)  # fmt: skip
def test_a_trajectory_stands_at_the_top_or_in_its_robot(tmp_path, case):
    placed = load_small(tmp_path, case).robots[0]
    assert placed.timing == Timing(0.5, 2, "loop") and placed.given_trajectory.n_steps == 3


@pytest.mark.parametrize(
    "rows", ['"*": 0.001, up*: 0.003, base: 0', 'base: 0, up*: 0.003, "*": 0.001']
)
def test_a_link_has_its_own_padding_or_the_greatest_of_its_patterns(tmp_path, rows):
    keys = f"name: robo, padding: {{{rows}}}"
    placed = load_small(tmp_path, changed("urdf: arm.urdf", f"urdf: arm.urdf, {keys}")).robots[0]
    assert placed.robot.name == "robo"
    assert placed.padding == {"base": 0.0, "upper": 0.003, "tip": 0.001}


def test_notes_say_how_things_move(tmp_path):
    timing = "{file: door.csv, start: 0.25, rate: 2, after: %s}"
    notes = load_cell(tmp_path).notes
    assert notes == (
        "obstacle 'door' moves between the poses of its table by straight translation, and rotation about one "
        "axis at constant speed",
    )
    held = load_cell(tmp_path, "door.csv", timing % "hold").notes
    assert held[1:] == (
        "obstacle 'door' stands at its first sample until 0.25 s",
        "obstacle 'door' stands at its last sample from 0.75 s",
    )
    loops = load_cell(tmp_path, "door.csv", timing % "loop").notes
    assert (
        loops[2]
        == "obstacle 'door' goes through its table again and again, every 0.5 s (after: loop)"
    )
    absent = load_cell(tmp_path, "door.csv", timing % "absent").notes
    assert absent[1:] == (
        "obstacle 'door' is in the cell from 0.25 s to 0.75 s only (after: absent)",
    )


@pytest.mark.parametrize(
    ("after", "early"),
    [
        ("hold", "stands at its first sample until 0.25 s"),
        ("absent", "is in the cell from 0.25 s (after: absent)"),
    ],
)
def test_a_table_ends_where_its_part_is_picked_up(tmp_path, after, early):
    timing = f"{{file: door.csv, start: 0.25, rate: 2, after: {after}}}"
    carry = "  - {part: door, by: right/tip, from: 0.5}\nlimits:"
    notes = load_cell(tmp_path, "door.csv", timing, "limits:", carry).notes
    assert notes[1:] == (
        f"obstacle 'door' {early}",
        "obstacle 'door' follows its table until it is picked up at 0.5 s",
    )


def test_profiles_name_links_of_one_robot_or_of_several(tmp_path):
    sketch = (
        "points: {a: [-9, -9], b: [9, -9], c: [0, 9]}\n"
        "segments: {ab: [a, b], bc: [b, c], ca: [c, a]}\n"
    )
    profile = "profiles: [{name: zone, sketch: zone.yaml, links: [%s]}]\n"
    case = load_small(tmp_path, CASE + profile % "upper", zone__yaml=sketch)
    assert case.profiles[0].links == ("upper",)
    case = load_cell(tmp_path, "limits:", profile % "left/upper" + "limits:", zone__yaml=sketch)
    assert case.profiles[0].links == ("left/upper",)
    with pytest.raises(UnknownLink, match="did you mean 'left/upper'"):
        load_cell(tmp_path, "limits:", profile % "upper" + "limits:", zone__yaml=sketch)


def test_a_grasp_is_as_driven_unless_it_is_said_to_be_exact(tmp_path):
    (carry,) = load_cell(tmp_path).carries
    assert not carry.exact_grasp
    (carry,) = load_cell(tmp_path, 'touch: ["left/*"]}', "grasp: exact}").carries
    assert carry.exact_grasp
    with pytest.raises(BadInput, match="carry"):
        load_cell(tmp_path, 'touch: ["left/*"]}', "grasp: loose}")

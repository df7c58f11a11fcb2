"""From axes of a controller to joints, and from its base to the robot's root: values by hand."""

from __future__ import annotations

import math
import re
from dataclasses import replace

import numpy as np
import pytest

from clearance.formats.program.arc_turns import turn_on_path
from clearance.formats.program.controller_program import (
    AxisTarget,
    ControllerMove,
    ControllerProgram,
    ControllerWait,
    PoseTarget,
)
from clearance.formats.program.conversion import converted
from clearance.formats.program.tokens import Line
from clearance.formats.schema.program_file import ProgramFile
from clearance.formats.schema.strict_model import validated
from clearance.geometry.pose import pose_from_rpy
from clearance.world.robot import Joint, JointKind
from tests.formats.refusal import refusal
from tests.made_cases import at
from tests.programs.arms import arm

QUARTER = math.pi / 2
AXES = AxisTarget((0.1, 0.2, 0.3, 0.4, 0.5, 0.6), name="home")
HOME = ControllerMove(Line(3), "ptp", AXES, np.eye(4), share=0.5)
POSE = replace(HOME, to=PoseTarget(pose_from_rpy([0.5, 0.0, 0.3], [0.0, 0.0, 0.0])))


def made(*moves, start=(), robot=None, **asked):
    given = {"file": "weld.mod", "link": "tool_tip", **asked}
    given = {key: value for key, value in given.items() if value is not None}
    asked = validated(ProgramFile, given, "program")
    robot = robot or arm("heron6").robot
    return converted(ControllerProgram(moves), asked, robot, dict(start))


def test_joints_follow_axes_by_sign_offset_and_other_axes():
    axes = {
        "joint_2": {"offset": "-90deg", "sign": -1},
        "joint_3": {"plus": {2: 1.0}},
        "joint_6": {"axis": 5},
        "joint_5": {"axis": 6},
    }
    (move,) = made(HOME, axes=axes).program.moves
    joints = [0.1, -0.2 - QUARTER, 0.3 + 0.2, 0.4, 0.6, 0.5]
    assert list(move.ptp.joints.values()) == pytest.approx(joints, abs=1e-15)
    assert list(move.ptp.joints) == [f"joint_{i}" for i in range(1, 7)] and move.ptp.speed == 0.5


def test_a_pose_is_seen_from_the_controllers_base():
    target = PoseTarget(at(0.5, 0.0, 0.3), name="P1")
    line = ControllerMove(Line(7), "lin", target, at(0.0, 0.0, 0.1), speed=0.2, zone=0.01)
    base = {"on": "world", "xyz": [1.0, 2.0, 0.0], "rpy": ["-90deg", 0.0, "180 deg"]}
    on = replace(line, to=PoseTarget(at(0.6, 0.0, 0.3)))
    found = made(HOME, line, on, ControllerWait(Line(8), 0.5), line, line, base=base)
    turned = {**base, "rpy": [-QUARTER, 0.0, math.pi]}
    assert found.program.frames["controller"].model_dump(exclude_unset=True) == turned
    assert found.program.tool.xyz == [0.0, 0.0, 0.1] and found.program.tool.link == "tool_tip"
    lin = found.program.moves[1].lin
    assert (lin.to.frame, lin.to.xyz) == ("controller", [0.5, 0.0, 0.3])
    assert (lin.zone, lin.speed) == (0.01, 0.2)
    assert found.names[:4] == ("PTP 3 → home", "LIN 7 → P1", "LIN 7 (2)", "WAIT 8")
    assert found.places == ("line 3", "line 7", "line 7", "line 8", "line 7", "line 7")


def test_controllers_stop_where_no_way_follows():
    one = replace(POSE, kind="lin", zone=0.01)
    two = replace(one, to=PoseTarget(at(0.6, 0.0, 0.3)), line=Line(4))
    found = made(
        HOME, one, two, ControllerWait(Line(8), 0.5), one, two, replace(two, line=Line(5)), one
    )
    zones = [move.lin.zone for move in found.program.moves if move.lin]
    assert zones == [0.01, 0.0, 0.01, 0.0, 0.0, 0.0]
    turned = replace(
        two, to=PoseTarget(pose_from_rpy([0.6, 0.0, 0.3], [0.0, 0.0, 0.2])), line=Line(6)
    )
    for again in ([one, two, turned, one], [one, replace(two, zone=0.0), turned, one]):
        (told,) = [line for line in made(HOME, *again).assumed if "only turns" in line][:1]
        assert "the tool is taken to stop, and the controller may cut the corner" in told
    stops = [note for note in found.notes if "the tool stops" in note]
    assert [note.partition(":")[0] for note in stops] == ["line 4", "line 4", "line 5", "line 3"]


def test_a_corner_at_which_the_tool_changes_stands_in_the_headline():
    other = replace(POSE, to=PoseTarget(at(0.6, 0.0, 0.3)), tool=at(0, 0, 0.1), line=Line(4))
    found = made(HOME, replace(POSE, kind="lin", zone=0.01), replace(other, kind="lin"))
    assert [move.lin.zone for move in found.program.moves if move.lin] == [0.0, 0.0]
    text = "line 3: a corner zone, and line 4 has another tool: the tool is taken to stop, and the controller may"
    assert any(line.startswith(text) for line in found.assumed)


def test_a_corner_before_a_wait_that_begins_on_the_way_stands_in_the_headline():
    line = replace(POSE, kind="lin", zone=0.01)
    last = replace(line, zone=0.0)
    for reads_on in (False, True):
        found = made(HOME, line, ControllerWait(Line(8), 0.5, reads_on=reads_on), last)
        told = "line 3: a wait follows a corner zone: the tool is taken to stop"
        assert [one.split(",")[0] for one in found.assumed if "wait" in one] == [told] * reads_on
        assert any("no move follows" in note for note in found.notes) != reads_on


def test_points_whose_own_axes_are_elsewhere_contradict_the_axes_unless_one_confirms_them():
    """Axes beside several poses, or that are a target themselves, are a seed and contradict nothing."""
    one, link = arm("heron6"), {"base": {"on": "base"}, "axes_as": "plain"}
    near = (0.1, 0.2, 0.3, 0.4, 0.5, 0.6)
    there = one.poses(np.array([near]))[0] @ np.linalg.inv(one.link_from_tool)
    off = there.copy()
    off[:3, 3] += [0.0, 0.0, 0.11]
    far = replace(HOME, to=PoseTarget(off, near=near, name="P1"))
    start = dict.fromkeys((f"joint_{i}" for i in range(1, 7)), 0.0)
    (told,) = made(far, start=start, **link).contradicted
    assert told == (
        "line 3: the axes beside P1 have the tool 110 mm and 0 degrees from it, and no point confirms axes, base, "
        "link and tools"
    )
    true = replace(HOME, to=PoseTarget(there, near=near))
    home = replace(HOME, to=AxisTarget(near))
    for other in (true, home, replace(far, to=PoseTarget(there @ at(0.2, 0, 0), near=near))):
        assert not made(far, other, start=start, **link).contradicted


def test_a_link_called_base_is_the_controllers():
    robot = arm("heron6").robot
    turned = np.diag([-1.0, -1.0, 1.0, 1.0])
    joint = Joint("b", JointKind.FIXED, "base_link", "base", turned)
    robot = replace(robot, link_names=(*robot.link_names, "base"), joints=(*robot.joints, joint))
    found = made(HOME, robot=robot)
    assert found.program.frames["controller"].quat_xyzw == [0.0, 0.0, 1.0, 0.0]
    assert any("'base'" in note for note in found.notes)


def test_a_line_to_axes_ends_where_they_have_the_tool():
    line = replace(HOME, kind="lin", to=AxisTarget((0.0,) * 6), tool=at(0.0, 0.0, 0.1))
    to = made(HOME, line).program.moves[1].lin.to
    x = 0.3 + 0.22 + 0.088 + 0.15
    assert to.frame == "base" and to.xyz == pytest.approx([x, 0.0, 0.245 + 0.2 + 0.44 + 0.1])


def test_a_first_pose_begins_at_the_axes_beside_it_if_these_have_the_tool_there():
    one, near = arm("heron6"), (0.1, 0.2, 0.3, 0.4, 0.5, 0.6)
    tool = at(0.0, 0.05, 0.1)
    there = one.poses(np.array([near]))[0] @ np.linalg.inv(one.link_from_tool) @ tool
    asked = {"base": {"on": "base"}, "axes_as": "plain"}
    first = replace(HOME, to=PoseTarget(at(0.0, 0.0, 0.009) @ there, near=near), tool=tool)
    found = made(first, HOME, **asked)
    assert list(found.program.start.values()) == list(near) and found.starts_anywhere
    assert any("agree with the robot within 9 mm and 0 degrees" in note for note in found.notes)
    turned = there @ pose_from_rpy([0.0, 0.0, 0.0], [0.0, 0.0, 0.04])
    for pose, told in ((at(0.0, 0.0, 0.011) @ there, "11 mm and 0"), (turned, "0 mm and 2.29")):
        far = replace(first, to=PoseTarget(pose, near=near))
        match = f"ends at a pose, and the axes beside it have the tool .*{told} degrees from it"
        assert re.search(match, refusal(made, far, HOME, **asked))
    line = replace(first, kind="lin")
    assert "ends at a pose, and the joints at its beg" in refusal(made, line, HOME, **asked)


def test_another_tool_is_a_move_of_its_own():
    other = replace(POSE, tool=at(0.0, 0.0, 0.2), line=Line(9))
    found = made(HOME, POSE, other, HOME, other)
    assert found.program.tool.xyz == [0.0, 0.0, 0.0]
    assert [one.tool and one.tool.xyz for one in found.program.moves] == (
        [None, None, [0.0, 0.0, 0.2], None, None, None]
    )
    assert found.names[2:4] == ("TOOL line 9", "PTP 9") and found.places[2] == "line 9"


def turned(degrees: float, axis: int, x: float, y: float) -> np.ndarray:
    angles = [0.0, 0.0, 0.0]
    angles[axis] = math.radians(degrees)
    return pose_from_rpy([x, y, 0.0], angles)


HALF = math.sqrt(0.5)
ROUND = {
    "as it was": ((HALF, HALF), turned(0, 2, 0, 1), "to"),
    "with the path": ((HALF, HALF), turned(90, 2, 0, 1), "tangent"),
    "half with it": ((HALF, HALF), turned(45, 2, 0, 1), "to"),
    "three quarters with it": ((-1.0, 0.0), turned(270, 2, 0, -1), "tangent"),
    "tilted": ((HALF, HALF), turned(20, 0, 0, 1), "the tool tilts"),
    "tilted with the path": ((HALF, HALF), turned(90, 2, 0, 1) @ turned(9, 1, 0, 0), "the tool tilts"),
    "as it was, after three quarters": ((-1.0, 0.0), turned(0, 2, 0, -1), "seen along the arc, the tool"),
}  # fmt: skip


@pytest.mark.parametrize("case", ROUND)
def test_a_turn_seen_from_the_path_is_about_one_axis_or_refused(case):
    # from (1, 0) round the origin, counter-clockwise
    via, end, told = ROUND[case]
    start, through = turned(0, 2, 1, 0), np.array([*via, 0.0])
    if told in ("to", "tangent"):
        assert turn_on_path(start, through, end) == told
    else:
        assert re.search(told, refusal(turn_on_path, start, through, end))


def test_a_joint_move_has_the_time_or_the_speed_of_axes_that_it_states():
    (move,) = made(replace(HOME, share=None, axis_speed=0.8, axis_acceleration=0.7)).program.moves
    assert (move.ptp.joint_speed, move.ptp.joint_acceleration) == (0.8, 0.7)
    (move,) = made(replace(HOME, axis_speed=0.8, time=3.0)).program.moves
    assert move.ptp.time == 3.0 and move.ptp.joint_speed is None


def test_times_rest_on_accelerations_unless_all_moves_say_them_or_their_time():
    line = replace(POSE, kind="lin", acceleration=1.2)
    known = (
        replace(HOME, axis_speed=0.8, axis_acceleration=0.7),
        replace(line, acceleration=None, time=2.0),
        line,
    )
    assert not made(*known).is_rough
    assert made(HOME).is_rough and made(*known, replace(line, acceleration=None)).is_rough


@pytest.mark.parametrize(
    ("values", "told"),
    [
        ((1500.0, 1500.0), "external axis E1 is at 1500, and no joint follows it: it is taken to stand, and"),
        ((None, -90.0), "external axis E1 is at -90 in 1 of 3 targets alone, and no joint follows it"),
        ((0.0, 0.0), ""),
        ((None, 0.0), ""),
        ((None, None), ""),
    ],
)  # fmt: skip
def test_an_external_axis_that_stands_away_from_0_without_a_joint_is_told(values, told):
    ends = [{} if value is None else {"E1": value} for value in values]
    moves = [
        ControllerMove(Line(7), "lin", PoseTarget(at(0.5, 0.01 * i, 0.3), end), np.eye(4))
        for i, end in enumerate(ends)
    ]
    home = replace(HOME, to=replace(AXES, external=ends[0]))
    found = [one for one in made(home, *moves).assumed if "external axis" in one]
    assert len(found) == bool(told) and all(told in one for one in found)


def test_an_external_axis_that_moves_needs_a_joint():
    target = PoseTarget(at(0.5, 0.0, 0.3), {"E1": 0.0})
    one = ControllerMove(Line(7), "lin", target, np.eye(4))
    moved = replace(one, to=replace(target, external={"E1": 20.0}), line=Line(8))
    taught = replace(one, to=replace(target, external={"E1": 0.001}))
    assert made(HOME, one, taught).program.moves[1].lin.hold == {}
    assert "line 8: external axis E1 moves, and no joint" in refusal(made, HOME, one, moved)


def test_a_corner_where_the_tool_begins_is_none():
    first, line = (
        replace(HOME, zone=0.01),
        ControllerMove(Line(7), "lin", PoseTarget(at(0.5, 0.0, 0.3)), np.eye(4)),
    )
    found = made(first, line)
    assert found.program.moves[0].ptp.zone == 0.0 and any(
        "it begins there" in note for note in found.notes
    )
    start = {f"joint_{i}": 0.0 for i in range(1, 7)}
    assert made(first, line, start=start).program.moves[0].ptp.zone == 0.01


def test_a_line_may_keep_the_tool_as_it_is():
    line = ControllerMove(Line(7), "lin", PoseTarget(at(0.5, 0.0, 0.3)), np.eye(4))
    assert made(HOME, line).program.moves[1].lin.to.turns
    assert not made(HOME, replace(line, orientation="constant")).program.moves[1].lin.to.turns


def test_a_controller_whose_base_is_not_the_root_asks_for_it():
    robot = arm("heron6").robot
    asked = validated(ProgramFile, {"file": "a.ls", "link": "tool_tip"}, "program")
    line = ControllerMove(Line(7), "lin", PoseTarget(at(0.5, 0.0, 0.3)), np.eye(4))
    assert converted(ControllerProgram((HOME,), base="at axis 2"), asked, robot, {}).program.moves
    assert "base: at axis 2; where it is, seen from the robot's root, as" in refusal(
        converted, ControllerProgram((HOME, line), base="at axis 2"), asked, robot, {}
    )


@pytest.mark.parametrize(
    ("moves", "asked", "told"),
    [
        ([replace(HOME, to=AxisTarget((0.0,) * 7))], {}, "line 3: 7 axes are given"),
        ([replace(HOME, share=0.0)], {}, "line 3: ptp.speed: 0.0 is given"),
        ([POSE], {}, "line 3: the first move ends at a pose"),
        ([HOME], {"link": "tool"}, "link: there is no link 'tool'"),
        ([HOME], {"link": None}, "link: there is no link 'tool0'"),
        ([HOME], {"axes": {"joint_9": {}}}, "axes: unknown joint 'joint_9'"),
        ([HOME], {"axes": {"joint_1": {"axis": 2}, "joint_2": {"axis": 2}}}, "each of 1 to 6 once"),
        ([HOME], {"axes": {"joint_1": {"axis": "E1"}}}, "6 axes are given, and the arm has 5"),
        ([HOME], {"axes": {"joint_2": {"offset": "90 mm"}}}, "'90 mm' is given; a number, or degrees"),
        ([ControllerWait(Line(3), 1.0)], {}, "nothing moves"),
        ([HOME, replace(POSE, to=PoseTarget(at(4e8, 0, 0)))], {}, "line 3: a point 4e+08 m away"),
        ([HOME], {"link": "finger_left"}, "axes: joint 'finger_joint' slides, and axes are read as"),
    ],
)  # fmt: skip
def test_what_has_no_meaning_for_the_robot_is_refused_with_its_line(moves, asked, told):
    said = refusal(made, *moves, **asked)
    assert told in said
    assert "link" not in told or "line 3" not in said


def test_flags_that_nothing_checks_stand_in_the_headline():
    to = replace(POSE.to, unchecked="CONFIG F D B", is_behind=True, ranges={5: (0.0, 3.0)})
    told = (
        "configurations are not checked for CONFIG F D B, whether the wrist is before axis 1 and the upper arm: "
        "the nearest joints are taken, and the controller may take others"
    )
    found = made(HOME, replace(POSE, to=to), base={"on": "base"}, axes_as="plain")
    assert found.assumed == (told,) and not any("configurations" in note for note in found.notes)

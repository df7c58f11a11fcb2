"""How axes of makers' robots turn, and what flags of a wrist tell: by hand, of published robots, random."""

from __future__ import annotations

import itertools
import math
import re
from dataclasses import replace

import numpy as np
import pytest

from clearance.formats.program.controlled_arm import ControlledArm
from clearance.formats.program.controller_program import (
    AxisTarget,
    ControllerMove,
    ControllerProgram,
    PoseTarget,
)
from clearance.formats.program.conventions import CONVENTIONS
from clearance.formats.program.conversion import ConvertedProgram, converted
from clearance.formats.program.tokens import Line
from clearance.formats.schema.program_file import ProgramFile
from clearance.formats.schema.strict_model import validated
from clearance.geometry.pose import pose_from_rotation_vector, pose_from_rpy
from clearance.programs.arm import Arm
from clearance.programs.joint_way import JointWay
from clearance.programs.moves import JointMove
from clearance.world.kinematic_chain import chain_between
from clearance.world.robot import Joint, JointKind, Robot
from tests.formats.program.reading import read
from tests.formats.refusal import refusal

X, Y, Z = np.eye(3)
ABB = (Z, Y, Y, X, Y, X)
UP = ((0, 0, 0.3), (0.1, 0, 0), (0, 0, 0.7), (0.2, 0, 0.1), (0.4, 0, 0), (0.1, 0, 0))
"""The place of each joint from the one before: an upper arm that stands, and a forearm that lies."""

ARMS = {
    "abb": (ABB, UP),
    "fanuc": ((Z, Y, -Y, -X, -Y, -X), UP),
    "kuka": ((-Z, Y, Y, -X, Y, -X), (*UP[:2], (0.7, 0, 0), *UP[3:])),
    "ur": ((Z, -Y, -Y, -Y, -Z, -Y), (*UP[:2], (-0.4, 0, 0), (-0.4, 0, 0), (0, -0.1, 0), (0, 0, -0.1))),
}  # fmt: skip


def arm(axes, places, flange=(0.0, 0.0, 0.0), third=(-4.0, 4.0)) -> Robot:
    """Six joints, the third within limits, and a flange `tool0` that is turned as given."""
    links, joints = ("root", *(f"link_{i}" for i in range(1, 7)), "tool0"), []
    for i, (axis, place) in enumerate(zip(axes, places, strict=True), 1):
        limits = third if i == 3 else (-4.0, 4.0)
        named = f"joint_{i}", JointKind.REVOLUTE, *links[i - 1 : i + 1]
        joints.append(Joint(*named, _at(place), axis, *limits))
    end = Joint("end", JointKind.FIXED, "link_6", "tool0", pose_from_rpy([0.0] * 3, [*flange]))
    return Robot("arm", links, (*joints, end), ())


def _at(place) -> np.ndarray:
    return pose_from_rpy([*place], [0.0, 0.0, 0.0])


R2000 = (
    arm(
        ARMS["fanuc"][0],
        ((0, 0, 0), (0.312, 0, 0), (0, 0, 1.075), (0, 0, 0.225), (1.28, 0, 0), (0.27, 0, 0)),
        (math.pi, -math.pi / 2, 0.0),
    ),
    (7.962, -5.284, -36.25, 77.661, -51.975, -79.273),
)
"""An R-2000iB/165F, and axes [degrees] of a point at N U T 0 0 0 with X 1500, Z 360, W 135 and P -45.

Links: ROS-Industrial, fanuc_r2000ib_support. The point: onerobotics.com, The perils of six-axis robots (2013); it
says itself how far out the faceplate is.
"""


def made(robot: Robot, maker: str, degrees=(0.0,) * 6, **asked) -> ConvertedProgram:
    """A move to axes by a program of a maker's language."""
    to = AxisTarget(tuple(math.radians(one) for one in degrees), name="P1")
    read = ControllerProgram((ControllerMove(Line(3), "ptp", to, np.eye(4)),), maker=maker)
    return converted(read, validated(ProgramFile, {"file": "a.ls", **asked}, "program"), robot, {})


def degrees_of(found: ConvertedProgram) -> list[float]:
    return [math.degrees(value) for value in found.program.moves[0].ptp.joints.values()]


@pytest.mark.parametrize("maker", ARMS)
def test_an_arm_whose_joints_turn_as_its_makers_axes_is_taken_as_such(maker):
    doubts = {"abb": "parallel bars", "fanuc": "J3 is taken to count from the horizontal"}
    found, said = made(arm(*ARMS[maker]), maker), made(arm(*ARMS[maker]), maker, axes_as=maker)
    assert len(found.assumed) == (maker in doubts) and said.assumed == ()
    assert doubts.get(maker, "") in "".join(found.assumed)
    assert any("joints turn as the axes of" in note for note in said.notes)
    for other in ARMS.keys() - {maker}:
        assert re.search(r"turns against|another line", refusal(made, arm(*ARMS[maker]), other))


# as the KR 210 of ROS-Industrial: it has its zero at A2 -90 and A3 90, and three joints turn the other way
KR210 = arm(
    ABB,
    ((0, 0, 0.331), (0.353, 0, 0.419), (0, 0, 1.25), (0.96, 0, -0.055), (0.54, 0, 0), (0.19, 0, 0)),
)


def test_joints_that_turn_otherwise_are_refused_until_the_case_says_how():
    assert refusal(made, KR210, "kuka").endswith(
        "axes: with the axes of KUKA robots at 0, joint_1 turns against axis 1, joint_4 turns against axis 4, "
        "joint_6 turns against axis 6, joint_2 is 90 degrees from where axis 2 is at 0; if joint_6 and its axis "
        "are 0 together, program: {axes: {joint_1: {sign: -1}, joint_2: {offset: 90deg}, joint_3: "
        "{offset: -90deg}, joint_4: {sign: -1}, joint_6: {sign: -1}}}; axes_as: plain is right only if the "
        "controller shows the joints' own angles"
    )
    how = "how joints follow axes, as program: {axes: {joint: {sign: -1, offset: 90deg"
    assert how in refusal(made, arm(*ARMS["ur"]), "kuka")
    said = "axes_as: with the axes of KUKA robots at 0, joint_1"
    assert said in refusal(made, KR210, "kuka", axes_as="kuka")
    rules = {name: {"sign": -1} for name in ("joint_1", "joint_4", "joint_6")}
    rules |= {"joint_2": {"offset": "90deg"}, "joint_3": {"offset": "-90deg"}}
    found = made(KR210, "kuka", (10, -90, 90, 20, 30, 40), axes_as="kuka", axes=rules)
    assert found.assumed == () and degrees_of(found) == pytest.approx([-10, 0, 0, -20, 30, -40])
    found = made(KR210, "kuka", axes={"joint_1": {"sign": -1}})
    assert found.assumed == () and any("joint_4 turns against" in note for note in found.notes)


def test_axes_that_turn_otherwise_are_told_before_flags_that_contradict_each_other():
    to = PoseTarget(np.eye(4), ranges={1: (3.0, 4.0)}, is_behind=True)
    read = ControllerProgram((ControllerMove(Line(4), "ptp", to, np.eye(4)),), maker="kuka")
    asked = validated(ProgramFile, {"file": "a.src", "axes_as": "kuka"}, "program")
    start = {f"joint_{i}": 0.0 for i in range(1, 7)}
    assert "axes_as: " in refusal(converted, read, asked, KR210, start)


COUNTS = "J3 is taken to count from the horizontal"
PLAIN = "joint_6 are taken to turn as the axes do; axes_as: plain"
OTHER = "joints are taken for the axes (axes_as: plain), but with the axes of KUKA robots at 0, joi"
HORIZONTAL = "but axis 3 of FANUC robots counts from the horizontal"


@pytest.mark.parametrize(
    ("robot", "maker", "asked", "third", "told"),
    [
        (arm(*ARMS["fanuc"]), "fanuc", {}, 30.0, COUNTS),
        (arm(*ARMS["fanuc"]), "fanuc", {"axes": {"joint_3": {"sign": -1}}}, -30.0, COUNTS),
        (arm(*ARMS["fanuc"]), "fanuc", {"axes": {"joint_2": {"sign": -1}}}, 30.0, COUNTS),
        (arm(*ARMS["fanuc"]), "fanuc", {"axes": {"joint_3": {"plus": {2: 1.0}}}}, 30.0, ""),
        (arm(*ARMS["fanuc"]), "fanuc", {"axes": {"joint_3": {"plus": {}}}}, 10.0, ""),
        (arm(*ARMS["fanuc"]), "fanuc", {"axes_as": "plain"}, 10.0, HORIZONTAL),
        (arm(*ARMS["abb"]), "abb", {}, 10.0, "parallel bars"),
        (arm(*ARMS["abb"]), "abb", {"axes": {"joint_3": {"sign": 1}}}, 10.0, ""),
        (arm(*ARMS["abb"]), "abb", {"axes_as": "abb_parallel"}, -10.0, ""),
        (arm(*ARMS["abb"]), "abb", {"axes_as": "plain"}, 10.0, ""),
        (arm(*ARMS["abb"]), "plain", {}, 10.0, PLAIN),
        (arm(*ARMS["abb"]), "plain", {"axes_as": "plain"}, 10.0, ""),
        (arm(*ARMS["abb"]), "plain", {"axes": {"joint_1": {}}}, 10.0, ""),
        (KR210, "kuka", {"axes_as": "plain"}, 10.0, OTHER),
    ],
)  # fmt: skip
def test_how_the_third_axis_counts_is_assumed_and_told_unless_the_case_says_it(
    robot, maker, asked, third, told
):
    found = made(robot, maker, (0, 20, 10, 0, 0, 0), **asked)
    assert degrees_of(found)[2] == pytest.approx(third)
    assert len(found.assumed) == bool(told) and told in "".join(found.assumed)


def test_axes_and_pose_of_a_published_point_agree():
    robot, degrees = R2000
    near = tuple(map(math.radians, degrees))
    pose = pose_from_rpy([1.5, 0.0, 0.36], [math.radians(135.0), math.radians(-45.0), 0.0])
    moves = [
        ControllerMove(Line(3), "ptp", AxisTarget(near), np.eye(4)),
        ControllerMove(Line(4), "ptp", PoseTarget(pose, near=near), np.eye(4)),
    ]
    asked = validated(ProgramFile, {"file": "a.ls"}, "program")
    found = converted(ControllerProgram((*moves,), maker="fanuc"), asked, robot, {})
    assert any("agree with the robot within 0.0" in note for note in found.notes), found.notes
    assert found.assumed == ()  # the point confirms how J3 counts


@pytest.mark.parametrize("maker", ARMS)
def test_joints_with_other_signs_and_zeros_are_told_by_how_much(maker):
    """Of an arm whose URDF counts joints from elsewhere, and the other way: of its maker's, once it is said so."""
    random = np.random.default_rng(3)
    offsets, signs = random.uniform(-1.2, 1.2, 6) * [1, 1, 1, 1, 1, 0], random.choice([-1, 1], 6)
    robot, joints = arm(*ARMS[maker]), []
    for joint, sign, offset in zip(robot.joints[:6], signs, offsets, strict=True):
        turned = pose_from_rotation_vector([0.0] * 3, (-offset * joint.axis * sign).tolist())
        place = joint.parent_from_joint @ turned
        joints.append(replace(joint, parent_from_joint=place, axis=sign * joint.axis))
    odd = replace(robot, joints=(*joints, *robot.joints[6:]))
    arm_of = ControlledArm(validated(ProgramFile, {"file": "a"}, "program"), odd, maker=maker)
    rules = CONVENTIONS[maker].rules(arm_of.chain, arm_of.axes, np.eye(4))
    if maker == "ur":  # axes 2, 3 and 4 are parallel: their directions do not say where 3 is
        assert not rules
        return
    assert [one.sign for one in rules.values()] == signs.tolist()
    assert [one.offset for one in rules.values()] == pytest.approx(offsets.tolist(), abs=1e-9)


FAR = 0.05
"""[m] Of a side: nearer wrists are not drawn."""


def controlled(robot: Robot, maker: str, **asked) -> ControlledArm:
    given = validated(ProgramFile, {"file": "a", **asked}, "program")
    return ControlledArm(given, robot, maker=maker)


def places_of(robot: Robot, joints: np.ndarray) -> list[np.ndarray]:
    """Axes 2 and 3 and the wrist, seen with axis 1, so that x is ahead."""
    frames = chain_between(robot, "root", "tool0").frames(np.array([[0.0, *joints[1:]]]))[0]
    return [frames[i, :3, 3] for i in (1, 2, 4)]


@pytest.mark.parametrize(
    ("maker", "third"), [("abb", (-3.1, 1.7)), ("fanuc", (-1.7, 3.1)), ("kuka", (-2.9, 3.1))]
)
def test_ranges_hold_the_joints_of_the_flags_and_none_of_others(maker, third):
    axes, places = ARMS[maker]
    robot = arm(axes, (places[0], (0.1, 0.03, 0), *places[2:]), (0.3, -0.2, 0.1), third)
    made, draw, seen = controlled(robot, maker), np.random.default_rng(7), set()
    for joints in draw.uniform(-3.05, 3.05, (60, 6)):
        joints[2] = draw.uniform(*third)
        shoulder, elbow, wrist = places_of(robot, joints)
        bend = np.cross(elbow - shoulder, wrist - elbow)[1]
        if abs(wrist[0]) < FAR or abs(bend) < FAR:
            continue
        own = bool(wrist[0] < 0.0), bool(bend < 0.0)
        named = {f"joint_{i}": value for i, value in enumerate(joints, 1)}
        flange = made.tool_at(named, np.eye(4))
        for flags in itertools.product((False, True), repeat=2):
            asked = PoseTarget(flange, is_behind=flags[0], is_back=flags[1])
            found = made.ranges_of(asked, np.eye(4))
            for name, flag, true in zip(("joint_1", "joint_3"), flags, own, strict=True):
                if name in found:  # else the wrist is on axis 1
                    ends = np.reshape(
                        found[name], (-1, 2)
                    )  # of joint_1 there may be several, by turns
                    is_in = (ends[:, 0] <= named[name]) & (named[name] <= ends[:, 1])
                    assert is_in.any() == (flag == true)
                    seen.add((name, flag, true))
            assert "joint_3" in found
    assert len(seen) == 8


@pytest.mark.parametrize("is_back", [False, True])
def test_a_flag_holds_also_where_joint_3_turns_more_than_once(is_back):
    """The joints nearest to the start are those of one of the two elbows only."""
    axes, places = ARMS["fanuc"]
    robot = arm(axes, (places[0], (0.1, 0.03, 0), *places[2:]), (0.3, -0.2, 0.1), (-6.1, 6.1))
    made, joints = controlled(robot, "fanuc"), np.array([0.2, 0.5, -0.3, 0.4, 0.8, -0.5])
    named = {f"joint_{i}": value for i, value in enumerate(joints, 1)}
    pose = made.tool_at(named, np.eye(4))
    within = made.ranges_of(PoseTarget(pose, is_behind=False, is_back=is_back), np.eye(4))
    assert len(within["joint_3"]) > 1
    assert any("turns of joint_3" in one for one in made.doubts_on_configurations([]))
    move = JointMove("a", "b", pose=pose, within=within)
    found = JointWay.of(Arm(robot, "tool0", np.eye(4)), move, joints + 0.1).target
    reached = made.tool_at(dict(zip(named, found, strict=True)), np.eye(4))
    assert np.abs(reached - pose).max() < 1e-9
    shoulder, elbow, wrist = places_of(robot, found)
    assert (np.cross(elbow - shoulder, wrist - elbow)[1] < 0.0) == is_back


def test_a_published_point_is_in_the_configuration_that_it_names():
    text = (
        "/PROG A\n/MN\n1:J P[1] 10% FINE ;\n/POS\nP[1]{\n GP1:\n UF : 0, UT : 0, CONFIG : 'N U T, 0, 0, 0',\n"
        " X = 1500.0 mm, Y = 0.0 mm, Z = 360.0 mm,\n W = 135.0 deg, P = -45.0 deg, R = 0.0 deg\n};\n/END\n"
    )
    (move,) = read("A.LS", text).moves
    assert move.to.unchecked == "" and {*move.to.ranges} == {4, 5, 6}
    robot, degrees = R2000
    found = controlled(robot, "fanuc").ranges_of(move.to, np.eye(4))
    joints = np.radians([*degrees[:2], degrees[2] + degrees[1], *degrees[3:]])
    assert all(low <= joints[int(name[-1]) - 1] <= high for name, (low, high) in found.items())
    assert {*found} == {f"joint_{i}" for i in (1, 3, 4, 5, 6)}


def test_the_home_of_a_kr_6_has_the_bits_that_it_is_taught_with():
    # at A2 -90 and A3 90 of a KR 6 R900 sixx, links as in ROS-Industrial
    places = ((0, 0, 0.4), (0.025, 0, 0), (0.455, 0, 0), (0, 0, 0.035), (0.42, 0, 0), (0.08, 0, 0))
    text = "DEF A()\nPTP {X 525,Y 0,Z 890,A 0,B 90,C 0,S 2,T 2}\nEND\n"
    (move,) = read("A.SRC", text, tools={"$TOOL": {}}, frames={"$BASE": {}}).moves
    robot = arm(ARMS["kuka"][0], places, (0.0, math.pi / 2, 0.0), (-2.1, 2.7))
    made = controlled(robot, "kuka")
    found = made.ranges_of(move.to, np.eye(4))
    joints = dict(zip(found, np.radians([0.0, -90.0, 90.0, 0.0, 0.0, 0.0]), strict=True))
    assert np.abs(made.tool_at(joints, np.eye(4)) - move.to.pose).max() < 1e-12
    assert all(low <= joints[name] <= high for name, (low, high) in found.items())
    # the wrist is on the line from axis 2 to 3 where the forearm points up by its offset
    straight = made.ranges_of(PoseTarget(move.to.pose, is_behind=False, is_back=True), np.eye(4))
    assert straight["joint_3"][1] == pytest.approx(math.atan2(0.035, 0.42))


@pytest.mark.parametrize("fault", ["wrist", "maker", "base"])
def test_an_arm_that_is_built_otherwise_has_no_such_ranges(fault):
    axes, places = ARMS["abb"]
    if fault == "wrist":
        places = (*places[:5], (0.1, 0.05, 0.0))
    if fault == "maker":
        axes = (-axes[0], *axes[1:])
    asked = {"base": {"on": "world"}} if fault == "base" else {}
    made = controlled(arm(axes, places), "abb", **asked)
    assert made.wrist is None
    assert made.ranges_of(PoseTarget(np.eye(4), is_behind=True, is_back=True), np.eye(4)) == {}


def test_the_wrist_is_found_wherever_the_base_is_on_the_robot_or_in_the_world():
    robot, joints = arm(*ARMS["abb"]), np.radians([20.0, 10.0, 15.0, 5.0, 40.0, 0.0])
    flange = chain_between(robot, "root", "tool0").frames(joints[None])[0, -1]
    to = PoseTarget(flange, is_behind=False, is_back=False)
    own = controlled(robot, "abb").ranges_of(to, np.eye(4))
    assert {*own} == {"joint_1", "joint_3"}
    raised = np.eye(4)
    raised[2, 3] = 0.4
    for on, root_from_world in (("root", None), ("world", np.eye(4))):
        made = controlled(robot, "abb", base={"on": on, "xyz": [0.0, 0.0, -0.4]})
        made.root_from_world = root_from_world
        found = made.ranges_of(replace(to, pose=raised @ flange), np.eye(4))
        assert found == {name: pytest.approx(ends) for name, ends in own.items()}
    assert controlled(robot, "abb", base={"on": "link_1"}).wrist is None

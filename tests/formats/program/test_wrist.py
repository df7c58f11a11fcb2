"""Flags of a configuration that the wrist's place tells: ranges of axes 1 and 3 against random joints."""

from __future__ import annotations

import itertools
import math
from dataclasses import replace

import numpy as np
import pytest

from clearance.formats.program.controlled_arm import ControlledArm
from clearance.formats.program.controller_program import PoseTarget
from clearance.formats.schema.program_file import ProgramFile
from clearance.formats.schema.strict_model import validated
from clearance.programs.arm import Arm
from clearance.programs.joint_way import JointWay
from clearance.programs.moves import JointMove
from clearance.world.kinematic_chain import chain_between
from clearance.world.robot import Robot
from tests.formats.program.reading import read
from tests.formats.program.test_conventions import ARMS, R2000, arm

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

"""How axes of makers' robots turn, and joints that turn otherwise: values by hand and of published robots."""

from __future__ import annotations

import math
from dataclasses import replace

import numpy as np
import pytest

import clearance as cl
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
from clearance.world.robot import Joint, JointKind, Robot

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
        with pytest.raises(cl.ClearanceError, match=r"turns against|another line"):
            made(arm(*ARMS[maker]), other)


def test_joints_that_turn_otherwise_are_refused_until_the_case_says_how():
    # as the KR 210 of ROS-Industrial: it has its zero at A2 -90 and A3 90, and three joints turn the other way
    places = (
        *((0, 0, 0.331), (0.353, 0, 0.419), (0, 0, 1.25)),
        (0.96, 0, -0.055),
        (0.54, 0, 0),
        (0.19, 0, 0),
    )
    robot = arm(ABB, places)
    with pytest.raises(cl.ClearanceError) as refused:
        made(robot, "kuka")
    assert str(refused.value).endswith(
        "axes: with the axes of KUKA robots at 0, joint_1 turns against axis 1, joint_4 turns against axis 4, "
        "joint_6 turns against axis 6, joint_2 is 90 degrees from where axis 2 is at 0; if joint_6 and its axis "
        "are 0 together, program: {axes: {joint_1: {sign: -1}, joint_2: {offset: 90deg}, joint_3: "
        "{offset: -90deg}, joint_4: {sign: -1}, joint_6: {sign: -1}}}; axes_as: plain is right only if the "
        "controller shows the joints' own angles"
    )
    how = r"how joints follow axes, as program: \{axes: \{joint: \{sign: -1, offset: 90deg"
    with pytest.raises(cl.ClearanceError, match=how):
        made(arm(*ARMS["ur"]), "kuka")
    (told,) = made(robot, "kuka", axes_as="plain").assumed
    assert told.startswith(
        "joints are taken for the axes (axes_as: plain), but with the axes of KUKA robots at 0, joi"
    )
    (told,) = made(arm(*ARMS["fanuc"]), "fanuc", axes_as="plain").assumed
    assert told.endswith("but axis 3 of FANUC robots counts from the horizontal")
    assert made(arm(*ARMS["abb"]), "abb", axes_as="plain").assumed == ()
    with pytest.raises(
        cl.ClearanceError, match="axes_as: with the axes of KUKA robots at 0, joint_1"
    ):
        made(robot, "kuka", axes_as="kuka")
    flagged = ControllerMove(
        Line(4), "ptp", PoseTarget(np.eye(4), ranges={1: (3.0, 4.0)}, is_behind=True), np.eye(4)
    )
    asked = validated(ProgramFile, {"file": "a.src", "axes_as": "kuka"}, "program")
    with pytest.raises(
        cl.ClearanceError, match="axes_as: "
    ):  # and not that the flags contradict each other
        converted(
            ControllerProgram((flagged,), maker="kuka"),
            asked,
            robot,
            {f"joint_{i}": 0.0 for i in range(1, 7)},
        )
    rules = {name: {"sign": -1} for name in ("joint_1", "joint_4", "joint_6")}
    rules |= {"joint_2": {"offset": "90deg"}, "joint_3": {"offset": "-90deg"}}
    found = made(robot, "kuka", (10, -90, 90, 20, 30, 40), axes_as="kuka", axes=rules)
    assert found.assumed == () and degrees_of(found) == pytest.approx([-10, 0, 0, -20, 30, -40])
    found = made(robot, "kuka", axes={"joint_1": {"sign": -1}})
    assert found.assumed == () and any("joint_4 turns against" in note for note in found.notes)


@pytest.mark.parametrize(
    ("asked", "third"),
    [
        ({}, 30.0),
        ({"axes": {"joint_3": {"sign": -1}}}, -30.0),
        ({"axes": {"joint_2": {"sign": -1}}}, 30.0),
        ({"axes": {"joint_3": {"plus": {2: 1.0}}}}, 30.0),
        ({"axes": {"joint_3": {"plus": {}}}}, 10.0),
        ({"axes_as": "plain"}, 10.0),
    ],
)
def test_an_axis_that_counts_from_the_horizontal_is_counted_once(asked, third):
    found = made(arm(*ARMS["fanuc"]), "fanuc", (0, 20, 10, 0, 0, 0), **asked)
    assert degrees_of(found)[2] == pytest.approx(third)
    is_said = "axes_as" in asked or "plus" in asked.get("axes", {}).get("joint_3", {})
    assert is_said != any("J3 is taken to count" in one for one in found.assumed)


def test_a_rule_for_joint_3_says_how_it_counts_where_it_is_whole():
    robot = arm(*ARMS["abb"])
    assert (
        made(robot, "abb").assumed and not made(robot, "abb", axes={"joint_3": {"sign": 1}}).assumed
    )


def test_parallel_bars_keep_the_forearm_as_it_is():
    robot = arm(*ARMS["abb"])
    found = made(robot, "abb", (0, 20, 10, 0, 0, 0), axes_as="abb_parallel")
    assert degrees_of(found)[2] == pytest.approx(-10.0) and found.assumed == ()


def test_an_arm_of_which_nobody_knows_the_axes_is_told():
    robot = arm(*ARMS["abb"])
    (told,) = made(robot, "plain").assumed
    assert "joint_6 are taken to turn as the axes do; axes_as: plain" in told
    assert made(robot, "plain", axes_as="plain").assumed == ()
    assert made(robot, "plain", axes={"joint_1": {}}).assumed == ()


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
    turns, places = ARMS[maker]
    offsets, signs = random.uniform(-1.2, 1.2, 6) * [1, 1, 1, 1, 1, 0], random.choice([-1, 1], 6)
    robot, joints = arm(turns, places), []
    for joint in robot.joints[:6]:
        i = len(joints)
        turned = pose_from_rotation_vector(
            [0.0] * 3, (-offsets[i] * joint.axis * signs[i]).tolist()
        )
        joints.append(
            replace(
                joint,
                parent_from_joint=joint.parent_from_joint @ turned,
                axis=signs[i] * joint.axis,
            )
        )
    odd = replace(robot, joints=(*joints, *robot.joints[6:]))
    arm_of = ControlledArm(validated(ProgramFile, {"file": "a"}, "program"), odd, maker=maker)
    rules = CONVENTIONS[maker].rules(arm_of.chain, arm_of.axes, np.eye(4))
    if (
        maker == "ur"
    ):  # its axes 2, 3 and 4 are parallel, so that their directions do not say where 3 is
        assert not rules
        return
    assert [one.sign for one in rules.values()] == signs.tolist()
    assert [one.offset for one in rules.values()] == pytest.approx(offsets.tolist(), abs=1e-9)

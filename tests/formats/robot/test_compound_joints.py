"""Planar, floating and ball joints as chains of joints of one axis each."""

import re

import numpy as np
import pytest

from clearance.errors import BadInput, DuplicateName
from clearance.geometry.pose import pose_from_rpy
from clearance.world.kinematics import link_poses
from clearance.world.placed_robot import PlacedRobot
from tests.formats.making_case import load_small
from tests.formats.making_urdf import BOX, joint, link, load_robot, robot
from tests.formats.refusal import refusal

UP = '<axis xyz="0 0 1"/>'
AT = '<origin xyz="1 2 3" rpy="0.1 0.2 0.3"/>'


def moving(kind: str, inner: str = "") -> str:
    """Two cubes, the second on a joint of the kind that is called free."""
    return robot(link(BOX, "base"), link(BOX, "body"), joint("free", "base", "body", kind, inner))


def pose_of_body(loaded, *positions: float) -> np.ndarray:
    poses = link_poses(PlacedRobot(loaded), np.array([positions]))
    return poses[0, loaded.link_names.index("body")]


def test_a_planar_joint_slides_along_x_and_y_and_then_turns_about_z(tmp_path):
    loaded = load_robot(tmp_path, moving("planar", AT + UP))
    assert [one.name for one in loaded.moving_joints] == ["free/x", "free/y", "free/yaw"]
    expected = pose_from_rpy([1, 2, 3], [0.1, 0.2, 0.3]) @ pose_from_rpy([4, 5, 0], [0, 0, 0.7])
    np.testing.assert_allclose(pose_of_body(loaded, 4, 5, 0.7), expected, rtol=0, atol=1e-14)


def test_a_floating_joint_is_a_place_and_roll_pitch_yaw(tmp_path):
    loaded = load_robot(tmp_path, moving("floating", AT))
    positions = [4.0, 5.0, 6.0, 0.3, -0.2, 0.1]
    expected = pose_from_rpy([1, 2, 3], [0.1, 0.2, 0.3]) @ pose_from_rpy(
        [4, 5, 6], [0.1, -0.2, 0.3]
    )
    np.testing.assert_allclose(pose_of_body(loaded, *positions), expected, rtol=0, atol=1e-14)
    assert loaded.notes == (
        "arm.urdf: floating joint 'free' is read as free/x, free/y, free/z, free/yaw, free/pitch, free/roll; "
        "between samples each goes by itself",
    )


@pytest.mark.parametrize(
    ("urdf", "fault", "words"),
    [
        (moving("planar"), BadInput, "a planar joint whose axis is not z"),
        (moving("floating", '<mimic joint="x"/>'), BadInput, "a floating joint has a <mimic>"),
        (robot(link(BOX, "base"), link(BOX, "body"), link("", "free/x"), joint("free", "base", "body", "floating"),
               joint("k", "base", "free/x")), DuplicateName, "two links have the name 'free/x'"),
        (robot(link(BOX, "base"), link(BOX, "body"), link("", "c"), joint("free", "base", "body", "floating"),
               joint("free/x", "base", "c")), DuplicateName, "two joints have the name 'free/x'"),
    ],
)  # fmt: skip
def test_what_cannot_be_read_is_refused(tmp_path, urdf, fault, words):
    assert re.search(words, refusal(load_robot, tmp_path, urdf, of=fault))


FREE = robot(
    link(BOX, "world"), link(BOX, "upper"), link(BOX, "base"), joint("shoulder", "base", "upper"),
    joint("root", "world", "base", "floating"),
)  # fmt: skip


def test_a_floating_joint_that_nobody_places_is_refused_with_the_ways_out(tmp_path):
    with pytest.raises(BadInput) as caught:
        load_small(tmp_path, urdf=FREE)
    assert str(caught.value) == (
        "case.yaml: robot.joints: floating joint 'root' is given no place; {root/x: 0} where it stays at 0, or "
        "columns of the trajectory (root/x, root/y, root/z, root/yaw, root/pitch, root/roll)"
    )

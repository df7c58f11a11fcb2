"""Everything in a URDF file that cannot be meant is refused in one line, with file and element."""

import pytest

from clearance.errors import (
    BadDimension,
    BadInput,
    BadPose,
    BadShape,
    BadSyntax,
    MissingFile,
    MissingKey,
    NotFinite,
    UnknownJoint,
    UnknownLink,
)
from tests.formats.making_urdf import BOX, collision, joint, link, load_robot, robot
from tests.formats.refusal import refusal

A_B = link("", "a") + link("", "b")


def turned(attributes: str, version: str) -> str:
    shape = collision('<box size="1 1 1"/>', f"<origin {attributes}/>")
    return robot(link(shape)).replace("<robot", f'<robot version="{version}"')


def in_joint(inner: str) -> str:
    return robot(A_B, joint("j", "a", "b", inner=inner))


@pytest.mark.parametrize(
    ("urdf", "fault", "says"),
    [
        ("not xml at all", BadSyntax, "not XML"),
        ("<sdf/>", BadSyntax, "this is an SDF world or model, not a URDF file"),
        (robot(), BadInput, "no links"),
        ('<robot name="r" xmlns:xacro="http://www.ros.org/wiki/xacro"><xacro:arm/></robot>', BadSyntax, "xacro"),
        (robot("<link/>"), MissingKey, "link[0]: <link> has no name"),
        (robot(A_B), BadInput, "links 'a', 'b' have no parent"),
        (robot(A_B, joint("j", "a", "b"), joint("k", "a", "b")), BadInput, "child of joints 'j' and 'k'"),
        (robot(A_B, joint("j", "a", "b"), joint("k", "b", "a")), BadInput, "circle"),
        (robot(A_B, joint("j", "base", "b")), UnknownLink, "joint 'j': unknown parent link 'base'"),
        (robot(A_B, '<joint name="j" type="fixed"><parent link="a"/></joint>'), MissingKey, "0 <child>"),
        (robot(A_B, joint("j", "a", "b", "ball")), BadInput, "joint 'j': type 'ball'"),
        (in_joint('<axis xyz="0 0 0"/>'), BadInput, "axis is 0 0 0"),
        (in_joint('<axis xyz="0 1"/>'), BadShape, "joint 'j' axis: xyz='0 1'"),
        (in_joint('<axis xyz="0 1 nan"/>'), NotFinite, "xyz="),
        (in_joint('<limit lower="2" upper="1"/>'), BadInput, "lower limit 2"),
        (in_joint('<mimic joint="k"/>'), UnknownJoint, "unknown joint 'k'"),
        (robot(link(collision('<sphere radius="1" diameter="2"/>'))), BadInput, "='2' is not read; radius="),
        ('<robot name="r" units="mm"/>', BadInput, "robot 'r': units='mm' is not read"),
        (in_joint('<axis xyz="0 0 1"/><axis xyz="0 1 0"/>'), BadInput, "two <axis>"),
        (in_joint("<origin>1 0 0</origin>"), BadInput, "origin: the text '1 0 0' is not"),
        (robot(link("<shape><box size='1 1 1'/></shape>")), BadInput, "link 'a': <shape> is not read"),
        (robot(link(BOX.replace("</collision>", "<geometry/></collision>"))), BadInput, "has two <geometry>"),
        (robot(A_B, '<x:include xmlns:x="urn:x" href="a"/>'), BadInput, "<x:include> is not read"),
        ('<robot name="r" version="9.9"/>', BadInput, "robot: version='9.9'; 1.0 or 1.1 or 1.2"),
        (turned('quat_xyzw="0 0 0 1"', "1.0"), BadInput, "origin: quat_xyzw= is given; <robot version"),
        (turned('quat_xyzw="0 0 0 1" rpy="0 0 0"', "1.1"), BadInput, "origin: rpy= and quat_xyzw= are given"),
        (turned('quat_xyzw="0 0 0 2"', "1.2"), BadPose, "origin: quat_xyzw: the quaternion"),
        (robot(link(BOX + collision("<cone/>"))), BadInput, "collision[1] geometry: <cone>"),
        (robot(link(collision("<box/>"))), MissingKey, "<box> has no size"),
        (robot(link(collision('<box size="1 1 0"/>'))), BadDimension, "link 'a' collision[0]"),
        (robot(link(collision('<mesh filename="no.stl"/>'))), MissingFile, "collision[0]: there is no mesh"),
        (robot(link(collision('<mesh filename="package://p/no.stl"/>'))), MissingFile, "package_dirs"),
        (robot(link(collision('<mesh filename="upper.stl" scale="0 1 1"/>'))), BadDimension, "upper.stl: scale"),
        (robot(link(collision('<mesh filename="arm.urdf"/>'))), BadSyntax, "unknown mesh format '.urdf'"),
        ("<!DOCTYPE robot [<!ENTITY b '<link name=\"a\"/>'>]>" + robot("&b;"), BadSyntax,
         "&b; stands for something among the elements"),
    ],
)  # fmt: skip
def test_each_fault_is_one_line_with_file_and_element(tmp_path, urdf, fault, says):
    said = refusal(load_robot, tmp_path, urdf, of=fault)
    assert says in said
    assert said.startswith("arm.urdf: ")

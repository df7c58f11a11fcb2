"""SRDF files: which pairs they excuse, in MoveIt's order of precedence, and which files are refused."""

import pytest

from clearance.errors import BadInput, BadSyntax, MissingKey
from clearance.formats.robot.srdf import load_srdf
from clearance.world.collision_matrix import BY_DEFAULT
from tests.formats.making_urdf import collision, joint, link, load_urdf, robot

BOX = collision('<box size="1 1 1"/>')
ARM = robot(
    link(BOX, "a"), link(BOX, "b"), link(BOX, "c"), joint("ab", "a", "b"), joint("bc", "b", "c")
)


@pytest.fixture
def read(tmp_path):
    arm = load_urdf(tmp_path, ARM)

    def read_rows(*rows, name="arm", document=None):
        text = document or f'<robot name="{name}">{"".join(rows)}</robot>'
        (tmp_path / "arm.srdf").write_text(text)
        return load_srdf(tmp_path / "arm.srdf", arm)

    return read_rows


def disable(a, b, reason="Never"):
    return f'<disable_collisions link1="{a}" link2="{b}" reason="{reason}"/>'


def enable(a, b):
    return f'<enable_collisions link1="{a}" link2="{b}"/>'


OFF = '<disable_default_collisions link="a"/>'


@pytest.mark.parametrize(
    "rows, reason",
    [
        ([], None),
        ([OFF], BY_DEFAULT),
        ([OFF, enable("b", "a")], None),
        ([enable("a", "b"), OFF], None),
        ([enable("a", "b")], None),
        ([disable("a", "b")], "Never"),
        ([disable("b", "a", "Adjacent")], "Adjacent"),
        ([disable("a", "b"), enable("a", "b")], "Never"),
        ([OFF, enable("a", "b"), disable("a", "b", "User")], "User"),
        ([disable("a", "b", "Never"), disable("b", "a", "Default")], "Default"),
        ([disable("a", "b", "because")], "User"),
        (['<disable_collisions link1="a" link2="b"/>'], "User"),
        ([disable("b", "c")], None),
    ],
)
def test_what_counts_last_decides(read, rows, reason):
    matrix = read(*rows)
    assert matrix.reason("a", "b") == matrix.reason("b", "a") == reason


def test_a_link_that_is_off_by_default_is_so_with_every_other(read):
    matrix = read(OFF)
    assert matrix.reason("a", "c") == BY_DEFAULT
    assert matrix.reason("b", "c") is None


def test_rows_of_unknown_links_are_left_out_and_named(read):
    matrix = read(disable("a", "b"), disable("a", "gripper"), OFF.replace('"a"', '"tool"'))
    assert matrix.reason("a", "b") == "Never" and matrix.off_by_default == ()
    (note,) = matrix.notes
    assert "arm.srdf: 2 rows" in note and "gripper, tool" in note


@pytest.mark.parametrize(
    "document, error, words",
    [
        (disable("x", "y"), BadInput, "none of its 1 rows speaks of links of robot"),
        (
            disable("a", "b") + '<disable_collisions link1="a"/>',
            MissingKey,
            "disable_collisions[1]: <disable_collisions> has no link2",
        ),
        ("<disable_default_collisions/>", MissingKey, "has no link"),
        (disable("a", "b&#10;forged"), BadInput, "a control character"),
    ],
)
def test_what_cannot_be_used_is_refused_by_its_place(read, document, error, words):
    with pytest.raises(error) as caught:
        read(document)
    assert words in str(caught.value) and str(caught.value).startswith("arm.srdf: ")


@pytest.mark.parametrize(
    "document, words",
    [
        ("<robot", "not XML"),
        ("<sdf/>", "the root element is <sdf>"),
        (ARM, "this is a URDF file; an SRDF file is needed"),
        (
            '<robot xmlns:xacro="http://ros.org/xacro"><xacro:include/></robot>',
            "makes an SRDF file of it",
        ),
        ('<!DOCTYPE robot [<!ENTITY x "y">]><robot>&x;</robot>', "stands for something"),
    ],
)
def test_other_files_are_refused(read, document, words):
    with pytest.raises(BadSyntax) as caught:
        read(document=document)
    assert words in str(caught.value)

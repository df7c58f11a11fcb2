"""SRDF files: which pairs they excuse, where named states let joints rest, and which are refused."""

import numpy as np
import pytest

from clearance.errors import BadInput, BadShape, BadSyntax, MissingKey, UnknownState
from clearance.formats.robot.srdf import load_srdf
from clearance.world.collision_matrix import BY_DEFAULT
from clearance.world.notice import Severity
from clearance.world.plausibility import notices_of
from tests.formats.making_case import TWO_JOINTS, changed, load_small
from tests.formats.making_urdf import collision, joint, link, load_robot, robot
from tests.formats.refusal import refusal

BOX = collision('<box size="1 1 1"/>')
ARM = robot(
    link(BOX, "a"), link(BOX, "b"), link(BOX, "c"), joint("ab", "a", "b"), joint("bc", "b", "c")
)


@pytest.fixture
def read(tmp_path):
    arm = load_robot(tmp_path, ARM)

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
        ([disable("a", "b", "never")], "Never"),
        ([disable("a", "b", " NEVER in collision")], "Never"),
        ([disable("a", "b", "adjacent ")], "Adjacent"),
        (['<disable_collisions link1="a" link2="b"/>'], "User"),
        ([disable("b", "c")], None),
    ],
)
def test_what_counts_last_decides(read, rows, reason):
    matrix = read(*rows)
    assert matrix.reason("a", "b") == matrix.reason("b", "a") == reason


def test_rows_of_unknown_links_are_left_out_and_named(read):
    matrix = read(disable("a", "b"), disable("a", "gripper"), OFF.replace('"a"', '"tool"'))
    assert matrix.reason("a", "b") == "Never" and matrix.off_by_default == ()
    (note,) = matrix.notes
    assert "arm.srdf: 2 rows" in note and "gripper, tool" in note


def test_reasons_that_are_no_known_word_are_named(read):
    (note,) = read(disable("a", "b", "because"), disable("b", "c", "User")).notes
    assert note == "arm.srdf: 1 reason is none of MoveIt's and counts as User: 'because'"
    (note,) = read(disable("a", "a"), disable("b", "c", "User")).notes
    assert note == "arm.srdf: 1 row pairs a link with itself and is left out"


@pytest.mark.parametrize(
    ("rows", "error", "words"),
    [
        (disable("x", "y"), BadInput, "none of its 1 rows speaks of links of robot"),
        (disable("a", "b") + '<disable_collisions link1="a"/>', MissingKey,
         "disable_collisions[1]: <disable_collisions> has no link2"),
        ('<enable_colisions link1="a" link2="b"/>', BadInput, "<enable_colisions> is not read; did you"),
        ('<group_state name="s"><joint name="j" value="1" unit="deg"/></group_state>', BadInput, "'j': unit="),
        ("<robot", BadSyntax, "not XML"),
        ("<sdf/>", BadSyntax, "the root element is <sdf>"),
        (ARM, BadSyntax, "this is a URDF file; an SRDF file is needed"),
        ('<robot xmlns:xacro="http://ros.org/xacro"><xacro:include/></robot>', BadSyntax, "makes an SRDF"),
        ('<!DOCTYPE robot [<!ENTITY x "y">]><robot>&x;</robot>', BadSyntax, "stands for something"),
    ],
)  # fmt: skip
def test_what_cannot_be_used_is_refused_by_its_place(read, rows, error, words):
    whole = error is BadSyntax
    said = refusal(read, of=error, document=rows) if whole else refusal(read, rows, of=error)
    assert words in said and said.startswith("arm.srdf: ")


JOINTS = '<joint name="shoulder" value="0.3"/><joint name="lift" value="0.05"/>'


def state(inner=JOINTS, name="home", group="arm"):
    return f'<group_state name="{name}" group="{group}">{inner}</group_state>'


@pytest.mark.parametrize(("name", "called"), [("arm", ""), ("other", ""), ("other", "left")])
def test_an_srdf_that_names_another_robot_is_warned_of(tmp_path, name, called):
    """Robots of one maker call their links alike; the name that the case gives is its own affair."""
    row = disable("base", "upper", "User")
    keys = "self_clearance: true, srdf: arm.srdf" + (f", name: {called}" if called else "")
    text = f'<robot name="{name}">{row}</robot>'
    case = changed("arm.urdf", f"arm.urdf, {keys}")
    made = load_small(tmp_path, case, urdf=TWO_JOINTS, arm__srdf=text)
    found = [one.line for one in notices_of(made) if one.kind == "srdf"]
    assert len(found) == (name == "other")
    for line in found:
        assert "names another robot, 'other': is it the right file?" in line and "CL435" in line


def srdf(*states):
    return f'<robot name="arm">{"".join(states)}</robot>'


HOME = srdf(state(), state('<joint name="lift" value="0.02"/>', "open", "hand"))


def load(
    folder, joints="state: home", document=HOME, trajectory="time,shoulder\n0,0\n1,0.5\n", keys=""
):
    case = changed("urdf: arm.urdf", f"urdf: arm.urdf, srdf: arm.srdf, joints: {{{joints}}}{keys}")
    return load_small(folder, case, urdf=TWO_JOINTS, arm__srdf=document, trajectory=trajectory)


def test_joints_rest_where_the_state_says_and_a_note_says_so(tmp_path):
    case = load(tmp_path)
    assert case.robots[0].fixed_positions == {"lift": 0.05}
    (note,) = [note for note in case.notes if "by state" in note]
    assert note == (
        "arm.srdf: by state 'home' rest lift 0.05; the case or the trajectory says more of shoulder"
    )
    assert "arm.srdf" in [source.path for source in case.sources]


@pytest.mark.parametrize(
    ("joints", "lift"),
    [
        ("state: home", 0.05),
        ("state: arm/home", 0.05),
        ("state: [open]", 0.02),
        ("state: home, lift: 0.01", 0.01),
        ("lift: 0.01", 0.01),
    ],
)
def test_a_value_goes_before_a_state(tmp_path, joints, lift):
    keys = "" if "state" in joints else ", self_clearance: true"
    assert load(tmp_path, joints, keys=keys).robots[0].fixed_positions == {"lift": lift}


@pytest.mark.parametrize(
    ("joints", "fault", "says"),
    [
        ("state: hme", UnknownState, "robot.joints.state: arm.srdf: unknown state 'hme'; did you mean 'home'?"),
        ("state: [home, open]", BadInput, "joint 'lift' is at 0.05 in a state before and at 0.02 in 'hand/open'"),
        ("state: []", BadInput, "robot.joints.state: [] is given; names of states"),
        ("state: 1", BadInput, "robot.joints: unknown joint 'state'"),
        ("state: home, lift: x", BadInput, "robot.joints.lift: 'x' is given"),
    ],
)  # fmt: skip
def test_what_is_wrong_is_told_in_one_line(tmp_path, joints, fault, says):
    with pytest.raises(fault) as caught:
        load(tmp_path, joints, keys=", self_clearance: true" if joints == "state: 1" else "")
    assert says in str(caught.value)


def test_a_name_of_several_groups_needs_the_group(tmp_path):
    document = srdf(state(), state('<joint name="lift" value="0.02"/>', group="hand"))
    with pytest.raises(UnknownState, match="there are 2 states 'home'; one of arm/home, hand/home"):
        load(tmp_path, document=document)
    case = load(tmp_path, "state: hand/home", document)
    assert case.robots[0].fixed_positions == {"lift": 0.02}


def test_joints_that_cannot_be_set_are_left_out_with_a_note(tmp_path):
    more = '<joint name="flange" value="1"/><joint name="root_joint" value="0 0 1 0 0 0 1"/>'
    case = load(tmp_path, document=srdf(state(JOINTS + more)))
    assert case.robots[0].fixed_positions == {"lift": 0.05}
    assert any("cannot be set are left out: flange, root_joint" in note for note in case.notes)
    with pytest.raises(BadInput, match="'arm/home' speaks of no joint that robot 'arm' can move"):
        load(tmp_path, document=srdf(state(more)))


TURNED = "{xyz: [1, 2, 0], rpy: [0, 0, 0.5]}"


@pytest.mark.parametrize(
    ("value", "base", "is_told"),
    [
        ("0 0 0.4792 0 0 0 1", "{}", True),
        ("0 0 0.4792 0 0 0 1", "{xyz: [0, 0, 0.4792]}", False),
        ("1 2 0.5", "{xyz: [1, 2, 0]}", True),
        ("1 2 0.5", TURNED, False),
        (f"1 2 0 0 0 {np.sin(0.25)} {np.cos(0.25)}", TURNED, False),
        ("0 0 0", "{xyz: [1, 2, 0]}", False),
    ],
)
@pytest.mark.parametrize("asked", ["joints", "start_state"])
def test_a_state_that_puts_the_base_elsewhere_than_the_case_is_suspect(
    tmp_path, asked, value, base, is_told
):
    at_home = state(f'{JOINTS}<joint name="root" value="{value}"/>')
    keys, start = (
        ("joints: {state: home}", "") if asked == "joints" else ("", ", start_state: home")
    )
    case = changed("urdf: arm.urdf", f"urdf: arm.urdf, srdf: arm.srdf, base: {base}, {keys}")
    case = case.replace("path.csv", f"path.csv{start}")
    table = "time,shoulder\n0.5,0\n1,0.5\n" if start else "time,shoulder\n0,0\n1,0.5\n"
    read = load_small(tmp_path, case, urdf=TWO_JOINTS, arm__srdf=srdf(at_home), trajectory=table)
    told = [one for one in notices_of(read) if one.kind == "frame"]
    assert [(one.severity, "joint 'root'" in one.text) for one in told] == (
        [(Severity.SUSPECT, True)] * is_told
    )


@pytest.mark.parametrize("kind", ["planar", "floating", "fixed"])
@pytest.mark.parametrize("base", ["", ", base: {xyz: [0, 0, 0]}"])
def test_a_base_that_moves_by_the_srdf_and_is_placed_by_nobody_is_warned_of(tmp_path, kind, base):
    document = srdf(
        f'<virtual_joint name="root" type="{kind}" parent_frame="odom" child_link="base"/>'
    )
    case = changed("urdf: arm.urdf", f"urdf: arm.urdf, srdf: arm.srdf, self_clearance: true{base}")
    read = load_small(tmp_path, case, arm__srdf=document)
    told = [one for one in notices_of(read) if "virtual joint 'root'" in one.text]
    assert len(told) == (kind != "fixed" and not base)


@pytest.mark.parametrize(
    ("inner", "fault", "says"),
    [
        ('<joint name="lift" value="x"/>', BadShape, "joint 'lift': value='x' is given; a number"),
        ('<joint name="lift" value="1_0"/>', BadShape, "value='1_0'"),
        ('<joint name="lift"/>', BadShape, "value=None is given"),
        ('<joint name="lift" value="nan"/>', BadInput, "finite numbers are needed"),
        ('<joint value="1"/>', MissingKey, "<joint> has no name"),
        ('<joint name="lift" value="1"/><joint name="lift" value="1"/>', BadInput, "there twice"),
    ],
)
def test_values_are_checked_where_they_stand(tmp_path, inner, fault, says):
    assert says in refusal(load, tmp_path, document=srdf(state(), state(inner, "b")), of=fault)

"""Named states of an SRDF: where joints rest, what goes before them, and what is refused."""

import pytest

from clearance.errors import BadInput, BadShape, MissingKey, UnknownState
from tests.formats.making_case import TWO_JOINTS, changed, load_small

JOINTS = '<joint name="shoulder" value="0.3"/><joint name="lift" value="0.05"/>'


def state(inner=JOINTS, name="home", group="arm"):
    return f'<group_state name="{name}" group="{group}">{inner}</group_state>'


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
        ("state: hand/home", UnknownState, "unknown state 'hand/home'; did you mean"),
        ("state: [home, open]", BadInput, "joint 'lift' is at 0.05 in a state before and at 0.02 in 'hand/open'"),
        ("state: []", BadInput, "robot.joints.state: [] is given; names of states"),
        ("state: [1]", BadInput, "robot.joints.state: [1] is given"),
        ("state: 1", BadInput, "robot.joints: unknown joint 'state'"),
        ("state: home, lift: x", BadInput, "robot.joints.lift: 'x' is given"),
    ],
)  # fmt: skip
def test_what_is_wrong_is_told_in_one_line(tmp_path, joints, fault, says):
    with pytest.raises(fault) as caught:
        load(tmp_path, joints, keys=", self_clearance: true" if joints == "state: 1" else "")
    assert says in str(caught.value) and "\n" not in str(caught.value)


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


@pytest.mark.parametrize(
    ("inner", "fault", "says"),
    [
        ('<joint name="lift" value="x"/>', BadShape, "joint 'lift': value='x' is given; a number"),
        ('<joint name="lift" value="1_0"/>', BadShape, "value='1_0'"),
        ('<joint name="lift"/>', BadShape, "value=None is given"),
        ('<joint name="lift" value="nan"/>', BadInput, "a finite number"),
        ('<joint value="1"/>', MissingKey, "<joint> has no name"),
        ('<joint name="lift" value="1"/><joint name="lift" value="1"/>', BadInput, "there twice"),
    ],
)
def test_values_are_checked_where_they_stand(tmp_path, inner, fault, says):
    with pytest.raises(fault) as caught:
        load(tmp_path, document=srdf(state(), state(inner, "b")))
    assert f"arm.srdf: group_state[1]: {says}" in str(caught.value) or says in str(caught.value)

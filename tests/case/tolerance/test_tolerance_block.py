"""Tolerances of a case: what is read, which row holds, what is refused and how."""

import math

import pytest

from clearance.case.tolerance.block import preset
from clearance.case.tolerance.tolerance_file import with_tolerance
from clearance.errors import (
    BadDimension,
    BadInput,
    ClearanceError,
    MissingKey,
    NotFinite,
    UnknownJoint,
    UnknownKey,
    UnknownLink,
)
from clearance.formats.schema.tolerance import preset_names
from clearance.world.budget import (
    Budget,
    JointTolerance,
    ObstacleTolerance,
    PlacementTolerance,
    RobotTolerance,
)
from tests.formats.making import CASE
from tests.formats.making_case import TWO_JOINTS, load_small
from tests.formats.making_cell import load_cell

CONTROLLERS = """arm:
  ros__parameters:
    joints: [shoulder, lift]
    constraints: {shoulder: {trajectory: 0.02}, lift: {trajectory: 0.003}}
"""


def load(folder, block, **files):
    return load_small(folder, f"{CASE}tolerance: {block}\n", urdf=TWO_JOINTS, **files)


def budget(folder, block, **files):
    return load(folder, block, **files).tolerance


def arm(folder, block, **files):
    return budget(folder, block, **files).robots["arm"]


def fault(folder, block, **files):
    with pytest.raises(ClearanceError) as caught:
        load(folder, block, **files)
    return caught.value


def test_all_that_can_be_given(tmp_path):
    found = budget(tmp_path, """
  joints: {all: 0.0005, shoulder: 0.001}
  tracking: {lift: 0.002}
  kinematics: {all: {xyz: 0.0002, angle: 0.0001}}
  base: {xyz: 0.002, angle: 0.001}
  obstacles: {post: {xyz: 0.003, surface: 0.001}}
  links: {default: {surface: 0.0005}, upper: {surface: 0.002}}
  timing: {arm: 0.02}
  coverage: 2
  distributions: normal
  unproven_ok: true""")  # fmt: skip
    frame = PlacementTolerance(0.0002, 0.0001)
    assert found == Budget(
        robots={
            "arm": RobotTolerance(
                joints={
                    "shoulder": JointTolerance(0.001, 0.0, frame),
                    "lift": JointTolerance(0.0005, 0.002, frame),
                },
                base=PlacementTolerance(0.002, 0.001),
                surfaces={"base": 0.0005, "upper": 0.002},
                timing=0.02,
            )
        },
        obstacles={"post": ObstacleTolerance(PlacementTolerance(0.003), 0.001)},
        coverage=2.0,
        is_normal=True,
        unproven_ok=True,
    )


def test_a_row_leaves_as_they_are_the_numbers_that_it_does_not_give(tmp_path):
    found = budget(
        tmp_path, "{obstacles: {all: {xyz: 0.003, surface: 0.001}, 'po*': {angle: 0.01}}}"
    )
    place = PlacementTolerance(0.003, 0.01)
    assert found.obstacles == {"post": ObstacleTolerance(place, 0.001)}


def test_frames_of_fixed_joints_are_off_too(tmp_path):
    case = load_small(tmp_path, f"{CASE}tolerance: {{kinematics: {{all: {{xyz: 0.001}}}}}}\n")
    joints = case.tolerance.robots["arm"].joints
    assert {name: one.frame.xyz for name, one in joints.items()} == {
        "shoulder": 0.001,
        "flange": 0.001,
    }


def test_of_several_robots(tmp_path):
    rows = """tolerance:
  joints: {shoulder: 0.001, right/shoulder: 0.002}
  base: {all: {xyz: 0.001}, right: {angle: 0.01}}
  links: {"left/*": {surface: 0.003}}
  timing: {right: 0.02, door: 0.1}
limits:"""
    case = load_cell(tmp_path, "limits:", rows)
    left, right = case.tolerance.robots["left"], case.tolerance.robots["right"]
    assert left.joints == {"shoulder": JointTolerance(0.001)}
    assert right.joints == {"shoulder": JointTolerance(0.002)}
    assert (left.base, right.base) == (PlacementTolerance(0.001), PlacementTolerance(0.001, 0.01))
    assert left.surfaces == {"base": 0.003, "upper": 0.003} and right.surfaces == {}
    assert (left.timing, right.timing) == (0.0, 0.02)
    assert case.tolerance.obstacles["door"].timing == 0.1


def test_tracking_of_a_controllers_file(tmp_path):
    found = budget(tmp_path, "{tracking: {file: c.yaml, lift: 0.001}}", c__yaml=CONTROLLERS)
    joints = found.robots["arm"].joints
    assert (joints["shoulder"].tracking, joints["lift"].tracking) == (0.02, 0.001)
    assert found.sources == ("path tolerances of controllers in c.yaml",)


def test_tracking_of_the_controllers_that_the_robot_names(tmp_path):
    text = CASE.replace("urdf: arm.urdf", "urdf: arm.urdf, controllers: c.yaml")
    found = load_small(
        tmp_path,
        f"{text}tolerance: {{tracking: controllers}}\n",
        urdf=TWO_JOINTS,
        c__yaml=CONTROLLERS,
    ).tolerance
    assert found.robots["arm"].joints["shoulder"].tracking == 0.02
    without = load_small(tmp_path, text, urdf=TWO_JOINTS, c__yaml=CONTROLLERS)
    assert without.tolerance is None


def test_joints_of_which_no_tracking_is_given_are_told(tmp_path):
    only = CONTROLLERS.replace("[shoulder, lift]", "[shoulder]").replace(
        ", lift: {trajectory: 0.003}", ""
    )
    found = budget(tmp_path, "{tracking: {file: c.yaml}}", c__yaml=only)
    assert found.sources == ("path tolerances of controllers in c.yaml; none of joints lift",)


def test_presets_come_before_numbers_and_are_named_with_their_source(tmp_path):
    found = budget(tmp_path, "{presets: [uncalibrated_arm], links: {upper: {surface: 0.004}}}")
    assert found.robots["arm"].surfaces == {"base": 0.002, "upper": 0.004}
    assert found.sources == (f"preset uncalibrated_arm: {preset('uncalibrated_arm').line}",)


@pytest.mark.parametrize("name", preset_names())
def test_every_preset_can_be_taken_and_has_a_source(tmp_path, name):
    assert budget(tmp_path, f"{{presets: [{name}]}}").sources[0].startswith(f"preset {name}: ")
    assert len(preset(name).source) > 30


@pytest.mark.parametrize(
    ("block", "kind", "told"),
    [
        ("", BadInput, "case.yaml: tolerance: nothing is given"),
        ("{joints: {all: -0.001}}", BadInput, "tolerance.joints.all: -0.001 is given; greater than"),
        ("{joints: {all: .inf}}", NotFinite, "tolerance.joints.all: inf is given"),
        ("{joints: {all: small}}", BadInput, "tolerance.joints.all: 'small' is given; a number"),
        ("{joints: {shoulder: 0.3}}", BadDimension, "joints: shoulder: 0.3 rad is given; at most 0.2 rad"),
        ("{joints: {lift: 0.6}}", BadDimension, "0.6 m is given; at most 0.5 m"),
        ("{joints: {sholder: 0.001}}", UnknownJoint, "did you mean 'shoulder'?"),
        ("{joints: {all: 0.1, default: 0.1}}", BadInput, "both all and default are given; one of them"),
        ("{joint: {all: 0.1}}", UnknownKey, "unknown key 'joint'; did you mean 'joints'?"),
        ("{base: {xyz: 2}}", BadDimension, "tolerance.base.xyz: 2 m is given; at most 0.5 m"),
        ("{base: {xyz: ~}}", BadInput, "tolerance.base.xyz: nothing is given"),
        ("{base: {amr: {xyz: 0.001}}}", BadInput, "base: no robot matches 'amr'; did you mean 'arm'?"),
        ("{links: {uper: {surface: 0.001}}}", UnknownLink, "did you mean 'upper'?"),
        ("{links: {upper: 0.001}}", BadInput, "links.upper: 0.001 is given; a mapping is needed"),
        ("{obstacles: {post: {}}}", BadInput, "obstacles.post: nothing is given; one of xyz, angle, surface"),
        ("{timing: {post: 0.1}}", BadInput, "timing: no actor matches 'post'"),
        ("{timing: {arm: 100}}", BadDimension, "100 s is given; at most 60 s"),
        ("{presets: [iso9283_tipical]}", BadInput, "did you mean 'iso9283_typical'?"),
        ("{joints: {all: 0.001}, distributions: gauss}", BadInput, "'uniform' or 'normal' is needed"),
        ("{tracking: controlers}", BadInput, "did you mean 'controllers'?"),
        ("{tracking: controllers}", MissingKey, "tolerance: tracking: no robot of the case has controllers"),
        ("{tracking: {file: ~}}", BadInput, "tolerance.tracking.file: nothing is given"),
        ("{tracking: {elbow: 0.1}}", UnknownJoint, "tracking: no joint that moves matches 'elbow'"),
        ("{tracking: {file: none.yaml}}", BadInput, "tracking: file: none.yaml: there is no file"),
    ],
)  # fmt: skip
def test_what_is_refused_and_how(tmp_path, block, kind, told):
    found = fault(tmp_path, block)
    assert isinstance(found, kind) and told in str(found), str(found)


@pytest.mark.parametrize(
    ("old", "new", "told"),
    [
        ("{shoulder: {trajectory: 0.02}, lift: {trajectory: 0.003}}", "{}", "no controller in it bounds"),
        (", lift: {trajectory: 0.003}", "", "controllers let joint 'lift' as far off the path as it goes"),
        ("0.02", "0.3", "shoulder: 0.3 rad is given; at most 0.2 rad"),
    ],
)  # fmt: skip
def test_controllers_that_say_too_little(tmp_path, old, new, told):
    files = {"c__yaml": CONTROLLERS.replace(old, new)}
    assert told in str(fault(tmp_path, "{tracking: {file: c.yaml}}", **files))


def test_controllers_of_other_joints_are_refused(tmp_path):
    others = CONTROLLERS.replace("shoulder", "elbow").replace("lift", "wrist")
    found = fault(tmp_path, "{tracking: {file: c.yaml}}", c__yaml=others)
    assert isinstance(found, UnknownJoint) and "c.yaml: it names no joint of the case" in str(found)


def test_a_file_takes_the_place_of_the_block(tmp_path):
    case = load(tmp_path, "{joints: {all: 0.001}}")
    own = tmp_path / "t.yaml"
    for text in ("joints: {all: 0.002}\n", "tolerance:\n  joints: {all: 0.002}\n"):
        own.write_text(text)
        changed = with_tolerance(case, own)
        assert changed.tolerance.robots["arm"].joints["lift"].position == 0.002
        assert changed.notes[-1] == "tolerances of t.yaml take the place of the case's own"
        assert "t.yaml" in [source.path for source in changed.sources]


def test_plain_data_and_a_budget_do_too(tmp_path):
    case = load_small(tmp_path)
    given = with_tolerance(case, {"joints": {"all": 0.002}})
    assert given.tolerance.robots["arm"].joints == {"shoulder": JointTolerance(0.002)}
    assert (
        given.notes == case.notes
        and with_tolerance(case, given.tolerance).tolerance is given.tolerance
    )


@pytest.mark.parametrize(
    ("given", "told"),
    [
        ({"joints": {"al": 0.1}}, "tolerance: joints: no joint that moves matches 'al'"),
        ({}, "tolerance: no error is given"),
        (3, "tolerances are 3; a mapping"),
        (Budget({"amr": RobotTolerance()}), "tolerance: unknown robot 'amr'; did you mean 'arm'?"),
        (Budget({"arm": RobotTolerance({"elbow": JointTolerance()})}), "tolerance: arm: unknown joint 'elbow'"),
        (Budget({"arm": RobotTolerance(timing=-1.0)}), "tolerance: arm: -1 s is given; 0 or more"),
        (Budget({"arm": RobotTolerance(timing=math.nan)}), "tolerance: arm: nan s is given"),
        (Budget({"arm": RobotTolerance({"shoulder": JointTolerance(0.5)})}), "0.5 rad is given"),
        (Budget(coverage=0.0), "a coverage of 0"),
        (Budget(obstacles={"post": ObstacleTolerance(surface=1.0)}), "tolerance: post: 1 m is given"),
    ],
)  # fmt: skip
def test_what_is_refused_beside_a_file(tmp_path, given, told):
    case = load_small(tmp_path)
    with pytest.raises(BadInput) as caught:
        with_tolerance(case, given)
    assert told in str(caught.value)


@pytest.mark.parametrize(
    ("text", "told"),
    [
        ("", "t.yaml: nothing is given"),
        ("- 1\n", "t.yaml: [1] is given"),
        ("tolerance: 3\n", "t.yaml: tolerance: 3 is given"),
    ],
)
def test_a_file_that_is_no_block_is_refused(tmp_path, text, told):
    case, own = load_small(tmp_path), tmp_path / "t.yaml"
    own.write_text(text)
    with pytest.raises(BadInput) as caught:
        with_tolerance(case, own)
    assert told in str(caught.value)

"""joint_limits.yaml and ros2_controllers.yaml: what narrows, what is exceeded, what is kept, what is refused."""

import math

import pytest

from clearance import check, load_case
from clearance.errors import BadInput, MissingKey, UnknownJoint, UnknownKey
from clearance.formats.robot.limit_files import parse_controllers, parse_joint_limits
from clearance.world.notice import Severity
from clearance.world.placed_robot import MotionLimit, PathTolerance
from clearance.world.plausibility import notices_of
from tests.formats.making_case import TWO_JOINTS, changed, load_small
from tests.formats.refusal import refusal

LIMITS = """# as MoveIt's assistant writes it
default_velocity_scaling_factor: 0.1
joint_limits:
  shoulder:
    has_position_limits: true
    min_position: -0.5
    max_position: 2
    has_velocity_limits: true
    max_velocity: 0.4
    has_acceleration_limits: false
    max_acceleration: 3
  lift: {has_velocity_limits: True, max_velocity: 1.0, has_acceleration_limits: true, max_acceleration: 0.5}
"""
CONTROLLERS = """controller_manager:
  ros__parameters: {update_rate: 100, arm: {type: joint_trajectory_controller/JointTrajectoryController}}
arm:
  ros__parameters:
    joints: [shoulder, lift]
    constraints:
      stopped_velocity_tolerance: 0.01
      goal_time: 0.0
      shoulder: {trajectory: 0.2, goal: 0.1}
"""
PATH = "time,shoulder,lift\n0,0,0\n1,0.3,0\n2,0.8,0.05\n"


def load(
    folder, limits=LIMITS, controllers=None, trajectory=PATH, rule="warn", urdf=TWO_JOINTS, **others
):
    keys = "" if limits is None else ", joint_limits: limits.yaml"
    keys += "" if controllers is None else ", controllers: controllers.yaml"
    case = changed(
        "urdf: arm.urdf", f"urdf: arm.urdf{keys}", "warn: 0.02", f"warn: 0.02, joints: {rule}"
    )
    files = {"limits__yaml": limits or "", "controllers__yaml": controllers or ""}
    return load_small(folder, case, urdf=urdf, trajectory=trajectory, **files, **others)


def texts(case, severity):
    return [one.text for one in notices_of(case) if one.severity is severity]


def test_the_narrower_limits_hold(tmp_path):
    case = load(tmp_path)
    shoulder, lift = case.robots[0].robot.moving_joints
    assert (shoulder.lower, shoulder.upper, lift.lower, lift.upper) == (-0.5, 1.0, 0.0, 0.1)
    moving = {"shoulder": MotionLimit(0.4), "lift": MotionLimit(1.0, 0.5)}
    assert case.robots[0].motion_limits == moving
    told = " | ".join(case.notes)
    for said in (
        "limits.yaml: limits taken: position of shoulder; velocity of all joints; acceleration of lift",
        "wider than the robot file's, which stay: position of shoulder",
        "not used: max_acceleration",
        "accelerations are not compared with their limits: the trajectory has no velocities",
    ):
        assert said in told


WIDE = (-3.839724354, 3.839724354)


@pytest.mark.parametrize(
    ("joint", "own", "limits", "odd"),
    [
        ("shoulder", (-1, 1), (-30, 30), "position of shoulder"),
        ("shoulder", (-1, 1), (-0.5, 10.0), "position of shoulder"),
        ("shoulder", (-1, 1), (-6.2832, 6.2832), ""),
        ("shoulder", (-1, 1), (-0.5, 0.5), ""),
        # rounded up, and in full turns
        ("shoulder", WIDE, (-3.84, 3.84), ""),
        ("shoulder", WIDE, (-4.36, 4.36), ""),
        ("shoulder", (0.5445, 4.5169), (0.54, 4.52), ""),
        ("shoulder", (-6.2832, 6.2832), (-6.3, 6.3), ""),
        ("shoulder", WIDE, (-3.8, 15), "is 15 beside the robot's own 3.8"),
        ("shoulder", (-0.1, 0.1), (-5, 0.1), "is -5 beside the robot's own -0.1"),
        # a continuous joint has no limits of its own
        ("shoulder", None, (-12.57, 12.57), ""),
        ("shoulder", None, (-90, 90), "position of shoulder is -90, position of shoulder is 90; "),
        ("lift", (-1, 1), (-0.0001, 0.1), ""),
        ("lift", (-1, 1), (-0.02, 0.5), ""),
        ("lift", (-1, 1), (0, 100), "position of lift is 100 beside the robot's own 0.1"),
    ],
)
def test_limits_in_another_unit_are_suspect_where_the_robots_own_stay(
    tmp_path, joint, own, limits, odd
):
    if own is None:
        urdf = TWO_JOINTS.replace('type="revolute"', 'type="continuous"', 1)
    else:
        urdf = TWO_JOINTS.replace('lower="-1" upper="1"', 'lower="{}" upper="{}"'.format(*own), 1)
    row = "has_position_limits: true, min_position: {}, max_position: {}".format(*limits)
    told = texts(
        load(tmp_path, f"joint_limits: {{{joint}: {{{row}}}}}\n", urdf=urdf), Severity.SUSPECT
    )
    assert len(told) == bool(odd)
    assert all(one.startswith("CHECK UNITS: limits.yaml: ") and odd in one for one in told)


@pytest.mark.parametrize(
    ("speed", "is_odd"), [(60.0, True), (3.0, False), (100.0, False), (1e6, False)]
)
def test_speeds_in_degrees_are_suspect_where_the_robots_own_stay(tmp_path, speed, is_odd):
    limits = f"joint_limits: {{shoulder: {{has_velocity_limits: true, max_velocity: {speed}}}}}\n"
    urdf = TWO_JOINTS.replace('upper="1.0"', 'upper="1.0" velocity="2.0"', 1)
    case = load(tmp_path, limits, urdf=urdf)
    assert any("velocity of shoulder" in one for one in texts(case, Severity.SUSPECT)) is is_odd
    told = " | ".join(case.notes)
    assert "limits taken: none" in told
    assert "wider than the robot file's, which stay: velocity of shoulder" in told


def test_what_is_exceeded_is_a_warning_or_a_violation(tmp_path):
    says = "joint 'shoulder' moves at up to 0.5 rad/s, its limit is 0.4, in 1 of 2 intervals"
    assert texts(load(tmp_path), Severity.WARNING) == [says]
    case = load(tmp_path, rule="fail")
    assert texts(case, Severity.VIOLATED) == [says]
    run_of = check(case)
    assert run_of.verdict.exit_code == 1 and not run_of.passed
    narrow = load(tmp_path, LIMITS.replace("max_position: 2", "max_position: 0.7"))
    assert any(
        "leaves its limits -0.5 to 0.7 rad" in one for one in texts(narrow, Severity.WARNING)
    )


def test_a_faster_clock_counts(tmp_path):
    limits = LIMITS.replace("max_velocity: 0.4", "max_velocity: 0.6")
    assert texts(load(tmp_path, limits), Severity.WARNING) == []
    path = tmp_path / "case.yaml"
    path.write_text(path.read_text().replace("file: path.csv", "file: path.csv, rate: 2"))
    (text,) = texts(load_case(path), Severity.WARNING)
    assert "moves at up to 1 rad/s" in text


def test_on_cubics_speed_and_acceleration_are_those_between_the_samples(tmp_path):
    path = (
        "time,shoulder,lift,shoulder/velocity,lift/velocity\n"
        "0,0,0,0,0\n1,0.3,0.08,0,0\n2,0.3,0.08,0,0\n"
    )
    case = load(tmp_path, trajectory=path)
    (text,) = texts(case, Severity.WARNING)  # 6 D s (1 - s): 1.5 D at the middle, 6 D at the ends
    assert "'shoulder' moves at up to 0.45 rad/s, its limit is 0.4, in 1 of 2 intervals" in text
    (text,) = texts(
        load(tmp_path, LIMITS.replace("0.5}", "0.4}"), trajectory=path), Severity.WARNING
    )
    assert "'lift' accelerates by up to 0.48 m/s², its limit is 0.4, in 1 of 2" in text


def test_a_follower_has_limits_of_its_own(tmp_path):
    urdf = TWO_JOINTS.replace(
        '<limit lower="0" upper="0.1"/>', '<mimic joint="shoulder" multiplier="-3"/>'
    )
    limits = "joint_limits: {lift: {has_velocity_limits: true, max_velocity: 1}}"
    keys = "urdf: arm.urdf, joint_limits: limits.yaml"
    case = load_small(tmp_path, changed("urdf: arm.urdf", keys), urdf=urdf, limits__yaml=limits)
    (text,) = texts(case, Severity.WARNING)
    assert "joint 'lift' moves at up to 1.5 m/s" in text


SLOW = TWO_JOINTS.replace('velocity="1"', 'velocity="{}"')
"""The shoulder's greatest speed is in the robot's own file."""


@pytest.mark.parametrize(
    ("own", "limits", "most"),
    [
        ("0.4", None, "0.4"),
        ("0.4", LIMITS.replace("max_velocity: 0.4", "max_velocity: 0.45"), "0.4"),
        ("0.45", LIMITS, "0.4"),
        ("0", None, None),
        ("0.5", None, None),
    ],
)
def test_a_speed_beyond_the_urdf_is_told_as_one_beyond_the_file(tmp_path, own, limits, most):
    """The narrower of both counts; 0 is what exporters write for no limit."""
    assert "{}" in SLOW
    urdf = SLOW.format(own)
    case = load(tmp_path, limits, urdf=urdf)
    says = f"joint 'shoulder' moves at up to 0.5 rad/s, its limit is {most}, in 1 of 2 intervals"
    assert texts(case, Severity.WARNING) == ([says] if most else [])
    violated = texts(load(tmp_path, limits, rule="fail", urdf=urdf), Severity.VIOLATED)
    assert violated == ([says] if most else [])


IN_NODE = "/**:\n  ros__parameters:\n    robot_description_planning:\n{}"


@pytest.mark.parametrize("wrapped", ["robot_description_planning:\n{}", IN_NODE])
def test_what_ros_wraps_it_in_is_taken_off(wrapped):
    depth = wrapped.count("\n") * 2
    inner = "\n".join(" " * depth + line for line in LIMITS.splitlines())
    assert parse_joint_limits(wrapped.format(inner).encode()) == parse_joint_limits(LIMITS.encode())


def test_degrees_that_are_tagged_are_degrees():
    found = parse_joint_limits(
        LIMITS.replace("max_velocity: 0.4", "max_velocity: !degrees  90.0").encode()
    )
    assert found["shoulder"].motion.velocity == math.pi / 2


def test_tolerances_are_kept_and_told(tmp_path):
    case = load(tmp_path, None, CONTROLLERS)
    assert case.robots[0].path_tolerances == {
        "shoulder": PathTolerance(0.2, 0.1), "lift": PathTolerance(math.inf, math.inf),
    }  # fmt: skip
    (note,) = [note for note in case.notes if note.startswith("controllers.yaml")]
    assert note == (
        "controllers.yaml: controllers arm let joints leave the path: shoulder 0.2 rad at most; lift as far as "
        "they go; no clearance is lessened by that"
    )


def test_tolerances_of_joints_that_the_robot_cannot_move_are_left_out(tmp_path):
    notes = load(tmp_path, None, CONTROLLERS.replace("shoulder: {", "elbow: {")).notes
    assert any("joints that the robot cannot move are left out: elbow" in one for one in notes)


def test_controllers_of_ros_1_and_several_of_one_joint(tmp_path):
    flat = "arm: {type: x, joints: [shoulder], constraints: {goal_time: 1, shoulder: {trajectory: 0.05}}}\n"
    (one,) = parse_controllers(flat.encode())
    assert one.tolerances == {"shoulder": PathTolerance(0.05, math.inf)}
    case = load(tmp_path, None, flat + CONTROLLERS.replace("\narm:", "\nother:"))
    assert case.robots[0].path_tolerances["shoulder"] == PathTolerance(0.2, math.inf)


@pytest.mark.parametrize(
    ("old", "new", "fault", "says"),
    [
        ("max_velocity: 0.4", "max_velocty: 0.4", UnknownKey, "unknown field 'max_velocty'; did you mean"),
        ("max_velocity: 0.4", "max_velocity: fast", BadInput, "max_velocity: 'fast' is given; a number"),
        ("max_velocity: 0.4", "max_velocity: 0", BadInput, "max_velocity is 0; above 0"),
        ("    max_velocity: 0.4\n", "", MissingKey, "has_velocity_limits is true, but 'max_velocity' is missing"),
        ("max_position: 2", "max_position: -1", BadInput, "min_position -0.5 is above max_position -1"),
        ("min_position: -0.5", "min_position: 1.5", BadInput, "lies outside the robot's -1 to 1"),
        ("has_position_limits: true", "has_position_limits: yes", BadInput, "'yes' is given; true or false"),
        ("joint_limits:", "limits:", MissingKey, "'joint_limits' is missing; MoveIt's file"),
        ("max_velocity: 0.4", "max_velocity: !feet 20", BadInput, "line 9: the tag '!feet'"),
        ("max_velocity: 0.4", "max_velocity: !degrees x", BadInput, "max_velocity: 'x' is given; a number"),
        ("trajectory: 0.2", "trajectry: 0.2", UnknownKey, "arm: constraints: shoulder: unknown field 'trajectry'"),
        ("trajectory: 0.2", "trajectory: -1", BadInput, "trajectory: -1 is given; 0 or more"),
        ("[shoulder, lift]", "shoulder", BadInput, "joints: 'shoulder' is given; a list of names"),
    ],
)  # fmt: skip
def test_bad_files_are_one_line(tmp_path, old, new, fault, says):
    if old in LIMITS:
        files, place = (LIMITS.replace(old, new),), "robot.joint_limits: limits.yaml: "
    else:
        files, place = (
            (None, CONTROLLERS.replace(old, new)),
            "robot.controllers: controllers.yaml: ",
        )
    told = refusal(load, tmp_path, *files, of=fault)
    assert says in told and place in told


def test_files_of_another_robot_are_refused(tmp_path):
    others = LIMITS.replace("shoulder", "elbow").replace("lift", "x")
    with pytest.raises(UnknownJoint, match="no joint that the robot can move, but of 'elbow'"):
        load(tmp_path, others)
    with pytest.raises(UnknownJoint, match="unknown joint 'Lift'; did you mean 'lift'"):
        load(tmp_path, LIMITS.replace("lift", "Lift"))
    with pytest.raises(MissingKey, match="no controller in it has 'joints' or 'constraints'"):
        load(tmp_path, None, LIMITS)

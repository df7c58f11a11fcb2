"""Motions of programs at their edges: lines that zones use up, moves that go nowhere, half turns, joints that are
told."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

import clearance as cl
from clearance.programs.inverse import nearest_joints
from clearance.programs.joint_way import joint_law, unknown_speeds
from clearance.programs.motion import ProgramMotion
from clearance.programs.moves import JointMove, Move, PathMove, Program
from clearance.programs.time_law import Limits
from clearance.report.motion_file import motion_content
from clearance.world.cubic import positions_along
from clearance.world.motion import kinematic_motion
from clearance.world.placed_robot import PlacedRobot
from tests.programs.arms import START, arm, first_pose, motion, posture, shifted


def tool(found: ProgramMotion, positions: np.ndarray, name: str = "heron6") -> np.ndarray:
    one = arm(name)
    columns = [found.trajectory.joint_names.index(joint.name) for joint in one.joints]
    return one.poses(np.atleast_2d(positions)[:, columns])


def lines(pose: np.ndarray, ways: list, turn=(0.0, 0.0, 0.0), **more) -> list[Move]:
    """Lines one after another, all but the last with a zone."""
    found: list[Move] = []
    for i, way in enumerate(ways):
        pose = shifted(pose, way, turn)
        zone = more.get("zone", 0.0) if i + 1 < len(ways) else 0.0
        found.append(
            PathMove(f"LIN {i + 1}", f"moves[{i}]", pose, zone=zone, hold=more.get("hold"))
        )
    return found


def test_zones_may_use_up_the_line_between_them():
    ways = [(0.0, 0.02, 0.0), (0.0, 0.0, -0.02), (0.0, 0.02, 0.0), (0.0, 0.0, 0.02)]
    moves = lines(first_pose(), ways, zone=0.1)
    found = motion(moves)
    corners = found.trajectory.corners
    assert [corner.radius for corner in corners] == pytest.approx([0.01] * 3)
    assert corners[1].start == corners[0].end and corners[2].start == corners[1].end
    assert all("cut from 100 mm" in note for note in found.notes) and len(found.notes) == 3
    measured = kinematic_motion(PlacedRobot(arm("heron6").robot, found.trajectory))
    (note,) = motion_content((measured,), "out.csv").notes
    assert note.startswith("one path through 3 corner zones of the program")
    at = tool(found, found.trajectory.positions)
    assert np.abs(at[-1] - moves[-1].pose).max() < 1e-9
    steps = np.linalg.norm(np.diff(at[:, :3, 3], axis=0), axis=1)
    assert steps.max() <= 0.002 * (1.0 + 1e-9)


def test_a_zone_beside_a_line_of_no_length_is_refused():
    moves = lines(first_pose(), [(0.0, 0.02, 0.0), (0.0, 0.0, 0.0)], (0.1, 0.0, 0.0), zone=0.004)
    with pytest.raises(cl.ClearanceError, match="beside a line of no length"):
        motion(moves)


def test_a_joint_move_makes_half_a_turn_where_it_is():
    pose = first_pose() @ np.diag([1.0, -1.0, -1.0, 1.0])
    found = motion([JointMove("PTP 1", "moves[0]", pose=pose)])
    assert np.abs(tool(found, found.trajectory.positions[-1])[0] - pose).max() < 1e-9


def test_a_joint_that_is_at_0_but_for_rounding_is_told_as_0():
    start = (START[0], START[1], START[2], 0.0, START[4], START[5])
    found = motion([JointMove("PTP 1", "moves[0]", pose=first_pose("heron6", start))])
    told = dict(one.split() for one in found.notes[0].partition("]: ")[2].split(", "))
    assert abs(found.trajectory.positions[-1, 3]) < 1e-9 and told["joint_4"] == "0"
    assert float(told["joint_1"]) == pytest.approx(START[0], abs=1e-3)


def test_a_joint_asked_for_beyond_half_a_turn_is_found_there():
    """From 0 a search comes to -60 degrees as the nearest, which is 300 where the range asks for that turn."""
    one, draw = arm("heron6"), np.random.default_rng(11)
    for _ in range(10):
        joints = posture(one, draw)
        joints[5] = draw.uniform(1.1 * np.pi, 1.9 * np.pi)
        ranges = one.ranges.copy()
        ranges[5] = 0.0, 2.0 * np.pi
        ranges[:5] = joints[:5, None] + [-0.2, 0.2]
        found = nearest_joints(one, one.poses(joints[None])[0], np.zeros(6), ranges)
        assert np.abs(found - joints).max() < 1e-9


@pytest.mark.parametrize("by", [0.0, 0.02])
def test_a_corner_is_proven_where_a_joint_is_held_on_both_sides(by):
    one = arm("iiwa")
    start = tuple(posture(one, np.random.default_rng(0)))
    hold = {one.joints[2].name: start[2] + by}
    ways = [(0.0, 0.05, 0.0), (0.0, 0.0, 0.05)]
    path = lines(first_pose("iiwa", start), ways, zone=0.002, hold=hold)
    found = motion(path, "iiwa", start).trajectory
    (corner,) = found.corners
    assert 0.0005 < corner.links[one.link].way < 0.006
    column = found.joint_names.index(one.joints[2].name)
    at = found.positions[:, column] - start[2]
    assert at[-1] == pytest.approx(by, abs=1e-12) and (np.diff(at) >= -1e-12).all()
    with pytest.raises(cl.ClearanceError, match="other joints are held after the corner zone"):
        motion([path[0], replace(path[1], hold={})], "iiwa", start)


@pytest.mark.slow
def test_a_zone_too_wide_to_be_proven_is_passed_on_its_nominal_path_and_told():
    moves = lines(first_pose(), [(0.0, 0.12, 0.0), (0.0, 0.0, -0.12)], (0.4, 0.3, 0.0), zone=0.06)
    found = motion(moves).trajectory
    (span,) = found.unproven
    assert span.move == "LIN 1" and "60 mm is too wide" in span.why and not found.corners
    ends = tool(motion(moves), positions_along(found, np.array([span.start, span.end])))
    apart = np.linalg.norm(ends[:, :3, 3] - moves[0].pose[:3, 3], axis=1)
    assert apart == pytest.approx([0.06, 0.06], abs=1e-6)


def test_a_joint_that_stands_but_for_rounding_takes_no_time():
    joints = arm("heron6").own
    way = np.array([0.5, 2e-320, 0.0, -1e-30, 0.0, 0.0])
    with np.errstate(all="raise"):
        rate, _ = joint_law(joints, way, 0.5)
    assert rate == pytest.approx(0.5 * joints[0].velocity / 0.5)


@pytest.mark.parametrize("seconds", [20.6, 0.05])
def test_a_time_says_how_long_a_move_takes_however_fast_it_is(seconds):
    """A line keeps its acceleration of 1 m/s^2 unless the time is too short: 0.1 m in 0.05 s takes 160 m/s^2."""
    names = [joint.name for joint in arm("heron6").joints]
    joints = dict(zip(names, np.add(START, 0.3), strict=True))
    (line,) = lines(first_pose(), [(0.0, 0.1, 0.0)])
    spot = lines(first_pose(), [(0.0, 0.0, 0.0)], turn=(0.0, 0.0, 0.2))
    ptp = JointMove("PTP 1", "moves[0]", joints=joints, speed=0.1)
    for move in (line, spot[0], ptp):
        found = motion([replace(move, time=seconds)]).trajectory
        assert found.times[-1] == pytest.approx(seconds, abs=1e-9)
    found = motion([replace(line, time=seconds)])
    ramp = seconds / 2 - np.sqrt(max(seconds**2 / 4 - 0.1, 0.0))
    at = tool(found, positions_along(found.trajectory, np.array([0.5 * ramp, seconds / 2])))
    change = max(1.0, 0.4 / seconds**2)
    went = (at[:, :3, 3] - first_pose()[:3, 3])[:, 1]
    assert went == pytest.approx([change * ramp**2 / 8, 0.05], abs=1e-7)


def test_the_joint_that_goes_farthest_has_the_speed_that_is_asked_for():
    """0.6 rad at 0.5 rad/s and 1.4 rad/s^2 take 0.6 / 0.5 + 0.5 / 1.4 s."""
    names = [joint.name for joint in arm("heron6").joints]
    joints = dict(zip(names, START, strict=True)) | {
        names[0]: START[0] + 0.6,
        names[5]: START[5] - 0.5,
    }
    move = JointMove("PTP 1", "moves[0]", joints=joints, leading=Limits(0.5, 1.4))
    assert motion([move]).trajectory.times[-1] == pytest.approx(0.6 / 0.5 + 0.5 / 1.4, abs=1e-9)


def test_joints_without_a_greatest_speed_have_no_known_time_at_a_share_of_it():
    one = arm("heron6")
    names = [joint.name for joint in one.joints]
    joints = dict(zip(names, START, strict=True))
    slow = [
        replace(joint, velocity=np.inf if joint.name == names[2] else joint.velocity)
        for joint in one.robot.joints
    ]
    robot = replace(one.robot, joints=tuple(slow))
    ptp = JointMove("PTP 1", "moves[0]", joints=joints)
    for move, lacks in (
        (ptp, [names[2]]),
        (replace(ptp, time=2.0), []),
        (replace(ptp, leading=Limits(1, 1)), []),
    ):
        program = Program(one.link, one.link_from_tool, (move,), joints)
        assert unknown_speeds(robot, program) == lacks and not unknown_speeds(one.robot, program)

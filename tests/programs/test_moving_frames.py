"""Targets on a link that moves: joints follow by the pose of the tool on that link, and are proven as elsewhere.

Our arm stands beside a plate that turns about a slanted axis, both links of one robot.
"""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

import clearance as cl
from clearance.programs.motion import ProgramMotion
from clearance.programs.moves import JointMove, Move, PathMove
from clearance.world.cubic import positions_along
from clearance.world.robot import Joint, JointKind, Robot
from tests.made_cases import at
from tests.programs.arms import START, arm, first_pose, shifted, turned
from tests.programs.arms import motion as motion_of_arm
from tests.programs.exact_arm import joints_for, links_at, turn, vector_of
from tests.programs.test_corner import circle

AXIS = np.array([0.1, 0.2, 1.0]) / np.linalg.norm([0.1, 0.2, 1.0])
BESIDE = at(0.7, 0.1, 0.3, turned((0.2, -0.1, 0.4)))
"""Where the plate's joint is, seen from the robot's root."""


def with_plate(velocity: float = np.inf) -> Robot:
    robot = arm("heron6").robot
    root = robot.link_names[0]
    joint = Joint(
        "turn", JointKind.REVOLUTE, root, "plate", BESIDE, AXIS, -4.0, 4.0, velocity=velocity
    )
    return replace(robot, link_names=(*robot.link_names, "plate"), joints=(*robot.joints, joint))


def plate_at(angle: float) -> np.ndarray:
    """(4, 4) `root_from_plate`, in long double."""
    motion = np.eye(4, dtype=np.longdouble)
    motion[:3, :3] = turn(AXIS * np.longdouble(angle))
    return BESIDE.astype(np.longdouble) @ motion


def on_plate(way=(0.0, 0.0, 0.0), angle: float = 0.3, by=(0.0, 0.0, 0.0)) -> np.ndarray:
    """(4, 4) where the tool begins, seen from the plate at an angle, and moved and turned from there."""
    return shifted(np.linalg.inv(plate_at(angle).astype(float)) @ first_pose(), way, by)


def motion(moves: list[Move], robot: Robot | None = None) -> ProgramMotion:
    return motion_of_arm(moves, robot=robot or with_plate(), beside={"turn": 0.3})


def line(pose: np.ndarray, seen_from: str = "plate", **more) -> PathMove:
    return PathMove("LIN", "moves", pose, seen_from=seen_from, **more)


def columns(found: ProgramMotion, positions: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """(n, 6) joints of the arm, and (n,) the angle of the plate."""
    names = found.trajectory.joint_names
    own = [names.index(joint.name) for joint in arm("heron6").joints]
    return positions[:, own], positions[:, names.index("turn")]


@pytest.mark.parametrize("by", [0.0, 0.5, -0.8])
def test_between_samples_no_joint_is_farther_off_than_is_proven(by):
    start, end = on_plate(), on_plate((0.05, -0.04, 0.03), by=(0.1, 0.2, -0.1))
    arc = {"via": 0.5 * (start + end)[:3, 3] + [0.0, 0.02, 0.0], "along": False}
    for more in ({}, arc):
        found = motion([line(end, hold={"turn": 0.3 + by}, **more)])
        times = found.trajectory.times
        between = (times[:-1, None] + np.diff(times)[:, None] * [0.2, 0.5, 0.8]).ravel()[::5]
        joints, angles = columns(found, positions_along(found.trajectory, between))
        worst = 0.0
        for own, angle in zip(joints, angles, strict=True):
            if not by:
                assert angle == 0.3
                continue
            share = (np.longdouble(angle) - np.longdouble(0.3)) / np.longdouble(by)
            wanted = plate_at(angle) @ pose_at(start, end, share, more.get("via"))
            true = joints_for(arm("heron6"), (wanted[:3, :3], wanted[:3, 3]), own)
            worst = max(worst, float(np.abs(true - own).max()))
        assert worst <= found.trajectory.path_error < 1e-6 and not found.trajectory.unproven
        assert not by or found.trajectory.path_error < 3.0 * worst + 1e-12


def pose_at(start: np.ndarray, end: np.ndarray, share: float, via: np.ndarray | None) -> np.ndarray:
    """(4, 4) a pose on a line, or on the arc through a point, by its share, in long double."""
    start, end = start.astype(np.longdouble), end.astype(np.longdouble)
    found = np.eye(4, dtype=np.longdouble)
    found[:3, :3] = turn(share * vector_of(end[:3, :3] @ start[:3, :3].T)) @ start[:3, :3]
    found[:3, 3] = start[:3, 3] + share * (end - start)[:3, 3]
    if via is not None:
        centre, axis = circle(start[:3, 3], via, end[:3, 3])
        a, b = (one[:3, 3] - centre for one in (start, end))
        angle = np.arctan2(np.cross(a, b) @ axis, a @ b) % (2.0 * np.pi)
        found[:3, 3] = centre + turn(share * angle * axis) @ a
    return found


def test_joints_beside_the_arm_stay_unless_a_move_says_otherwise():
    names = [joint.name for joint in arm("heron6").joints]
    turned_to = dict(zip(names, START, strict=True)) | {"turn": 0.6}
    back = dict(zip(names, START, strict=True))
    pose = on_plate((0.0, 0.02, 0.0), angle=0.6)
    found = motion(
        [
            JointMove("PTP 1", "moves[0]", joints=turned_to),
            line(pose),
            JointMove("PTP 3", "moves[2]", joints=back),
            JointMove("PTP 4", "moves[3]", pose=pose, seen_from="plate"),
            line(on_plate(angle=0.6), free=("turn",)),
            JointMove("PTP 6", "moves[5]", pose=pose, seen_from="plate", near={"turn": 0.5}),
        ]
    )
    made = found.trajectory
    ends = np.array([positions_along(made, np.array([one.end]))[0] for one in made.moves])
    joints, angles = columns(found, ends)
    assert angles[:4] == pytest.approx([0.6] * 4, abs=1e-12) and angles[5] == 0.5
    assert 1e-3 < abs(angles[4] - 0.6) < 0.1
    for i, wanted in ((1, pose), (3, pose), (4, on_plate(angle=0.6)), (5, pose)):
        at = arm("heron6").poses(joints[i : i + 1])[0]
        assert np.abs(at - plate_at(angles[i]) @ wanted).max() < 1e-8


@pytest.mark.parametrize(
    ("moves", "told"),
    [
        (
            [
                line(on_plate((0.0, 0.05, 0.0)), zone=0.01),
                line(first_pose(), "", hold={"turn": 0.4}),
            ],
            "the next target is on what stands",
        ),
        (
            [
                line(on_plate((0.0, 0.05, 0.0)), hold={"turn": 0.4}, zone=0.01),
                line(on_plate((0.05, 0.05, 0.0)), free=("turn",)),
            ],
            "other joints are held after the corner zone",
        ),
        (
            [line(np.eye(4), "wrist_roll")],
            "2 joints are free .* a frame on what the arm does not move",
        ),
        ([line(first_pose(), "", free=("turn",))], "'turn' is not between the frame"),
        ([line(on_plate(), hold={"turn": 9.0})], "9 is beyond the limit of joint 'turn'"),
        ([line(on_plate((0.0, 3.0, 0.0)), hold={"turn": 0.4})], "seen from 'plate'"),
    ],
)
def test_what_cannot_be_followed_is_refused(moves, told):
    with pytest.raises(cl.ClearanceError, match=told):
        motion(moves)


def test_no_path_through_a_corner_takes_a_link_farther_than_is_proven_while_the_plate_turns():
    """The plate is as far between entry, corner and exit as the tool's point."""
    corner, end = on_plate((0.05, -0.02, 0.02)), on_plate((0.05, 0.03, 0.06), by=(0.1, 0.0, 0.1))
    moves = [line(corner, zone=0.004, hold={"turn": 0.5}), line(end, hold={"turn": 0.4})]
    found, one, draw = motion(moves), arm("heron6"), np.random.default_rng(3)
    (zone,) = found.trajectory.corners
    at = lambda shares: columns(  # noqa: E731
        found, positions_along(found.trajectory, zone.start + shares * (zone.end - zone.start))
    )
    joints, angles = at(np.array([0.0, 1.0]))
    turns = 0.5 - angles[0], angles[-1] - 0.5
    assert turns[0] > 0.01 and turns[1] < -0.005
    entry, exit_ = (
        np.linalg.inv(plate_at(angles[i]).astype(float)) @ one.poses(joints[[i]])[0]
        for i in (0, -1)
    )
    turned_by = vector_of(exit_[:3, :3] @ corner[:3, :3].T)
    for _ in range(12):
        now = joints[0]
        for a, b in np.linspace((0.0, 0.0), np.sort(draw.random(2))[::-1], 4)[1:]:
            pose = entry.astype(np.longdouble)
            pose[:3, 3] += a * (corner - entry)[:3, 3] + b * (exit_ - corner)[:3, 3]
            pose[:3, :3] = turn(draw.random() * turned_by) @ pose[:3, :3]
            angle = angles[0] + a * turns[0] + b * turns[1]
            wanted = plate_at(angle) @ pose
            now = joints_for(one, (wanted[:3, :3], wanted[:3, 3]), now)
        links = links_of(now, angle)
        (own,), (angle,) = at(np.array([0.5 * (a + b)]))
        nominal = links_of(own, angle)
        for link, off in zone.links.items():
            way = (links[link] - nominal[link])[:3, 3].astype(float)
            assert np.linalg.norm(way) <= off.way, link
            assert turn_between(links[link], nominal[link]) <= off.turn + 1e-12, link
    assert zone.links[one.link].way < 0.05 and zone.links["plate"].turn > 1e-3


def test_a_plate_goes_on_turning_through_zones_beside_joint_moves():
    one, to = arm("heron6"), (-0.4, 0.15, 0.45, 0.1, 1.1, 0.2)
    joints = dict(zip((joint.name for joint in one.joints), to, strict=True)) | {"turn": 0.8}
    end = np.linalg.inv(plate_at(0.8).astype(float)) @ one.poses(np.array([to]))[0]
    end[:3, 3] += (0.0, 0.05, 0.02)
    moves = [
        line(on_plate((0.05, -0.02, 0.02)), zone=0.004, hold={"turn": 0.5}),
        JointMove("PTP", "moves[1]", joints=joints, zone=0.005),
        line(end, hold={"turn": 0.7}),
    ]
    found = motion(moves)
    made = found.trajectory
    own, angles = columns(found, made.positions[-1:])
    assert np.abs(one.poses(own)[0] - plate_at(0.7) @ end).max() < 1e-9 and angles[0] == 0.7
    assert len(made.corners) == 2 and not made.unproven
    times = np.linspace(0.0, made.times[-1], 2001)
    rates = np.diff(positions_along(made, times), axis=0) / np.diff(times)[:, None]
    assert np.abs(np.diff(rates, axis=0)).max() < 0.02  # at once it would be some 0.5 rad/s


def links_of(joints: np.ndarray, angle: float) -> dict[str, np.ndarray]:
    """(4, 4) the poses of all links, in long double."""
    found = {"plate": plate_at(angle)}
    for name, (rotation, place) in links_at(arm("heron6"), joints)[0].items():
        found[name] = np.eye(4, dtype=np.longdouble)
        found[name][:3, :3], found[name][:3, 3] = rotation, place
    return found


def turn_between(a: np.ndarray, b: np.ndarray) -> float:
    return float(np.linalg.norm(vector_of(a[:3, :3] @ b[:3, :3].T).astype(float)))

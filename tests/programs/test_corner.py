"""Corner zones: no admissible path takes a link farther from the nominal motion than is proven."""

from __future__ import annotations

import numpy as np
import pytest

from clearance.programs.arm import Arm
from clearance.programs.inverse import joints_at
from clearance.programs.motion import motion_of
from clearance.programs.moves import PathMove, Program
from clearance.world.cubic import positions_along
from clearance.world.kinematics import links_of_robot, poses_by_link
from clearance.world.trajectory import Trajectory
from tests.programs.arms import arm, posture, turned


def cornered(one: Arm, seed: int, radius: float) -> tuple[Trajectory, list[np.ndarray]]:
    """A motion along two lines with a corner zone between, and the poses at its start, corner and end."""
    draw = np.random.default_rng(seed)
    start = posture(one, draw)
    poses = [one.poses(start[None])[0]]
    for _ in range(2):
        pose = poses[-1].copy()
        pose[:3, 3] += draw.uniform(-0.1, 0.1, 3) + np.array([-0.05, 0.0, 0.0])
        pose[:3, :3] = turned(draw.uniform(-0.1, 0.1, 3)) @ pose[:3, :3]
        poses.append(pose)
    moves = (
        PathMove("LIN 1", "moves[0]", poses[1], zone=radius),
        PathMove("LIN 2", "moves[1]", poses[2]),
    )
    joints = {joint.name: float(at) for joint, at in zip(one.joints, start, strict=True)}
    program = Program(one.link, one.link_from_tool, moves, joints)
    return motion_of(one.robot, program).trajectory, poses


def admissible(
    poses: list[np.ndarray], radius: float, draw: np.random.Generator, n: int
) -> tuple[np.ndarray, np.ndarray]:
    """(n, 4, 4) poses that a path through the zone may have, by their definition, and (n,) the nominal motion's
    u."""
    before, after = (b[:3, 3] - a[:3, 3] for a, b in zip(poses, poses[1:], strict=False))
    into, out = radius / np.linalg.norm(before), radius / np.linalg.norm(after)
    first, second = (
        logarithm(b[:3, :3] @ a[:3, :3].T) for a, b in zip(poses, poses[1:], strict=False)
    )
    entry = turned(-into * first) @ poses[1][:3, :3]
    b, a = np.sort(draw.random((2, n)), axis=0)
    b_turn, a_turn = np.sort(draw.random((2, n)), axis=0)
    found = np.tile(np.eye(4), (n, 1, 1))
    for i in range(n):
        found[i, :3, 3] = poses[1][:3, 3] - into * before * (1.0 - a[i]) + out * after * b[i]
        found[i, :3, :3] = (
            turned(b_turn[i] * out * second) @ turned(a_turn[i] * into * first) @ entry
        )
    return found, 0.5 * (a + b)


def logarithm(rotation: np.ndarray) -> np.ndarray:
    """(3,) the rotation vector of a small rotation."""
    twice = np.array(
        [
            rotation[2, 1] - rotation[1, 2],
            rotation[0, 2] - rotation[2, 0],
            rotation[1, 0] - rotation[0, 1],
        ]
    )
    sine = 0.5 * np.linalg.norm(twice)
    return 0.5 * twice * (np.arcsin(sine) / sine if sine else 1.0)


@pytest.mark.parametrize("name", ["heron6", "iiwa"])
@pytest.mark.parametrize("seed", [0, 1])
def test_no_admissible_path_takes_a_link_farther_than_is_proven(name, seed):
    one, radius = arm(name), 0.004
    trajectory, poses = cornered(one, seed, radius)
    (corner,) = trajectory.corners
    wanted, u = admissible(poses, radius, np.random.default_rng(seed), 200)
    columns = [trajectory.joint_names.index(joint.name) for joint in one.joints]
    nominal = positions_along(trajectory, corner.start + u * (corner.end - corner.start))[
        :, columns
    ]
    solved = joints_at(one.tool, wanted, nominal)
    assert solved.left.max() < 1e-9
    links = links_of_robot(one.robot)
    moving = [joint.name for joint in one.robot.moving_joints]
    places = [moving.index(joint.name) for joint in one.joints]
    both = np.zeros((2, len(u), len(moving)))
    both[:] = [min(joint.upper, 1.0) for joint in one.robot.moving_joints]
    both[0][:, places], both[1][:, places] = nominal, solved.positions
    at, off = (poses_by_link(links, positions) for positions in both)
    for i, link in enumerate(one.robot.link_names):
        way = np.linalg.norm(off[:, i, :3, 3] - at[:, i, :3, 3], axis=1).max()
        turn = np.arccos(
            np.clip(
                (np.einsum("nij,nij->n", off[:, i, :3, :3], at[:, i, :3, :3]) - 1.0) / 2.0, -1, 1
            )
        ).max()
        if link in corner.links:
            assert way <= corner.links[link].way and turn <= corner.links[link].turn + 1e-7
        else:
            assert way == 0.0
    assert corner.links[one.link].way < 3.0 * radius

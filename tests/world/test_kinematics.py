"""Chains between two links and how far joints go: what forward kinematics and the courses themselves say."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from clearance.world.joint_limits import ROUNDING, notices_on_joints
from clearance.world.kinematic_chain import chain_between
from clearance.world.kinematics import link_poses
from clearance.world.placed_robot import PlacedRobot
from clearance.world.robot import Joint, JointKind, Robot
from clearance.world.trajectory import Trajectory
from tests.examples import examples
from tests.made_cases import random_robot


def random_tree(rng, n_joints, **options):
    """A robot whose joints hang on any link before them."""
    robot = random_robot(rng, n_joints, **options)
    joints = [
        replace(joint, parent=f"l{rng.integers(0, i + 1)}") for i, joint in enumerate(robot.joints)
    ]
    return replace(robot, joints=tuple(joints))


@examples(100)
@given(st.integers(0, 2**32 - 1), st.integers(1, 8))
def test_it_places_the_second_link_in_the_first(seed, n_joints):
    rng = np.random.default_rng(seed)
    robot = random_tree(rng, n_joints, mimics=0.4)
    positions = rng.uniform(-3.0, 3.0, (4, len(robot.moving_joints)))
    world = link_poses(PlacedRobot(robot), positions)
    columns = {joint.name: i for i, joint in enumerate(robot.moving_joints)}
    a, b = rng.integers(0, len(robot.link_names), 2)
    chain = chain_between(robot, robot.link_names[a], robot.link_names[b])
    asked = positions[:, [columns[joint.name] for joint in chain.masters]]
    found = chain.frames(asked)[:, -1]
    expected = np.linalg.inv(world[:, a]) @ world[:, b]
    scale = 1.0 + np.abs(world[..., :3, 3]).max()
    assert np.abs(found - expected).max() < 1e-13 * scale


def arm(limit: float) -> Robot:
    """Two joints that turn."""
    names, links = ("a", "b"), ("base", "link_a", "link_b")
    joints = tuple(
        Joint(name, JointKind.REVOLUTE, above, below, np.eye(4), np.array([0.0, 0.0, 1.0]), -limit, limit)
        for name, above, below in zip(names, links, links[1:], strict=False)
    )  # fmt: skip
    return Robot("arm", links, joints, ())


@pytest.mark.parametrize(("beyond", "n_reported"), [(0.5, 1), (-0.5, 0), (0.5 * ROUNDING, 0)])
@pytest.mark.parametrize("side", [-1.0, 1.0])
def test_a_joint_is_reported_where_it_is_beyond_a_limit_at_a_sample(beyond, n_reported, side):
    positions = side * np.array([[0.0, 0.0], [0.0, 1.0 + beyond], [0.0, 0.5]])
    asked = Trajectory(np.arange(3.0), ("a", "b"), positions)
    found = notices_on_joints(PlacedRobot(arm(1.0), asked), "warn")
    assert len(found) == n_reported
    assert all("'b'" in notice.text and "in 1 of 3 steps" in notice.text for notice in found)

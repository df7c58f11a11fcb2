"""Chains between two links and how far joints go: what forward kinematics and the courses themselves say."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from clearance.world.joint_limits import ROUNDING, notices_on_joints
from clearance.world.joint_positions import joint_courses, joint_extents
from clearance.world.kinematic_chain import chain_between
from clearance.world.kinematics import link_poses
from clearance.world.placed_robot import PlacedRobot
from clearance.world.robot import Joint, JointKind, Mimic, Robot
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


@examples(50)
@given(st.integers(0, 2**32 - 1), st.integers(1, 8))
def test_only_joints_between_the_links_are_in_it(seed, n_joints):
    rng = np.random.default_rng(seed)
    robot = random_tree(rng, n_joints)
    a, b = rng.integers(0, len(robot.link_names), 2)
    chain = chain_between(robot, robot.link_names[a], robot.link_names[b])
    between = {joint.name for joint in chain.masters}
    for i, joint in enumerate(robot.moving_joints):
        positions = np.zeros((2, len(robot.moving_joints)))
        positions[1, i] = 0.7
        world = link_poses(PlacedRobot(robot), positions)
        relative = np.linalg.inv(world[:, a]) @ world[:, b]
        moves = np.abs(relative[0] - relative[1]).max() > 1e-9
        assert moves <= (joint.name in between)
    assert len(chain_between(robot, robot.link_names[a], robot.link_names[a]).joints) == 0


NUMBERS = st.floats(-4.0, 4.0)


def arm(limit: float, mimics: list[tuple[float, float]]) -> Robot:
    """Two joints that turn, and those that follow the second: factor and offset each."""
    names = ["a", "b", *(f"m{i}" for i in range(len(mimics)))]
    follows = [None, None, *(Mimic("b", *one) for one in mimics)]
    links = ["base", *(f"link_{name}" for name in names)]
    joints = tuple(
        Joint(name, JointKind.REVOLUTE, above, below, np.eye(4), np.array([0.0, 0.0, 1.0]), -limit, limit, follow)
        for name, above, below, follow in zip(names, links, links[1:], follows, strict=False)
    )  # fmt: skip
    return Robot("arm", tuple(links), joints, ())


@given(
    st.lists(st.tuples(NUMBERS, NUMBERS), min_size=1, max_size=8),
    st.lists(st.tuples(NUMBERS, NUMBERS), max_size=3),
    st.booleans(),
)
def test_ranges_are_the_ends_of_the_courses(samples, mimics, rests):
    positions = np.array(samples)
    names = ("a",) if rests else ("b", "a")
    asked = Trajectory(np.arange(float(len(samples))), names, positions[:, : len(names)])
    resting = {"b": 0.7} if rests else {}
    placed = PlacedRobot(arm(1.0, mimics), asked, fixed_positions=resting)
    for one in (placed, replace(placed, trajectory=None)):
        for course, ends in zip(joint_courses(one), joint_extents(one), strict=True):
            assert course.joint is ends.joint
            assert (ends.least, ends.greatest) == (
                course.at_samples.min(),
                course.at_samples.max(),
            )


@pytest.mark.parametrize(("beyond", "n_reported"), [(0.5, 1), (-0.5, 0), (0.5 * ROUNDING, 0)])
@pytest.mark.parametrize("side", [-1.0, 1.0])
def test_a_joint_is_reported_where_it_is_beyond_a_limit_at_a_sample(beyond, n_reported, side):
    positions = side * np.array([[0.0, 0.0], [0.0, 1.0 + beyond], [0.0, 0.5]])
    asked = Trajectory(np.arange(3.0), ("a", "b"), positions)
    found = notices_on_joints(PlacedRobot(arm(1.0, []), asked), "warn")
    assert len(found) == n_reported
    assert all("'b'" in notice.text and "in 1 of 3 steps" in notice.text for notice in found)

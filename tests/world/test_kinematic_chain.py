"""The chain between two links: the same poses as forward kinematics of the whole robot gives."""

from dataclasses import replace

import numpy as np
from hypothesis import given
from hypothesis import strategies as st

from clearance.world.case import PlacedRobot
from clearance.world.kinematic_chain import chain_between
from clearance.world.kinematics import link_poses
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

"""The bound on how far a link moves in an interval, against the motion itself."""

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from clearance.geometry.shapes import box
from clearance.geometry.tree import surface_of
from clearance.kernels.arithmetic.vec3 import Vec3
from clearance.kernels.mesh.surface import box_of
from clearance.kernels.motion.interval_middle import IntervalMiddle
from clearance.kernels.motion.joint_motion_bound import (
    motion_bound_of,
    motion_bound_of_box,
    motion_bound_of_box_along,
)
from clearance.world.kinematics import link_poses, links_of_robot, values_by_link
from clearance.world.placed_robot import PlacedRobot
from clearance.world.robot import Joint, JointKind, Robot
from clearance.world.trajectory import Trajectory
from tests.examples import examples
from tests.made_cases import random_robot
from tests.simulate.measure.forests import links_of

SHAPE = box((0.3, 0.1, 0.2))


def standing(robot):
    return PlacedRobot(robot, Trajectory(np.zeros(1), (), np.zeros((1, 0))))


def drifts(surface, chain, link, poses, swing, bend, direction):
    middle = IntervalMiddle(np.zeros(len(swing)), swing, bend, poses)
    drift = motion_bound_of(box_of(surface, surface.roots[0]), chain, link, middle)
    along = motion_bound_of_box_along(
        box_of(surface, 0), Vec3(direction[0], direction[1], direction[2]), drift
    )
    return motion_bound_of_box(box_of(surface, 0), drift), along


@examples(40)
@given(
    st.integers(0, 2**32 - 1),
    st.integers(1, 7),
    st.sampled_from([1e-4, 1e-2, 0.3, 2.0]),
    st.sampled_from([0.0, 0.1, 1.0, 10.0]),
)
def test_no_point_leaves_its_bound(seed, n_joints, size, bent):
    rng = np.random.default_rng(seed)
    robot = random_robot(rng, n_joints)
    n_moving = len(robot.moving_joints)
    placed = standing(robot)
    middle, half = rng.uniform(-2, 2, n_moving), size * rng.uniform(-1, 1, n_moving)
    shares = np.concatenate([[0.0], np.linspace(-1.0, 1.0, 41)])
    bend = bent * size * rng.uniform(0, 1, n_moving)
    aside = bend * rng.choice([-1.0, 0.3, 1.0], (len(shares), n_moving))
    aside[0] = 0.0
    poses = link_poses(placed, middle + shares[:, None] * half + aside)
    chain = links_of([standing(robot)])
    swing = values_by_link(links_of_robot(robot), half[None])[0]
    direction = rng.normal(size=3)
    direction /= np.linalg.norm(direction)  # in the frame of the link
    bends = values_by_link(links_of_robot(robot), bend[None])[0]
    bound, bound_along = drifts(
        surface_of(SHAPE), chain, n_joints, poses[0], swing, bends, direction
    )
    corners = np.c_[SHAPE.vertices, np.ones(len(SHAPE.vertices))]
    moved = (poses[:, n_joints] @ corners.T)[:, :3] - (poses[0, n_joints] @ corners.T)[:3]
    lengths = np.linalg.norm(moved, axis=1)
    along = np.abs(np.einsum("i,sij->sj", poses[0, n_joints, :3, :3] @ direction, moved))
    slack = 1e-13
    assert lengths.max() <= bound + slack
    assert along.max() <= bound_along + slack


@pytest.mark.parametrize("bend", [0.0, 0.125])
def test_the_bound_of_a_slide_is_exact_and_a_bend_is_added_in_every_direction(bend):
    robot = Robot("slide", ("a", "b"), (Joint("j", JointKind.PRISMATIC, "a", "b", np.eye(4)),), ())
    chain, poses = links_of([standing(robot)]), np.tile(np.eye(4), (2, 1, 1))
    swings, bends, sideways = (
        np.array([0.0, 0.25]),
        np.array([0.0, bend]),
        np.array([0.0, 1.0, 0.0]),
    )
    bound, along = drifts(surface_of(SHAPE), chain, 1, poses, swings, bends, sideways)
    assert bound == pytest.approx(0.25 + bend, rel=1e-11)
    assert along == pytest.approx(bend, rel=1e-11)

"""Cubic joint motion between samples: against scipy's Hermite spline and dense sampling."""

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from scipy.interpolate import CubicHermiteSpline

from clearance.errors import BadDimension, BadShape, NotFinite
from clearance.world.case import PlacedRobot
from clearance.world.cubic import extremes_between, positions_along
from clearance.world.kinematics import (
    links_of_robot,
    moving_velocities,
    rates_by_link,
    values_by_link,
)
from clearance.world.robot import Joint, JointKind, Mimic, Robot
from clearance.world.trajectory import Trajectory
from tests.examples import examples


def random_trajectory(seed, n_steps=5, n_joints=3):
    rng = np.random.default_rng(seed)
    times = np.cumsum(rng.uniform(0.01, 1.0, n_steps))
    size = rng.choice([1e-9, 0.1, 3.0], (n_steps, n_joints))
    velocities = rng.choice([0.0, 0.1, 10.0], (n_steps, n_joints)) * rng.normal(size=size.shape)
    names = tuple(f"j{i}" for i in range(n_joints))
    return Trajectory(times, names, size * rng.normal(size=size.shape), velocities)


@examples(60)
@given(st.integers(0, 2**32 - 1))
def test_positions_and_extremes_are_those_of_the_spline(seed):
    asked = random_trajectory(seed)
    spline = CubicHermiteSpline(asked.times, asked.positions, asked.velocities)
    shares = np.linspace(0.0, 1.0, 201)
    least, greatest = extremes_between(asked.times, asked.positions, asked.velocities)
    for i in range(asked.n_steps - 1):
        times = asked.times[i] + shares * (asked.times[i + 1] - asked.times[i])
        sampled = spline(times)
        size = 1.0 + np.abs(sampled).max()
        assert np.abs(positions_along(asked, times) - sampled).max() <= 1e-13 * size
        assert (least[i] <= sampled.min(axis=0) + 1e-13 * size).all()
        assert (greatest[i] >= sampled.max(axis=0) - 1e-13 * size).all()
        assert np.abs(least[i] - sampled.min(axis=0)).max() <= 1e-3 * size
        assert np.abs(greatest[i] - sampled.max(axis=0)).max() <= 1e-3 * size


def test_a_throw_goes_as_high_as_it_must():
    least, greatest = extremes_between(
        np.array([0.0, 2.0]), np.zeros((2, 1)), np.array([[3.0], [-3.0]])
    )
    assert (least[0, 0], greatest[0, 0]) == (0.0, 1.5)


def test_before_and_after_a_trajectory_the_robot_rests():
    asked = random_trajectory(1)
    ends = positions_along(asked, asked.times[[0, -1]] + [-5.0, 5.0])
    assert np.abs(ends - asked.positions[[0, -1]]).max() <= 1e-15


def test_mimics_move_at_their_multiple_and_fixed_joints_rest():
    joints = (
        Joint("a", JointKind.REVOLUTE, "l0", "l1", np.eye(4)),
        Joint("b", JointKind.REVOLUTE, "l1", "l2", np.eye(4), mimic=Mimic("a", -2.0, 5.0)),
        Joint("c", JointKind.PRISMATIC, "l2", "l3", np.eye(4)),
    )
    robot = Robot("robot", ("l0", "l1", "l2", "l3"), joints, ())
    asked = Trajectory(np.zeros(1), ("a",), np.array([[0.5]]), np.array([[3.0]]))
    placed = PlacedRobot(robot, asked, fixed_positions={"c": 0.7})
    velocities = moving_velocities(placed, asked.joint_names, asked.velocities)
    assert velocities.tolist() == [[3.0, 0.0]]
    links = links_of_robot(robot)
    assert rates_by_link(links, velocities).tolist() == [[0.0, 3.0, -6.0, 0.0]]
    assert values_by_link(links, np.array([[0.5, 0.7]])).tolist() == [[0.0, 0.5, 4.0, 0.7]]


def test_velocities_that_fit_no_motion_are_refused():
    times, names, positions = np.array([0.0, 1e3]), ("a", "b"), np.zeros((2, 2))
    with pytest.raises(BadShape, match=r"shape \(2, 1\)"):
        Trajectory(times, names, positions, np.zeros((2, 1)))
    with pytest.raises(NotFinite):
        Trajectory(times, names, positions, np.array([[0.0, 0.0], [np.nan, 0.0]]))
    with pytest.raises(BadDimension, match="joint 'b'"):
        Trajectory(times, names, positions, np.array([[0.0, 0.0], [0.0, 1e149]]))

"""What the bounds of gains are made of: how far a joint moves a point of a body at most, and how fast."""

from dataclasses import replace

import numpy as np
import pytest

import clearance as cl
from clearance.gains.delay import greatest_speed
from clearance.gains.joint_ranges import ACCELERATION, SPEED, joint_ranges
from clearance.gains.lower_bounds import motion_radii
from clearance.world.forest import forest_of, positions_along
from clearance.world.motion import kinematic_motion
from clearance.world.pairs import BodyIndex
from clearance.world.placed_robot import MotionLimit
from tests.examples import first_fast
from tests.gains.gantries import gantry
from tests.simulate.measure.wandering import case_of

STEP = 1e-4


@pytest.mark.parametrize("seed", first_fast(range(8), 3))
def test_no_joint_moves_a_point_farther_than_its_radius(seed):
    case = case_of(seed, 1)
    motions = [kinematic_motion(placed) for placed in case.robots]
    for i in range(len(case.robots[0].robot.bodies)):
        body = BodyIndex(0, i)
        corners, radii = body.shape_in(case).vertices, motion_radii(case, body)
        for k in range(0, 50, 10):
            (here,) = positions_along(case, motions, k, np.array([0.0]))
            asked = np.vstack([here, here + STEP * np.eye(len(here))])
            poses = body.poses_in(case, forest_of(case).poses(asked))
            placed = corners @ poses[:, :3, :3].transpose(0, 2, 1) + poses[:, None, :3, 3]
            ways = np.linalg.norm(placed[1:] - placed[0], axis=2).max(axis=1)
            assert (ways <= STEP * radii[: len(ways)] * (1.0 + 1e-3) + 1e-12).all()


def on_a_cubic(velocities, rate=1.0):
    """A block goes 1 m along x in 1 s of its table."""
    at = np.array([[0.0, 0.0], [1.0, 0.0]])
    path = cl.Trajectory(
        np.array([0.0, 1.0]), ("x", "y"), at, np.outer(velocities, [1.0, 0.0]).reshape(2, 2)
    )
    limits = {"x": MotionLimit(4.0, 20.0)}
    placed = cl.PlacedRobot(gantry(), path, motion_limits=limits)
    return cl.Case("quick", (replace(placed, timing=cl.Timing(rate=rate)),), ())


@pytest.mark.parametrize("velocities", [(0.0, 0.0), (3.0, 0.0), (0.0, 2.5)])
@pytest.mark.parametrize("rate", [1.0, 2.0])
def test_a_cubic_is_nowhere_faster_than_is_said(velocities, rate):
    case = on_a_cubic(velocities, rate)
    one, two = velocities
    shares = np.linspace(0.0, 1.0, 1001)
    speeds = rate * (
        one + 2.0 * (3.0 - 2.0 * one - two) * shares + 3.0 * (one + two - 2.0) * shares**2
    )
    accelerations = rate**2 * (2.0 * (3.0 - 2.0 * one - two) + 6.0 * (one + two - 2.0) * shares)
    assert greatest_speed(case, 0) >= np.abs(speeds).max() - 1e-12
    room = {one.what: one.headroom.min() for one in joint_ranges(case.robots[0])}
    assert room[SPEED] == pytest.approx(4.0 - np.abs(speeds).max(), abs=1e-4)
    assert room[ACCELERATION] == pytest.approx(20.0 - np.abs(accelerations).max(), abs=1e-4)

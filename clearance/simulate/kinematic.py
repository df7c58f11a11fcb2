"""Motion that follows the trajectory exactly."""

from __future__ import annotations

import numpy as np

from clearance.world.case import PlacedRobot
from clearance.world.kinematics import moving_positions, moving_velocities
from clearance.world.motion import Motion


def kinematic_motion(placed: PlacedRobot) -> Motion:
    """The motion that goes through the samples of the trajectory, with no tracking error.

    A robot without a trajectory stands.
    """
    if placed.trajectory is None:
        stand = moving_positions(placed, (), np.zeros((1, 0)))
        return Motion(placed, np.zeros(1), stand, np.zeros(1))
    asked = placed.asked
    velocities = None
    if asked.velocities is not None:
        velocities = moving_velocities(placed, asked.joint_names, asked.velocities)
    return Motion(
        placed=placed,
        times=asked.times,
        positions=moving_positions(placed, asked.joint_names, asked.positions),
        tracking_error=np.zeros(asked.n_steps),
        velocities=velocities,
    )

"""How a robot really moves: joint positions over time, whoever made them (the trajectory or physics)."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from clearance.world.cubic import cubics_of, position_on, velocity_on
from clearance.world.kinematics import link_poses, moving_positions, moving_velocities
from clearance.world.notice import Notice
from clearance.world.placed_robot import PlacedRobot


@dataclass(frozen=True, eq=False)
class Motion:
    """The motion of one placed robot.

    Attributes:
        times: (n,) [s].
        positions: (n, k) [rad] or [m] the positions that occur, columns as `placed.robot.moving_joints`.
        tracking_error: (n,) greatest |actual - asked| over the joints [rad or m]; zeros when kinematic.
        notes: what had to be assumed to make the motion, one line each, for the report.
        velocities: (n, k) [rad/s] or [m/s]: between steps each joint moves on the cubic that has them at both
            ends; None where the joints move linearly.
        notices: what is suspect about how the motion was made, and warnings.
    """

    placed: PlacedRobot
    times: np.ndarray
    positions: np.ndarray
    tracking_error: np.ndarray
    notes: tuple[str, ...] = ()
    velocities: np.ndarray | None = None
    notices: tuple[Notice, ...] = ()

    @property
    def n_steps(self) -> int:
        """Number of steps."""
        return len(self.times)

    @property
    def joint_names(self) -> tuple[str, ...]:
        """Names of the columns of `positions`."""
        return tuple(joint.name for joint in self.placed.robot.moving_joints)

    def poses(self, start: int = 0, stop: int | None = None) -> np.ndarray:
        """(steps, n_links, 4, 4) `world_from_link` [m] of the steps `start` to `stop`."""
        return link_poses(self.placed, self.positions[start:stop])

    def positions_after(self, step: int, share: float) -> np.ndarray:
        """(k,) [rad] or [m] where the joints are when a share (0 to 1) of the interval after a step has passed."""
        if share == 0.0:  # of the last step too
            return self.positions[step]
        ends = slice(step, step + 2)
        if self.velocities is None:
            before, after = self.positions[ends]
            return before + share * (after - before)
        cubics = cubics_of(self.times[ends], self.positions[ends], self.velocities[ends])
        return position_on(cubics, np.array(share))[0]

    def positions_at(self, time: float) -> np.ndarray:
        """(k,) [rad] or [m] where the joints are at a time [s] of the motion."""
        return self.positions_after(*place_in(self.times, time))

    def velocities_after(self, step: int, share: float) -> np.ndarray:
        """(k,) [rad/s] or [m/s] how fast the joints then are on their cubics; zeros where they move linearly."""
        if self.velocities is None:
            return np.zeros(self.positions.shape[1])
        ends = slice(step, step + 2)
        cubics = cubics_of(self.times[ends], self.positions[ends], self.velocities[ends])
        return velocity_on(cubics, np.array(share))[0] / (self.times[step + 1] - self.times[step])


def place_in(times: np.ndarray, time: float) -> tuple[int, float]:
    """The last step not after a time [s], and the share of its interval; of a time beyond, the nearer end."""
    step = int(np.clip(np.searchsorted(times, time, side="right") - 1, 0, len(times) - 1))
    if step == len(times) - 1:
        return step, 0.0
    return step, max(0.0, float((time - times[step]) / (times[step + 1] - times[step])))


def kinematic_motion(placed: PlacedRobot) -> Motion:
    """The motion that goes through the samples of the trajectory, with no tracking error.

    A robot without a trajectory stands.
    """
    if placed.trajectory is None:
        stand = moving_positions(placed, (), np.zeros((1, 0)))
        return Motion(placed, np.zeros(1), stand, np.zeros(1))
    asked = placed.given_trajectory
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

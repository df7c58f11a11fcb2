"""The position of every joint that moves, those that follow another included. Not for: poses (`kinematics`)."""

from __future__ import annotations

from collections.abc import Iterator
from typing import NamedTuple

import numpy as np

from clearance.world.case import PlacedRobot
from clearance.world.cubic import extremes_between
from clearance.world.mimics import followers
from clearance.world.robot import Joint, JointKind


class JointCourse(NamedTuple):
    """Where a joint goes.

    Attributes:
        at_samples: (n,) [rad] or [m] at each sample; (1,) for a joint that rests.
        least, greatest: (n - 1,) between samples where it moves on cubics, else None.
    """

    joint: Joint
    at_samples: np.ndarray
    least: np.ndarray | None = None
    greatest: np.ndarray | None = None


def joint_courses(placed: PlacedRobot) -> Iterator[JointCourse]:
    """Where each joint goes that the case gives a value, and where those go that follow one of them."""
    columns = {name: i for i, name in enumerate(placed.trajectory.joint_names)}
    for joint, master, factor, offset in followers(placed.robot):
        if master in columns:
            yield _course(joint, placed, columns[master], factor, offset)
        elif master in placed.fixed_positions:
            yield JointCourse(joint, np.array([factor * placed.fixed_positions[master] + offset]))
        elif joint.mimic is not None:
            yield JointCourse(joint, np.array([offset]))


def turns(joint: Joint) -> bool:
    """True for a joint whose position is an angle."""
    return joint.kind in (JointKind.REVOLUTE, JointKind.CONTINUOUS)


def _course(
    joint: Joint, placed: PlacedRobot, i_column: int, factor: float, offset: float
) -> JointCourse:
    asked = placed.trajectory
    column = slice(i_column, i_column + 1)
    at_samples = factor * asked.positions[:, i_column] + offset
    if asked.velocities is None:
        return JointCourse(joint, at_samples)
    ends = extremes_between(asked.times, asked.positions[:, column], asked.velocities[:, column])
    moved = [factor * end[:, 0] + offset for end in ends]
    return JointCourse(joint, at_samples, np.minimum(*moved), np.maximum(*moved))

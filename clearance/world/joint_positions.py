"""The position of every joint that moves, those that follow another included. Not for: poses (`kinematics`)."""

from __future__ import annotations

from collections.abc import Iterator
from typing import NamedTuple

import numpy as np

from clearance.world.cubic import extremes_between
from clearance.world.mimics import followers
from clearance.world.placed_robot import PlacedRobot
from clearance.world.robot import Joint, JointKind
from clearance.world.trajectory import Trajectory


class JointCourse(NamedTuple):
    """Where a joint goes.

    Attributes:
        at_samples: (n,) [rad] or [m] at each sample; (1,) for a joint that rests.
        i_column: of the trajectory that moves it; None for a joint that rests.
        factor, offset: position = factor * that column + offset.
    """

    joint: Joint
    at_samples: np.ndarray
    i_column: int | None = None
    factor: float = 1.0
    offset: float = 0.0


def joint_courses(placed: PlacedRobot) -> Iterator[JointCourse]:
    """Where each joint goes; those that nobody gives a value stay at 0."""
    asked = placed.trajectory
    columns = {} if asked is None else {name: i for i, name in enumerate(asked.joint_names)}
    for joint, master, factor, offset in followers(placed.robot):
        i = columns.get(master)
        if asked is not None and i is not None:
            yield JointCourse(joint, factor * asked.positions[:, i] + offset, i, factor, offset)
        else:
            resting = placed.fixed_positions.get(master, 0.0)
            yield JointCourse(joint, np.array([factor * resting + offset]))


class JointExtent(NamedTuple):
    """How far a joint goes at the samples [rad] or [m]."""

    joint: Joint
    least: float
    greatest: float


def joint_extents(placed: PlacedRobot) -> list[JointExtent]:
    """The least and the greatest of each of `joint_courses`."""
    courses = ((one.joint, one.at_samples) for one in joint_courses(placed))
    return [JointExtent(joint, float(at.min()), float(at.max())) for joint, at in courses]


def extremes_of(
    course: JointCourse, asked: Trajectory | None
) -> tuple[np.ndarray, np.ndarray] | None:
    """(n - 1,) least and greatest position between samples; None where the joint moves linearly or rests."""
    if asked is None or asked.velocities is None or course.i_column is None:
        return None
    column = slice(course.i_column, course.i_column + 1)
    ends = extremes_between(asked.times, asked.positions[:, column], asked.velocities[:, column])
    moved = [course.factor * end[:, 0] + course.offset for end in ends]
    return np.minimum(*moved), np.maximum(*moved)


def turns(joint: Joint) -> bool:
    """True for a joint whose position is an angle."""
    return joint.kind in (JointKind.REVOLUTE, JointKind.CONTINUOUS)

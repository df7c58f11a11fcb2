"""Refuses a case whose bodies get farther away than anything a robot works on: a unit mistake, or overflow."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from clearance.errors import BadDimension
from clearance.tolerance import REACH
from clearance.world.body import Body
from clearance.world.case import Case
from clearance.world.cubic import extremes_between
from clearance.world.motion import Motion


def require_within_reach(case: Case, motions: Sequence[Motion]) -> None:
    """Nothing, if every body stays within `tolerance.REACH` of the origin.

    Raises:
        BadDimension: the first body that does not.
    """
    for obstacle in case.obstacles:
        _require(f"obstacle {obstacle.name!r}", obstacle.body, obstacle.world_from_body[:3, 3])
    for motion in motions:
        farthest = np.abs(motion.placed.world_from_base[:3, 3]).max() + _slide(motion)
        for body in motion.placed.robot.bodies:
            _require(f"link {body.name!r}", body, np.array([farthest]))


def _slide(motion: Motion) -> float:
    """[m] how far the sliding joints go, and the frames of the joints are apart, in sum."""
    robot = motion.placed.robot
    apart = sum(float(np.abs(joint.parent_from_joint[:3, 3]).sum()) for joint in robot.joints)
    slides = [i for i, joint in enumerate(robot.moving_joints) if joint.kind == "prismatic"]
    return apart + sum(_farthest(motion, i) for i in slides)


def _farthest(motion: Motion, i_joint: int) -> float:
    """[rad or m] the greatest magnitude of a joint's position, at the steps and between."""
    column = slice(i_joint, i_joint + 1)
    reached = [motion.positions[:, column]]
    if motion.velocities is not None:
        reached += extremes_between(motion.times, reached[0], motion.velocities[:, column])
    return max(float(max(part.max(), -part.min())) for part in reached if part.size)


def _require(what: str, body: Body, origin: np.ndarray) -> None:
    reach = float(np.abs(body.shape.bounds).max() + np.abs(origin).max())
    if not reach <= REACH:
        raise BadDimension(
            f"it reaches {reach:g} m from the origin",
            where=what,
            valid=f"{REACH:g} m or less; lengths are in metres",
        )

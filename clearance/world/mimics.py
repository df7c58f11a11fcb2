"""Joints that follow others, to the joint that moves them all. Not for: what a file may say (`load.joints`)."""

from __future__ import annotations

from functools import lru_cache
from typing import NamedTuple

from clearance.world.robot import Joint, JointKind, Robot


class Follower(NamedTuple):
    """A joint that moves: position = factor * the master's position + offset.

    Attributes:
        master: name of a joint that follows none; the joint's own name where it follows none.
    """

    joint: Joint
    master: str
    factor: float
    offset: float


@lru_cache(maxsize=8)
def followers(robot: Robot) -> tuple[Follower, ...]:
    """All joints that move, in the robot's order, and what moves them; in time linear in the joints."""
    by_name = {joint.name: joint for joint in robot.joints}
    known: dict[str, tuple[str, float, float]] = {}
    for joint in robot.joints:
        chain = []
        while joint.name not in known and joint.mimic is not None:
            chain.append(joint)
            joint = by_name[joint.mimic.joint]
        master, factor, offset = known.setdefault(joint.name, (joint.name, 1.0, 0.0))
        for follower in reversed(chain):
            mimic = follower.mimic
            factor, offset = mimic.multiplier * factor, mimic.multiplier * offset + mimic.offset
            known[follower.name] = master, factor, offset
    moving = [joint for joint in robot.joints if joint.kind is not JointKind.FIXED]
    return tuple(Follower(joint, *known[joint.name]) for joint in moving)

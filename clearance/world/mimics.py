"""Joints that follow others, to the joint that moves them all."""

from __future__ import annotations

import math
from collections.abc import Collection, Mapping, Sequence
from functools import lru_cache
from typing import NamedTuple

from clearance.errors import BadRobot, UnknownJoint, at, nearest_name
from clearance.world.notice import listed
from clearance.world.robot import Joint, JointKind, Mimic, Robot


class Follower(NamedTuple):
    """A joint and what moves it: position = factor * the master's position + offset.

    Attributes:
        master: name of a joint that follows none; the joint's own name where it follows none.
    """

    joint: Joint
    master: str
    factor: float
    offset: float


@lru_cache(maxsize=8)
def followers(robot: Robot) -> tuple[Follower, ...]:
    """All joints that move, in the robot's order, and what moves them.

    Raises:
        UnknownJoint, BadInput: as `masters_of`.
    """
    found = masters_of(robot.joints)
    return tuple(found[joint.name] for joint in robot.joints if joint.kind is not JointKind.FIXED)


def range_of(robot: Robot, master: str) -> tuple[float, float]:
    """From where to where a joint [rad or m] and all that follow it keep their limits.

    Infinite where nothing limits it; the first is above the second where no position keeps all limits.

    Raises:
        UnknownJoint, BadInput: as `masters_of`.
    """
    low, high = -math.inf, math.inf
    for joint, leader, factor, offset in followers(robot):
        if leader != master:
            continue
        if factor == 0.0:
            if not joint.lower <= offset <= joint.upper:
                return math.inf, -math.inf
            continue
        ends = sorted((end - offset) / factor for end in (joint.lower, joint.upper))
        low, high = max(low, ends[0]), min(high, ends[1])
    return low, high


@lru_cache(maxsize=8)
def leads_of(robot: Robot) -> dict[str, tuple[tuple[str, float], ...]]:
    """Of each joint that moves, by name, the joints whose errors it has: itself, then those that it follows one
    after the other; and by how much, times their errors.

    Raises:
        UnknownJoint, BadInput: as `masters_of`.
    """
    moves = {one.joint.name: one.joint for one in followers(robot)}
    found = {}
    for name, joint in moves.items():
        leads, factor = [(name, 1.0)], 1.0
        while joint.mimic is not None:
            factor *= joint.mimic.multiplier
            leads.append((joint.mimic.joint, factor))
            joint = moves[joint.mimic.joint]
        found[name] = tuple(leads)
    return found


def masters_of(joints: Sequence[Joint]) -> dict[str, Follower]:
    """The leader of each joint, by name; in time linear in the joints.

    Raises:
        UnknownJoint: one follows a joint that is not there. BadInput: joints follow each other in a circle.
    """
    by_name = {joint.name: joint for joint in joints}
    known: dict[str, Follower] = {}
    for joint in joints:
        chain: dict[str, tuple[Joint, Mimic]] = {}
        while joint.name not in known and joint.mimic is not None:
            chain[joint.name] = joint, joint.mimic
            joint = _followed(joint.name, joint.mimic.joint, chain, by_name)
        _, master, factor, offset = known.setdefault(
            joint.name, Follower(joint, joint.name, 1.0, 0.0)
        )
        for follower, mimic in reversed(chain.values()):
            factor, offset = mimic.multiplier * factor, mimic.multiplier * offset + mimic.offset
            known[follower.name] = Follower(follower, master, factor, offset)
    return known


def _followed(
    follower: str, name: str, chain: Collection[str], by_name: Mapping[str, Joint]
) -> Joint:
    """The joint of a name, which the last of a chain follows."""
    with at(f"joint {follower!r} mimic"):
        if name not in by_name:
            raise UnknownJoint(f"unknown joint {name!r}", valid=nearest_name(name, by_name))
        if name in chain:
            raise BadRobot(f"joints follow each other in a circle: {listed([*chain], 6)}")
    return by_name[name]

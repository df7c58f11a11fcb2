"""The pairs of links of one robot that can come near each other, and which of them are excused.

Links that fixed joints join are one rigid body: such a pair never moves.
"""

from __future__ import annotations

import itertools
from collections.abc import Callable
from dataclasses import dataclass

from clearance.world.collision_matrix import ADJACENT, NEVER, CollisionMatrix
from clearance.world.robot import JointKind, Robot

RIGID = "joined by fixed joints"
"""Why a pair that nothing moves is omitted."""

Reasons = Callable[[str, str], str | None]
"""Why two links need not be measured, or None."""


@dataclass(frozen=True)
class SelfPair:
    """Two links with geometry; `excused` says why they need not be measured, or is None."""

    link_a: str
    link_b: str
    excused: str | None


def self_pairs(
    robot: Robot, matrix: CollisionMatrix | None = None, *, trust_never: bool = False
) -> list[SelfPair]:
    """All pairs of links with geometry in the robot's order.

    Args:
        matrix: of an SRDF; without one the robot's own counts; without that, `neighbours` are excused as adjacent.
        trust_never: excuse its pairs of reason Never too, which were not seen to meet in random poses.
    """
    rigid = rigid_bodies(robot)
    given = robot.own_matrix if matrix is None else matrix
    reason = _of_neighbours(robot) if given is None else _reasons_in(given, trust_never)
    return [
        SelfPair(a, b, RIGID if rigid[a] == rigid[b] else reason(a, b))
        for a, b in itertools.combinations((body.name for body in robot.bodies), 2)
    ]


LIMB = 5
"""Joints of an arm or a leg, at least; fingers have fewer."""


def limbs(robot: Robot) -> list[str]:
    """A link at the end of each limb, where the robot has several: each has `LIMB` joints that no other has."""
    ways: dict[str, tuple[str, ...]] = {robot.link_names[0]: ()}
    moving = {joint.name for joint in robot.moving_joints}
    for joint in robot.joints:
        ways[joint.child] = (*ways[joint.parent], *({joint.name} & moving))
    found: list[str] = []
    parents = {joint.parent for joint in robot.joints}
    for link in (one for one in ways if one not in parents):
        if all(_own_joints(ways[link], ways[other]) >= LIMB for other in found):
            found += [link] if len(ways[link]) >= LIMB else []
    return found if len(found) > 1 else []


def _own_joints(way: tuple[str, ...], other: tuple[str, ...]) -> int:
    """How many joints each of two ways from the root has at least that the other has not."""
    shared = len(set(way) & set(other))
    return min(len(way), len(other)) - shared


def rigid_bodies(robot: Robot) -> dict[str, int]:
    """The number of the rigid body that each link is part of: links that fixed joints join are one."""
    bodies = {robot.link_names[0]: 0}
    for joint in robot.joints:
        fixed = joint.kind is JointKind.FIXED
        bodies[joint.child] = bodies[joint.parent] if fixed else len(set(bodies.values()))
    return bodies


def neighbours(robot: Robot) -> frozenset[frozenset[str]]:
    """Pairs of links with a shape that one movable joint joins, the one below the other.

    Between them there may be fixed joints and links without a shape. Two links on one, and links on fixed
    joints next to a joint, are no neighbours: they may meet.
    """
    solid = {body.name for body in robot.bodies}
    above = {joint.child: joint for joint in robot.joints}
    found = set()
    for link in solid:
        moving = set()  # joints of several degrees of freedom count once
        joint = above.get(link)
        while joint is not None:
            if joint.kind is not JointKind.FIXED:
                moving.add(joint.part_of or joint.name)
            if joint.parent in solid or len(moving) > 1:
                break
            joint = above.get(joint.parent)
        if joint is not None and len(moving) == 1:
            found.add(frozenset((link, joint.parent)))
    return frozenset(found)


def _of_neighbours(robot: Robot) -> Reasons:
    adjacent = neighbours(robot)
    return lambda a, b: ADJACENT if frozenset((a, b)) in adjacent else None


def _reasons_in(matrix: CollisionMatrix, trust_never: bool) -> Reasons:
    def reason(a: str, b: str) -> str | None:
        found = matrix.reason(a, b)
        return None if found == NEVER and not trust_never else found

    return reason

"""The pairs of links of one robot that can come near each other, and which of them are excused.

Links that fixed joints join are one rigid body: such a pair never moves. Not for: pairs of a robot and an
obstacle (`pairs`).
"""

from __future__ import annotations

import itertools
from collections.abc import Callable

from clearance.late_dataclass import dataclass
from clearance.world.collision_matrix import ADJACENT, NEVER, CollisionMatrix
from clearance.world.robot import JointKind, Robot

RIGID = "joined by fixed joints"
"""Why a pair that nothing moves is left out."""

EXCLUDED = "excluded by the robot's own file"
"""Why a pair is left out of which no SRDF speaks."""

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
        matrix: of an SRDF; without one, neighbours are excused as adjacent, and what the robot's file excludes.
        trust_never: excuse its pairs of reason Never too, which were not seen to meet in random poses.
    """
    rigid = rigid_bodies(robot)
    reason = _own_reasons(robot, rigid) if matrix is None else _reasons_in(matrix, trust_never)
    return [
        SelfPair(a, b, RIGID if rigid[a] == rigid[b] else reason(a, b))
        for a, b in itertools.combinations((body.name for body in robot.bodies), 2)
    ]


def rigid_bodies(robot: Robot) -> dict[str, int]:
    """The number of the rigid body that each link is part of: links that fixed joints join are one."""
    bodies = {robot.link_names[0]: 0}
    for joint in robot.joints:
        fixed = joint.kind is JointKind.FIXED
        bodies[joint.child] = bodies[joint.parent] if fixed else len(set(bodies.values()))
    return bodies


def adjacent_bodies(robot: Robot) -> frozenset[frozenset[int]]:
    """Pairs of rigid bodies with geometry between which there are joints and bodies without geometry only."""
    rigid = rigid_bodies(robot)
    solid = {rigid[body.name] for body in robot.bodies}
    above = {
        rigid[joint.child]: rigid[joint.parent]
        for joint in robot.joints
        if joint.kind is not JointKind.FIXED
    }
    upward: dict[int, set[int]] = {}  # by a body without geometry, or the root: what meets there
    found = set()
    for body in sorted(solid):
        parent = above.get(body)
        while parent is not None and parent not in solid:
            upward.setdefault(parent, set()).add(body)
            parent = above.get(parent)
        if parent is not None:
            found.add(frozenset((body, parent)))
    for met in upward.values():
        found |= {frozenset(pair) for pair in itertools.combinations(sorted(met), 2)}
    return frozenset(found)


def _own_reasons(robot: Robot, rigid: dict[str, int]) -> Reasons:
    adjacent = adjacent_bodies(robot)
    excluded = frozenset(map(frozenset, robot.excluded))

    def reason(a: str, b: str) -> str | None:
        if frozenset((rigid[a], rigid[b])) in adjacent:
            return ADJACENT
        return EXCLUDED if frozenset((a, b)) in excluded else None

    return reason


def _reasons_in(matrix: CollisionMatrix, trust_never: bool) -> Reasons:
    def reason(a: str, b: str) -> str | None:
        found = matrix.reason(a, b)
        return None if found == NEVER and not trust_never else found

    return reason

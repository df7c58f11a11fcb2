"""All excused pairs of a robot checked against its geometry, and a proposal of which to excuse."""

from __future__ import annotations

from clearance.progress import Progress
from clearance.record.audit import ExcusedPair, PairStatus, ProposedPair
from clearance.simulate.answers.audit.pair import audit_pair
from clearance.world.collision_matrix import ADJACENT, NEVER, CollisionMatrix
from clearance.world.robot import Robot
from clearance.world.self_pairs import RIGID, SelfPair, self_pairs


def audit(
    robot: Robot, matrix: CollisionMatrix, progress: Progress | None = None
) -> list[ExcusedPair]:
    """Every pair of links with geometry that the matrix excuses, and whether it can ever meet."""
    excused = [
        pair
        for pair in self_pairs(robot, matrix, trust_never=True)
        if pair.excused not in (None, RIGID)
    ]
    found = []
    for i, pair in enumerate(excused, start=1):
        found.append(ExcusedPair(str(pair.excused), audit_pair(robot, pair.link_a, pair.link_b)))
        if progress:
            progress(i, len(excused))
    return found


def propose(robot: Robot, progress: Progress | None = None) -> list[ProposedPair]:
    """What can be excused of every pair that moves: neighbours, and what is proven never to meet."""
    pairs = [pair for pair in self_pairs(robot) if pair.excused != RIGID]
    found = []
    for i, pair in enumerate(pairs, start=1):
        found.append(_proposed(robot, pair))
        if progress:
            progress(i, len(pairs))
    return found


def _proposed(robot: Robot, pair: SelfPair) -> ProposedPair:
    if pair.excused == ADJACENT:
        return ProposedPair(pair, ADJACENT, None)
    finding = audit_pair(robot, pair.link_a, pair.link_b)
    return ProposedPair(pair, NEVER if finding.status is PairStatus.APART else None, finding)

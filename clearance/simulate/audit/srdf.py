"""All excused pairs of a robot held against its geometry, and a proposal of which to excuse.

Not for: one pair (`pair`), nor how it is reported (`report.srdf`).
"""

from __future__ import annotations

from dataclasses import dataclass

from clearance.progress import Progress
from clearance.simulate.audit.pair import PairFinding, PairStatus, audit_pair
from clearance.world.collision_matrix import ADJACENT, NEVER, CollisionMatrix
from clearance.world.robot import Robot
from clearance.world.self_pairs import RIGID, SelfPair, self_pairs


@dataclass(frozen=True)
class ExcusedPair:
    """A pair that a file excuses, for a reason, and whether it can meet."""

    reason: str
    finding: PairFinding

    @property
    def refuted(self) -> bool:
        """It is said never to meet, and a pose is known in which it does."""
        return self.reason == NEVER and self.finding.status is PairStatus.MEETS

    @property
    def unproven(self) -> bool:
        """It is said never to meet, and neither that nor the contrary is known."""
        return self.reason == NEVER and self.finding.status is PairStatus.UNDECIDED


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


@dataclass(frozen=True)
class ProposedPair:
    """A pair of links, and the reason to excuse it, or None where it has to be measured.

    Attributes:
        finding: whether it can meet; None of neighbours, which are not asked.
    """

    pair: SelfPair
    reason: str | None
    finding: PairFinding | None


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

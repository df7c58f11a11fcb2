"""Whether pairs of links that a file excuses can meet. Not for: finding out (`simulate.answers.audit`)."""

from __future__ import annotations

from dataclasses import dataclass
from enum import StrEnum

from clearance.world.collision_matrix import ADJACENT, NEVER
from clearance.world.self_pairs import SelfPair


class PairStatus(StrEnum):
    """What is known of a pair."""

    APART = "apart"
    MEETS = "meets"
    UNDECIDED = "undecided"


@dataclass(frozen=True)
class PairFinding:
    """Whether two links can meet.

    Attributes:
        lower_bound: [m] proven for all positions; 0 unless apart.
        least: [m] the least distance that was seen; 0 where they meet.
        positions: of the joints between them, by name [rad or m], where that was seen.
        n_boxes: that were looked at.
        why: of what is undecided.
    """

    link_a: str
    link_b: str
    status: PairStatus
    lower_bound: float
    least: float
    positions: dict[str, float]
    n_boxes: int
    why: str = ""


@dataclass(frozen=True)
class ExcusedPair:
    """A pair that a file excuses, for a reason, and whether it can meet.

    Attributes:
        is_joined: the two lie together at home, as most neighbours do.
    """

    reason: str
    finding: PairFinding
    is_joined: bool = False

    @property
    def refuted(self) -> bool:
        """It is said never to meet, and a pose is known in which it does."""
        return self.reason == NEVER and self.finding.status is PairStatus.MEETS

    @property
    def hides_contact(self) -> bool:
        """Its links are excused as neighbours, but lie apart at home, and a pose is known in which they meet."""
        meets = self.finding.status is PairStatus.MEETS
        return self.reason == ADJACENT and meets and not self.is_joined

    @property
    def unproven(self) -> bool:
        """It is said never to meet, and neither that nor the contrary is known."""
        return self.reason == NEVER and self.finding.status is PairStatus.UNDECIDED


@dataclass(frozen=True)
class ProposedPair:
    """A pair of links, and the reason to excuse it, or None where it has to be measured.

    Attributes:
        finding: whether it can meet; None of neighbours that are excused.
    """

    pair: SelfPair
    reason: str | None
    finding: PairFinding | None

"""How the least clearance of a pair stands against the rule that judges it.

Not for: moments, which know whether bodies touch (`Moment`).
"""

from __future__ import annotations

from clearance.late_dataclass import dataclass
from clearance.report.actors import paddings_of
from clearance.simulate.record import PairMinimum, Record
from clearance.simulate.status import status_of
from clearance.world.case import Limits


@dataclass(frozen=True)
class PairJudge:
    """The limits of each rule, and the paddings [m] of the bodies that have one, by name."""

    limits: dict[str, Limits]
    paddings: dict[str, float]

    @staticmethod
    def of(record: Record) -> PairJudge:
        """That of a record."""
        return PairJudge(
            {answer.name: answer.limits for answer in record.rules}, paddings_of(record)
        )

    def status_of(self, minimum: PairMinimum) -> str:
        """The status; what padding alone brings to 0 or below is violated, no contact."""
        padding = sum(self.paddings.get(name, 0.0) for name in (minimum.link, minimum.obstacle))
        touches = minimum.clearance + padding <= 0.0
        return status_of(minimum.clearance, self.limits[minimum.rule], touches)

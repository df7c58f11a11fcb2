"""How the least clearance of a pair stands against the rule that judges it.

Not for: moments, which know whether bodies touch (`Moment`).
"""

from __future__ import annotations

from dataclasses import dataclass

from clearance.record.record import PairMinimum, Record
from clearance.record.status import status_of
from clearance.report.actors import paddings_of
from clearance.world.case import Limits


@dataclass(frozen=True)
class PairJudge:
    """The limits of each rule, the paddings [m] of the bodies that have one, by name, and what paths are off."""

    limits: dict[str, Limits]
    paddings: dict[str, float]
    path_error: float

    @staticmethod
    def of(record: Record) -> PairJudge:
        """That of a record."""
        limits = {answer.name: answer.limits for answer in record.rules}
        return PairJudge(limits, paddings_of(record), record.timeline.path_error)

    def status_of(self, minimum: PairMinimum) -> str:
        """The status; what padding alone brings to 0 or below is violated, no contact."""
        padding = sum(self.paddings.get(name, 0.0) for name in (minimum.link, minimum.obstacle))
        lessened = (
            padding + self.path_error
        )  # one sum, as it was taken off: a distance of 0 stays 0
        touches = minimum.clearance <= -lessened
        return status_of(minimum.clearance, self.limits[minimum.rule], touches)

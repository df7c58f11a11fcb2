"""Waivers: who lets which two bodies come nearer than a rule says, how near, why and until when."""

from __future__ import annotations

from collections.abc import Collection
from dataclasses import dataclass
from datetime import date

from clearance.errors import BadWaiver
from clearance.world.rules import PairPattern, checked_level, matches


@dataclass(frozen=True)
class Waiver(PairPattern):
    """A limit of its own for two bodies, below that of their rule; of contact there is none.

    Attributes:
        at_least: [m] the clearance that they must keep. reason: why that suffices. by: who says so.
        until: the last valid day. case, rule: patterns of the names of cases and rules; "*" for all.
        where: its file and row, for messages. shared: given for many cases at once, and not all of them need it:
            whether any does is for whoever gives it to say, and no case fails by that it does not.

    Raises:
        BadDimension: a level that is below 0 or not finite. BadInput: nobody, or no reason.
    """

    at_least: float = 0.0
    reason: str = ""
    by: str = ""
    until: date = date.max
    case: str = "*"
    rule: str = "*"
    where: str = ""
    shared: bool = False

    def __post_init__(self) -> None:
        super().__post_init__()
        object.__setattr__(self, "at_least", checked_level(self.at_least, "at_least"))
        for name in ("reason", "by"):
            if not getattr(self, name).strip():
                raise BadWaiver(f"a waiver with no {name}", valid="why, and who says so")

    def is_of_case(self, name: str) -> bool:
        """True if it is of a case of this name."""
        return matches(name, self.case)

    def is_of(self, rule: str, one: Collection[str], other: Collection[str]) -> bool:
        """True if it is of two bodies, each given by the names it goes by, as far as a rule judges them."""
        return matches(rule, self.rule) and self.matches(one, other)

    def is_expired(self, today: date) -> bool:
        """True after its last day."""
        return today > self.until

    def __str__(self) -> str:
        place = f" ({self.where})" if self.where else ""
        return f"waiver {' - '.join(self.between)}{place}"

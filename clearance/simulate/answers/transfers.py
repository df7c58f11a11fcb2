"""Parts that a change hands over elsewhere: picked up or let go where it moves what carries them.

A part keeps the pose that it has on its carrier as it is picked up. A base that is moved by x and then turns moves
it by x less x turned, up to twice as far; a part that is let go stays where that took it. So no bound of how far
it moves follows from how far its carrier does. Not for: which part is where (`world.hands`).
"""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property

from clearance.simulate.answers.approaches import Approach
from clearance.simulate.answers.point_motion import Thing, owners_of, things_under
from clearance.world.body import Mount
from clearance.world.case import Case
from clearance.world.forest import owner_of
from clearance.world.pairs import Pair


@dataclass(frozen=True, eq=False)
class Transfers:
    """What a change hands over elsewhere.

    Attributes:
        case: in which parts change hands. thing: what is changed.
    """

    case: Case
    thing: Thing

    def has(self, approach: Approach) -> bool:
        """True if a body of a pair is such a part, or stands on one."""
        return self.has_of(approach.case, approach.pair)

    def has_of(self, case: Case, pair: Pair) -> bool:
        """The same of a pair of the plain case of a part of the run."""
        if not self.parts:
            return False
        owners = {one for body in pair for one in owners_of(case, body)}
        return any(
            is_obstacle and self.case.obstacles[i].name in self.parts for is_obstacle, i in owners
        )

    @cached_property
    def parts(self) -> frozenset[str]:
        """Parts that are carried at any time by what stands on the thing, or by such a part."""
        found: set[str] = set()
        for _ in self.case.carries:
            found |= {one.part for one in self.case.carries if self._moves(one.by, found)}
        return frozenset(found)

    def _moves(self, name: str, parts: set[str]) -> bool:
        under = things_under(self.case, owner_of(self.case, Mount(name)))
        names = {self.case.obstacles[i].name for is_obstacle, i in under if is_obstacle}
        return self.thing in under or not parts.isdisjoint({name, *names})


@dataclass(frozen=True, eq=False)
class CombinedTransfers:
    """What several changes at once hand over elsewhere."""

    each: tuple[Transfers, ...]

    def has(self, approach: Approach) -> bool:
        """True if a body of a pair is a part that any of them does, or stands on one."""
        return any(one.has(approach) for one in self.each)

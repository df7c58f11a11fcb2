"""A corner zone of a robot's program: how far its links may be off their nominal motion while it is passed.

Not for: how that is proven (room `programs`).
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass


@dataclass(frozen=True)
class Deviation:
    """How far a link may be off.

    Attributes:
        way: [m] of the origin of its frame. turn: [rad] of the link.
    """

    way: float
    turn: float

    def at(self, distance: float) -> float:
        """[m] How far a point of it may be off at a distance [m] from its origin."""
        return self.way + self.turn * distance


@dataclass(frozen=True, eq=False)
class CornerZone:
    """A stretch of a trajectory on which a controller may leave the nominal path.

    Attributes:
        name: of the move at whose end it is. start, end: [s] of the trajectory's own time. radius: [m].
        links: how far each link that moves may be off, by name.
    """

    name: str
    start: float
    end: float
    radius: float
    links: Mapping[str, Deviation]

"""The slopes of the clearance at the worst moment. Not for: working them out (`simulate.answers.sensitivity`)."""

from __future__ import annotations

from dataclasses import dataclass

TWO_WAYS = 1e-3
"""[-] Of the greater of both slopes, how far they may add up to be one slope that holds both ways."""


NO_SLOPE = 1e-4
"""[-] or [m/rad] A smaller slope is none: bodies 1 mm apart that slide past an edge show half of it."""


@dataclass(frozen=True)
class Rate:
    """What the clearance changes by with one variable.

    Attributes:
        kind: "joint", "base" or "obstacle". of: the robot or obstacle.
        name: the joint, or "x", "y", "z" of the world.
        unit: "rad" or "m" of the variable.
        more, less: [m per unit] what a unit more, and a unit less, add to the clearance.
    """

    kind: str
    of: str
    name: str
    unit: str
    more: float
    less: float

    @property
    def both_ways(self) -> bool:
        """True if `less` is `-more`, so that one number says both."""
        return abs(self.more + self.less) <= max(
            TWO_WAYS * max(abs(self.more), abs(self.less)), NO_SLOPE
        )


@dataclass(frozen=True)
class Sensitivity:
    """What the clearance of a moment changes by.

    Attributes:
        pairs: the bodies of each pair that is as near as the nearest. rates: of what moves any of them.
        why_not: why nothing is worked out; empty if it is.
    """

    pairs: tuple[tuple[str, str], ...] = ()
    rates: tuple[Rate, ...] = ()
    why_not: str = ""

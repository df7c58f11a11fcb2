"""How much work the overlaps of one pair may take before only bounds are given.

Counted in triangles looked at, not in seconds: the same input gives the same bytes on any machine, however busy.
"""

from __future__ import annotations

from dataclasses import dataclass, field

WORK = 30_000_000
"""Of one pair: about 2 s of the machine on which the figures of `query/CONTACT.md` were measured."""

ROW = 300_000
"""An overlap, its bodies however small: 20 ms, most of it calls."""

RATED = 15_000
"""A look at how deep a step may be: 1 ms."""

LOOKS = 18
"""Such looks at an event at most."""

PER_TRIANGLE = 12
"""Times that each triangle of both bodies is gone through in an overlap: a solid made of them takes as much."""


@dataclass(eq=False)
class ContactWork:
    """What is left for a pair of so many triangles in all."""

    n_triangles: int
    left: int = field(default_factory=lambda: WORK)
    left_for_deeper: int = field(default_factory=lambda: WORK // 2)

    @property
    def why(self) -> str:
        """What is said of an event that is beyond it."""
        return "beyond the work allowed for a pair: bounds by 26 directions and boxes only"

    def take_event(self, n_steps: int) -> bool:
        """True if the deepest moment of one more event of so many steps may be worked out; it is counted then."""
        looks = min(n_steps, LOOKS) if n_steps > 1 else 0
        work = ROW + PER_TRIANGLE * self.n_triangles + looks * (RATED + self.n_triangles)
        if work > self.left:
            return False
        self.left -= work
        return True

    def take_deeper(self) -> bool:
        """True if one more overlap may be worked out to find a deeper one; it is counted then, by itself."""
        work = ROW + PER_TRIANGLE * self.n_triangles
        if work > self.left_for_deeper:
            return False
        self.left_for_deeper -= work
        return True

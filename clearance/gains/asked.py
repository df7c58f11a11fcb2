"""What may be changed, and what must stay as it is: checked as it is asked.

Not for: whether a case has what is named (`answer`).
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from clearance.errors import BadDimension, BadInput

KINDS = ("waypoints", "obstacle", "base", "timing")

OWN = {
    "robot": ("waypoints", "base", "timing"),
    "obstacle": ("obstacle",),
    "keep": ("waypoints",),
}
"""Which kinds what is named is of; of others it would be passed over."""

MOST_DELAY = 60.0
"""[s] That is looked at, if nothing is given."""


@dataclass(frozen=True)
class Asked:
    """What may be changed.

    Attributes:
        kind: one of `KINDS`. margin: [m] above the fail limits.
        robot, obstacle: names; where there is one, it need not be given.
        keep: (start, end) of the run [s] in which a path stays as it is. keep_ends: its ends stay.
        most_delay: [s].
    """

    kind: str
    margin: float = 0.0
    robot: str | None = None
    obstacle: str | None = None
    keep: tuple[tuple[float, float], ...] = ()
    keep_ends: bool = True
    most_delay: float = MOST_DELAY

    def __post_init__(self) -> None:
        if self.kind not in KINDS:
            raise BadInput(f"unknown kind {self.kind!r:.60}", valid=f"one of {', '.join(KINDS)}")
        for name, kinds in OWN.items():
            if getattr(self, name) and self.kind not in kinds:
                raise BadInput(
                    f"{name} is given, of which a change of kind {self.kind} knows nothing",
                    valid=f"{name} with kind {' or '.join(kinds)}",
                )
        if not 0.0 <= self.margin < np.inf:
            raise BadDimension(f"a margin of {self.margin!r:.60} m", valid="a length, 0 or more")
        if not 0.0 <= self.most_delay < np.inf:
            raise BadInput(f"a delay of {self.most_delay!r:.60} s", valid="a time, 0 or more")
        for start, end in self.keep:
            if not start <= end:
                raise BadInput(
                    f"from {start:g} s to {end:g} s is kept", valid="a start before its end"
                )

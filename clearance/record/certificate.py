"""What is proven of the motion between the steps. Not for: proving it (`certify`)."""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property

import numpy as np

from clearance.record.moment import Moment
from clearance.tolerance import SEEN_AT_LEVEL
from clearance.world.case import Limits
from clearance.world.notice import Notice


@dataclass(frozen=True, eq=False)
class Certificate:
    """Proven bounds on the clearance of the continuous motion, joints moving between steps as `Motion` says.

    Attributes:
        lower_bound: (n,) [m] row i holds from step i to step i + 1; the last row for its step alone.
        upper_bound: (n,) [m] the least distance seen there, at the steps or between them; where `need` leaves
            clearances unknown, the distance that was asked about, if nothing nearer was seen.
        share, pair: (n,) where between the steps that was seen (0 to 1), and of which pair; -1 where nothing
            nearer than at the steps was.
        gap: [m] how far apart the two were allowed to stay.
        tally: counters by name.
        notices: what a reader must know of it.
        touching: (n,) where bodies touch, if padding has lessened the bounds; None without padding.
        worst: the moment of the least distance seen between steps; None if all were nearest at a step.
    """

    lower_bound: np.ndarray
    upper_bound: np.ndarray
    share: np.ndarray
    pair: np.ndarray
    gap: float
    tally: dict[str, int]
    notices: tuple[Notice, ...] = ()
    touching: np.ndarray | None = None
    worst: Moment | None = None

    def touches(self, steps: slice) -> np.ndarray:
        """(k,) where bodies are seen to touch, at some steps or on the way to the next."""
        return self.upper_bound[steps] <= 0.0 if self.touching is None else self.touching[steps]

    @property
    def worst_interval(self) -> int:
        """The first interval of the least lower bound."""
        return int(np.argmin(self.lower_bound))

    @cached_property
    def nearest_between(self) -> int | None:
        """The first interval of the least distance seen between steps; None if all were nearest at a step."""
        seen = np.flatnonzero(self.pair >= 0)
        return int(seen[np.argmin(self.upper_bound[seen])]) if len(seen) else None


def motion_codes(certificate: Certificate, limits: Limits, steps: slice) -> np.ndarray:
    """(k,) what is proven of the motion from each of `steps` to the next, as indices into `STATUSES`.

    Below a limit is what is not proven to stay above it; where only distances below the limit were asked about,
    what is really seen below it. Contact is what is seen.
    """
    lower, upper = certificate.lower_bound[steps], certificate.upper_bound[steps]
    seen = certificate.pair[steps] >= 0
    below = [
        limits.below(lower, limit) & (seen | ~limits.below(upper, limit))
        for limit in (limits.fail, limits.warn)
    ]
    below[0] |= (upper <= 0.0) | contact_is_open(certificate, limits)[steps]
    return np.select([certificate.touches(steps), *below], [3, 2, 1], default=0)


def contact_is_open(certificate: Certificate, limits: Limits) -> np.ndarray:
    """(n,) True where contact is neither seen nor proven not to be, and nothing is seen that touches but for
    rounding."""
    lower, upper = certificate.lower_bound, certificate.upper_bound
    return (lower <= 0.0) & (upper > SEEN_AT_LEVEL * limits.rounding)

"""What a budget leaves of a clearance, as plain data. Not for: working it out (`clearance.budget`)."""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property

import numpy as np

from clearance.record.moment import Moment
from clearance.world.case import Limits
from clearance.world.rules import Waiver

GREATEST = {"rad": 0.02, "m": 0.05, "s": 1.0}
"""Of no single tolerance is more looked for, unless more is given."""


def most_searched(unit: str, given: float) -> float:
    """The greatest single tolerance that is looked for: what is told as this may be more."""
    return max(GREATEST[unit], 2.0 * given)


@dataclass(frozen=True)
class ErrorSource:
    """One error of a budget, and what it takes of the clearance at a moment.

    Attributes:
        owner: the robot or obstacle that it is of. kind: "position" or "tracking" of a joint, "frame" of one,
            "base", "place", "surface", "timing" or "facets".
        part: the joint or link; empty where it is of the whole owner.
        tolerances: what the budget gives, each with its unit ("m", "rad" or "s"): an offset and an angle for
            frames, else one.
        proven: [m] what it takes of the proven clearance, all others as given. expected: [m] its standard
            deviation at the witness points; None in contact, where no direction leads from one body to the other.
        largest: the greatest single tolerance, in the order of `tolerances`, all others as given, at which the
            limit is still proven to be kept; None where even 0 does not keep it. Empty where not asked for.
        moment: at which a part changed hands, if the error is of then: `grasp (2 s)`. Its `largest` is that of the
            error at every moment.
    """

    owner: str
    kind: str
    part: str
    tolerances: tuple[tuple[float, str], ...]
    proven: float
    expected: float | None
    largest: tuple[float | None, ...] = ()
    moment: str = ""


@dataclass(frozen=True, eq=False)
class BudgetMoment:
    """A moment at which the budget leaves least.

    Attributes:
        moment: as it is said to be, of the pair that the errors bring nearest. proven, expected: [m].
        sources: what takes most first; empty where that was not asked for.
    """

    moment: Moment
    proven: float
    expected: float
    sources: tuple[ErrorSource, ...] = ()


@dataclass(frozen=True, eq=False)
class RuleBudget:
    """What the budget leaves to the pairs that one rule judges.

    Attributes:
        rule: its name. limits: its levels. waiver: the one of all these pairs, with its level as fail limit.
        proven: (n,) [m] lower bound of the clearance of each step, less padding, whatever the errors are.
        expected: (n,) [m] estimate: nominal less `coverage` standard deviations, but no less than `proven`; NaN
            where it is not worked out.
        between: (n,) [m] as `proven`, of the motion from each step to the next; None where nothing is certified.
        expected_between: (n,) [m] as `expected`, of the least moment after each step; NaN where no moment is
            nearer than the steps, or nothing is certified.
    """

    rule: str
    limits: Limits
    proven: np.ndarray
    expected: np.ndarray
    between: np.ndarray | None
    expected_between: np.ndarray | None = None
    waiver: Waiver | None = None

    @cached_property
    def least(self) -> float:
        """[m] The least that is proven, of the motion where that is certified."""
        return float(np.min(self.proven if self.between is None else self.between))

    @property
    def keeps(self) -> bool:
        """True if the fail limit is proven to be kept whatever the errors are."""
        return not self.limits.below(self.least, self.limits.fail) and self.least > 0.0

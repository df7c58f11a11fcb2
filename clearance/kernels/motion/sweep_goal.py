"""What is asked of a sweep."""

from typing import NamedTuple

from clearance.compile.declared import Floats, Floats2, Integers


class Goal(NamedTuple):
    """What is asked of a sweep.

    Attributes:
        within: (p,) [m] each pair is measured only where it is not farther apart; the same for all pairs
            unless `each`.
        each: every pair has a best of its own; else all pairs of a step share one.
        lasting: a best holds for the later steps too: only what is nearer than all before is measured.
    """

    within: Floats
    each: bool
    lasting: bool


class SweptSteps(NamedTuple):
    """What is swept.

    Attributes:
        positions: (k, columns) of the joints at the steps [rad or m]. steps: (k,) their numbers.
        known: (k,) the pair that is not measured at each, since it has been, or -1; (0,) where all are.
    """

    positions: Floats2
    steps: Integers
    known: Integers


class FirstLook(NamedTuple):
    """A rough look at a few rows before all others: how near those come, no later one need be farther.

    Attributes:
        rows: (m,) in their order; none if there is to be no such look.
        effort: of `PairQuestion`; what is found with less than `TO_THE_END` is an upper bound.
    """

    rows: Integers
    effort: int

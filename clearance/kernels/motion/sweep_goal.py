"""The question of a sweep."""

from typing import NamedTuple

from clearance.compile.declared import Floats, Floats2, Integers


class SweepGoal(NamedTuple):
    """The pairs and distances that a sweep looks for.

    Attributes:
        within: (p,) [m] a pair is measured only where its distance is at most this; the same for all pairs
            unless `each`.
        each: every pair has a best of its own; else all pairs of a step share one.
        lasting: a best holds for the later steps too: only nearer pairs are measured.
    """

    within: Floats
    each: bool
    lasting: bool


class SweptSteps(NamedTuple):
    """The steps of a sweep.

    Attributes:
        positions: (k, columns) of the joints at the steps [rad or m]. steps: (k,) their numbers.
        known: (k,) the pair at each that is known already, or -1; (0,) without such pairs.
    """

    positions: Floats2
    steps: Integers
    known: Integers


class FirstPass(NamedTuple):
    """A rough first pass over a few rows: its least distance is an upper bound for all others.

    Attributes:
        rows: (m,) in their order; none for no first pass.
        effort: of `PairQuestion`; with less than `TO_THE_END` the distance found is an upper bound.
    """

    rows: Integers
    effort: int

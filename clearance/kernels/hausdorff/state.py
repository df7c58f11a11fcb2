"""The places of a search's numbers in its state, one name each.

The best point so far, the bounds of the directed distance, and what the search did. `LOWER` is proven where
`DISTANCE` is the value at the witnesses; they differ by the rounding of the nearest point. `ROOT` is the
greatest distance of any root of the systems, of whatever branch of B, and where it is.
"""

from typing import NamedTuple

LOWER, DISTANCE, PIECE_A, AT_A, PIECE_B, AT_B, UPPER = 0, 1, 2, 3, 4, 5, 6
ENDS, NORMALS, BISECTORS, CUTS, ARCS, KEPT, PIXELS, MAP_BOUND, GIVEN_UP = range(7, 16)
ROOT, ROOT_PIECE_A, ROOT_AT_A, ROOT_PIECE_B, ROOT_AT_B = range(16, 21)
STATE = 21


class Aim(NamedTuple):
    """What a search is after.

    Attributes:
        gap: how near the upper bound has to come to the best value; `wide` after `sharp` intervals.
        enough: an upper bound that need not be improved; 0 for the distance itself.
        limit: a lower bound beyond it ends the search.
        budget: intervals after which the rest is left to its bounds.
    """

    gap: float
    wide: float
    sharp: float
    enough: float
    limit: float
    budget: float

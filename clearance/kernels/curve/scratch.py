"""The scratch space of the kernels that walk along curves: planes of rows, each with a name.

One array (N_PLANES, rows, 4) serves a whole search, so that nothing is allocated inside it. The nearest point
uses the planes below `MAP`, with the stack of its tree in `MAP`; bounds over parts of two curves use the others.
Not for: what a search knows (`hausdorff.state`).
"""

from typing import NamedTuple

import numpy as np

from clearance.compile.decorators import inline

N_NEAREST = (
    5  # planes that `nearest.closest_on` takes; `nearest.nearest` keeps its stack in the next one
)
MAP, PART_A, PART_B, GAP, SQUARES, FEET = range(N_NEAREST, 11)
N_PLANES = 11
LARGEST_DEGREE = 48  # of B(s(t)) and A together; binomials are at hand up to twice that
FEWEST_ROWS = 2 * LARGEST_DEGREE + 2


class SearchScratch(NamedTuple):
    """Scratch of a search.

    Attributes:
        planes: of `new_scratch`.
        composed: (points, 3, LARGEST_DEGREE + 1) room for composed maps (`curve.follow`).
    """

    planes: np.ndarray
    composed: np.ndarray


@inline
def widest(pieces):
    """The largest number of control points of a piece."""
    most = 0
    for i in range(pieces.first.shape[0] - 1):
        most = max(most, pieces.first[i + 1] - pieces.first[i])
    return most


@inline
def new_scratch(most, n_rows):
    """Scratch planes for pieces of at most `most` control points, of `n_rows` rows at least."""
    return np.empty((N_PLANES, max(max(FEWEST_ROWS, n_rows), 4 * most + 4), 4))

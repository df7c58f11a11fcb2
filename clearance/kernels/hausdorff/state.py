"""What a search for a directed distance knows, wants and did: one record, every number by its name.

Kernels read and write `state.lower`; Python reads `state["lower"]`. Not for: the search itself.
"""

from typing import Annotated, NamedTuple

import numpy as np

from clearance.compile.declared import ArrayOf

SEARCH_STATE = np.dtype(
    (
        np.record,
        [
            ("lower", np.float64),  # proven lower bound of the directed distance
            (
                "distance",
                np.float64,
            ),  # the value at the best point; differs from `lower` by rounding
            ("piece_a", np.int64),  # the best point: a piece of A, -1 while there is none,
            ("at_a", np.float64),  # and its local parameter
            ("piece_b", np.int64),  # its nearest point on B
            ("at_b", np.float64),
            ("upper", np.float64),  # proven upper bound of what was settled
            ("n_ends", np.int64),  # systems (11), (12) and (13) solved
            ("n_normals", np.int64),
            ("n_bisectors", np.int64),
            ("n_cuts", np.int64),  # intervals bounded
            ("n_arcs", np.int64),  # arcs of A, and those that trimming left
            ("n_kept", np.int64),
            ("n_pixels", np.int64),  # of the distance map, and the lower bound read from it
            ("map_bound", np.float64),
            ("n_given_up", np.int64),  # intervals left to their bounds
            ("root", np.float64),  # the greatest distance of any root, of whatever branch of B
            ("root_piece_a", np.int64),
            ("root_at_a", np.float64),
            ("root_piece_b", np.int64),
            ("root_at_b", np.float64),
        ],
    )
)


SearchStates = Annotated[np.ndarray, ArrayOf(SEARCH_STATE, 1)]


class SearchGoal(NamedTuple):
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


END, COMMON_NORMAL, SELF_BISECTOR = 0.0, 1.0, 2.0
"""Kinds of a witness: the systems (11), (12) and (13) that it solves."""

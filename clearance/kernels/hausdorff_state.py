"""The places of a search's numbers in its state, one name each.

The best point so far, the bounds of the directed distance, and what the search did. `LOWER` is proven where
`DISTANCE` is the value at the witnesses; they differ by the rounding of the nearest point.
"""

LOWER, DISTANCE, PIECE_A, AT_A, PIECE_B, AT_B, UPPER = 0, 1, 2, 3, 4, 5, 6
ENDS, NORMALS, BISECTORS, CUTS, ARCS, KEPT, PIXELS, MAP_BOUND, GIVEN_UP, RUNNER_UP = range(7, 17)
STATE = 17

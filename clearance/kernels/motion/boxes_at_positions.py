"""Whether the boxes of bodies may overlap with the joints at some positions, in one call.

A caller that asks about one position after another needs no poses of links, and two calls from Python cost more
than their work. Not for: known poses (`search.boxes_along_path`).
"""

import numpy as np

from clearance.compile.declared import Floats2, Floats4, Integers2
from clearance.compile.decorators import kernel
from clearance.kernels.motion.kinematics import Links, place_links
from clearance.kernels.search.boxes_along_path import CarriedBoxes, steps_together


@kernel
def overlaps_at_positions(
    links: Links,
    boxes: CarriedBoxes,
    pairs: Integers2,
    positions: Floats2,
    poses: Floats4,
    spans: Integers2,
) -> int:
    """The number of pairs whose boxes may overlap at one of n positions.

    Args:
        links: a `Links`. boxes, pairs, spans: as of `steps_together`.
        positions: (n, columns) [rad or m]. poses: (n, links, 4, 4) [m] of the links, overwritten.
    """
    all_wanted = np.zeros(len(links.parents), dtype=np.int64)
    for i in range(len(positions)):
        place_links(links, positions[i], poses[i], all_wanted, 0)
    steps_together(boxes, pairs, poses, spans)
    n_pairs = 0
    for pair in range(len(pairs)):
        if spans[pair, 1] > 0:
            n_pairs += 1
    return n_pairs

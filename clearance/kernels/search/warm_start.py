"""Warm start: the first visits of a search without earlier results, to face pairs that are probably near."""

import numpy as np

from clearance.compile.decorators import inline
from clearance.kernels.arithmetic.lanes import lane
from clearance.kernels.mesh.surface import is_leaf
from clearance.kernels.search.node_pairs import between_centres, opened, pair_in_group
from clearance.kernels.search.scratch import copy, wait

WARM_STARTS = 5
"""Node pairs to follow down to faces before the search begins at the roots."""


@inline(force=True)
def _among_nearest(scratch, first, n_found, most, node_a, node_b, bound):
    """Puts a node pair among at most `most` from place `first` on, the nearest last; how many they are."""
    if n_found == most:
        if bound >= scratch.bounds[first]:
            return n_found
        for k in range(first, first + most - 1):
            copy(scratch, k + 1, k)
        n_found -= 1
    return wait(scratch, first + n_found, node_a, node_b, bound, first) - first


@inline
def warm_start(a, b, roots, views, scratch):
    """Queues a few pairs of leaves above the pair of roots: those with the nearest centres, level by level.

    They wait like entries of a front, since the descent from the roots meets them again. Their bound is the
    distance of the centres, which may be too great; a pair skipped for it is met again as well.
    Returns (waiting, node pairs bounded).
    """
    nodes, bounds = scratch.nodes, scratch.bounds
    n_nodes = 0
    n_found = 1
    nodes[1, 0], nodes[1, 1], bounds[1] = roots.a, roots.b, 0.0
    deeper = True
    while deeper:
        deeper = False
        n_next = 0
        after = 1 + WARM_STARTS
        for i in range(n_found, 0, -1):
            node_a, node_b, near, count = np.int64(nodes[i, 0]), np.int64(nodes[i, 1]), bounds[i], 1
            is_open = not (is_leaf(a, node_a) and is_leaf(b, node_b))
            if is_open:
                group, count = opened(a, node_a, b, node_b)
                found = between_centres(a, b, views, group)
                n_nodes += count
                deeper = True
            for k in range(count):
                if is_open:
                    node_a, node_b = pair_in_group(group, k)
                    near = lane(found, k)
                n_next = _among_nearest(scratch, after, n_next, WARM_STARTS, node_a, node_b, near)
        for i in range(n_next):
            copy(scratch, after + i, 1 + i)
        n_found = n_next
    for i in range(1, 1 + n_found):
        nodes[i, 0] = ~np.int64(nodes[i, 0])
    return 1 + n_found, n_nodes

"""Warm start: where a search that knows nothing yet looks first, pairs of faces that are probably near."""

import numpy as np

from clearance.compile.decorators import inline
from clearance.kernels.arithmetic.lanes import lane
from clearance.kernels.mesh.surface import is_leaf
from clearance.kernels.search.node_pairs import between_centres, opened, pair_in_group
from clearance.kernels.search.scratch import copy, wait

WARM_STARTS = 5
"""Node pairs that a search which knows nothing yet follows down to faces before it begins at the roots."""


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
    """Lets few pairs of leaves wait over the pair of roots: those whose centres are nearest, level by level.

    They wait as what the front has, since they are met again from the roots. Their bound is the distance of the
    centres, which may be too much; a pair that is passed over for it is met there too.
    Returns (waiting, node pairs seen).
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

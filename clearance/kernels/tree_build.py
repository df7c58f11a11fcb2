"""Builds the bounding tree of one body in its own frame: boxes, one face a leaf."""

import numpy as np

from clearance.jit import inlined, kernel


@inlined
def _fit(lows, highs, order, start, stop, centre, half):
    """Writes centre and half size of the box around the faces `order[start:stop]`, rounded outward."""
    for axis in range(3):
        low = np.inf
        high = -np.inf
        for i in range(start, stop):
            low = min(low, lows[order[i], axis])
            high = max(high, highs[order[i], axis])
        middle = 0.5 * (low + high)
        reach = max(high - middle, middle - low)
        centre[axis] = middle
        half[axis] = reach * (1.0 + 4.0e-16)


@inlined
def _split(lows, highs, order, start, stop):
    """Reorders `order[start:stop]` about the mean of the widest axis of the box centres; the cut."""
    best_axis = 0
    widest = -1.0
    for axis in range(3):
        low = np.inf
        high = -np.inf
        for i in range(start, stop):
            middle = lows[order[i], axis] + highs[order[i], axis]
            low = min(low, middle)
            high = max(high, middle)
        if high - low > widest:
            widest = high - low
            best_axis = axis
    mean = 0.0
    for i in range(start, stop):
        mean += lows[order[i], best_axis] + highs[order[i], best_axis]
    mean /= stop - start
    cut = start
    for i in range(start, stop):
        face = order[i]
        if lows[face, best_axis] + highs[face, best_axis] < mean:
            order[i] = order[cut]
            order[cut] = face
            cut += 1
    if cut == start or cut == stop:
        cut = (start + stop) // 2
    return cut


@kernel
def build_tree(lows, highs, centres, halves, children):
    """Fills the (2 f - 1) nodes of a tree over f faces with boxes `lows`, `highs` (f, 3); node 0 is the root.

    `children[i]` is (left, right), or (face, -1) for a leaf.
    """
    n_faces = lows.shape[0]
    order = np.arange(n_faces)
    waiting = np.empty((2 * n_faces + 1, 3), dtype=np.int64)
    waiting[0, 0], waiting[0, 1], waiting[0, 2] = 0, 0, n_faces
    n_waiting = 1
    n_nodes = 1
    while n_waiting > 0:
        n_waiting -= 1
        node, start, stop = waiting[n_waiting, 0], waiting[n_waiting, 1], waiting[n_waiting, 2]
        _fit(lows, highs, order, start, stop, centres[node], halves[node])
        if stop - start == 1:
            children[node, 0] = order[start]
            children[node, 1] = -1
            continue
        cut = _split(lows, highs, order, start, stop)
        children[node, 0] = n_nodes
        children[node, 1] = n_nodes + 1
        waiting[n_waiting, 0], waiting[n_waiting, 1], waiting[n_waiting, 2] = n_nodes + 1, cut, stop
        n_waiting += 1
        waiting[n_waiting, 0], waiting[n_waiting, 1], waiting[n_waiting, 2] = n_nodes, start, cut
        n_waiting += 1
        n_nodes += 2

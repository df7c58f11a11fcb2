"""The roots of one numeric cluster: descents from starts scattered over all the places it can take.

Not for: choosing among them. The starts are a fixed sequence, so that the answer is the same every time.
"""

import math
from typing import NamedTuple

import numpy as np

from clearance.compile.jit import inline, kernel
from clearance.kernels.sketch.graph.graph import POINT, SIZE, TURN
from clearance.kernels.sketch.solve.motion import ClusterPlace, move, pivots_of, unknowns_of
from clearance.kernels.sketch.solve.search import next_share, solve_block


class RootSearch(NamedTuple):
    """How the roots of a cluster are searched.

    Attributes:
        size: [m] of the sketch. reach: [m] how far the starts are scattered.
        starts: how many there are. most: how many roots are kept.
    """

    size: float
    reach: float
    starts: int
    most: int


@inline
def _scatter(s, unknowns, reach, step, state):
    """Fills `step` with any turn and a shift of up to `reach` for every body and vertex; the new state."""
    body_of, first = unknowns.cluster.body_of, unknowns.first
    for v in unknowns.cluster.vertices:
        at = first[v]
        if body_of[v] >= 0 or s.kind[v] == POINT:
            for k in range(2):
                state, share = next_share(state)
                step[at + k] = reach * (2.0 * share - 1.0)
        state, share = next_share(state)
        if body_of[v] >= 0:
            step[at + 2] = math.pi * (2.0 * share - 1.0)
        elif s.kind[v] == TURN:
            step[at] = math.pi * (2.0 * share - 1.0)
        elif s.kind[v] != POINT:
            step[at] = reach * (2.0 * share - 1.0)
    return state


@inline
def _apart(s, vertices, x, y, size):
    """[m] the largest difference of two places of the cluster; directions as arcs at `size`."""
    gap = 0.0
    for v in vertices:
        i = s.root[v]
        if s.kind[v] == TURN:
            gap = max(gap, abs(size * math.sin(0.5 * (x[i] - y[i]))))
        else:
            gap = max(gap, abs(x[i] - y[i]))
            if s.kind[v] == POINT:
                gap = max(gap, abs(x[i + 1] - y[i + 1]))
    return gap


@inline
def _positive(s, vertices, x):
    """Whether every radius of the cluster is above 0."""
    for v in vertices:
        if s.kind[v] == SIZE:
            for at in range(s.member_start[v], s.member_start[v + 1]):
                if not x[s.member[at]] > 0.0:
                    return False
    return True


@kernel
def cluster_roots(s, cluster, x, n_bodies, rule, search):
    """Different roots (k, n), the cluster's place in x first, which must be one.

    Two roots are different when they are more than 1e-6 of `search.size` apart.
    """
    vertices, size, most = cluster.vertices, search.size, search.most
    unknowns = unknowns_of(s, cluster)
    step, found = np.zeros(unknowns.n), np.empty((most, x.shape[0]))
    found[0] = x
    count, state = 1, 12345
    for _ in range(search.starts):
        y = x.copy()
        place = ClusterPlace(y, pivots_of(s, cluster.body_of, n_bodies, y))
        state = _scatter(s, unknowns, search.reach, step, state)
        move(s, unknowns, step, 1.0, place)
        if not solve_block(s, cluster, place, rule):
            continue
        fresh = _positive(s, vertices, y)
        for k in range(count):
            fresh = fresh and _apart(s, vertices, y, found[k], size) > 1e-6 * size
        if fresh and count < most:
            found[count] = y
            count += 1
    return found[:count]

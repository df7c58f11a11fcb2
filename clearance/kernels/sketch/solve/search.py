"""Numeric clusters of any size: small ones by Newton, large ones by descents that learn where they fail.

A descent of a large cluster mostly ends either at a root or in a minimum whose error sits in one place, where
a few vertices lie on the wrong side of each other. Such a minimum is kicked there only: a vertex of a
violated equation, chosen with the error as weight, and its neighbours up to two equations away are moved
at random, and the descent goes on; what was right elsewhere stays. A worse minimum is taken if it is
not much worse. The sequence of random numbers is fixed.
Source: basin hopping, Wales and Doye 1997, with moves in one place.
"""

import math
from typing import NamedTuple

import numpy as np

from clearance.compile.jit import inline, kernel
from clearance.kernels.sketch.equations import evaluate
from clearance.kernels.sketch.graph.graph import POINT
from clearance.kernels.sketch.solve.damped import DescentLimits, descend_damped, narrow, nodes_of
from clearance.kernels.sketch.solve.motion import keep, move, new_kept_place, restore, unknowns_of
from clearance.kernels.sketch.solve.newton import newton

RESTARTS = 60
"""How often a numeric cluster is tried."""

KICKS = 8
"""Kicks of a large cluster for every such trial: the hardest of 100 clusters of 100 points took 150."""

BANDED = 40
"""Unknowns from which a cluster is solved on a band."""

WORK = 4e9
"""Multiplications after which a search ends: about two seconds."""

DIGITS, NEAR = 1e-2, 1e14
"""[-] Sums of squares in units of the squared tolerance between which nearly undamped steps add digits."""

FROM_SKETCH, FROM_KICK = 1e-2, 1e-4
"""[-] First damping: with the larger one more descents from the sketch end at the root nearest to it (64
against 50 of 100), with the smaller one a search takes half the steps."""

WORSE = 1.5
"""[-] How much larger the sum of squares may be after a kick that is kept."""


class Kick(NamedTuple):
    """A random move in one place.

    Attributes:
        node: where. ring: its neighbours up to so many equations away are moved as well.
        reach: [m] the length there. amount: [-] of it, or [rad] of turns, that the move is at most.
    """

    node: int
    ring: int
    reach: float
    amount: float


@inline
def next_share(state):
    """(state, uniform number in [0, 1)) of a linear congruential sequence."""
    state = (state * 6364136223846793005 + 1442695040888963407) & 0x7FFFFFFFFFFFFFFF
    return state, (state >> 22) / 2199023255552.0


@inline
def _violated(s, rows, x, nodes, state, gradient):
    """A node of an equation that does not hold, chosen with the error as weight; (state, node)."""
    of_row = nodes.of_row
    whole = 0.0
    for row in rows:
        whole += abs(evaluate(s.code, s.var, s.coef, s.value, x, row, gradient))
    state, share = next_share(state)
    left, a = share * whole, 0
    while a < rows.shape[0] - 1:
        left -= abs(evaluate(s.code, s.var, s.coef, s.value, x, rows[a], gradient))
        if left < 0.0:
            break
        a += 1
    state, share = next_share(state)
    count = 0
    for k in range(8):
        count += of_row[a, k] >= 0
    chosen, at = -1, int(share * count)
    for k in range(8):
        if of_row[a, k] >= 0:
            if at == 0:
                chosen = of_row[a, k]
            at -= 1
    return state, chosen


@inline
def _reach(s, rows, x, nodes, node, otherwise):
    """The mean distance between the points of a node's equations; `otherwise` where there are none."""
    total, count = 0.0, 0
    for at in range(nodes.start[node], nodes.start[node + 1]):
        row = rows[nodes.rows[at]]
        last = -1
        for k in range(8):
            i = s.var[row, k]
            if i < 0 or s.vertex_of[i] < 0 or s.kind[s.vertex_of[i]] != POINT:
                continue
            i = s.root[s.vertex_of[i]]
            if last >= 0 and i != last:
                total += math.hypot(x[i] - x[last], x[i + 1] - x[last + 1])
                count += 1
            last = i
    return total / count if total > 0.0 else otherwise


@inline
def _next_kick(s, rows, x, nodes, otherwise, state, gradient):
    """(state, the next kick); `otherwise` [m] is its reach where no equation says one."""
    state, node = _violated(s, rows, x, nodes, state, gradient)
    state, which = next_share(state)
    state, share = next_share(state)
    ring = int(3.0 * which)
    amount = (2.0 if ring == 0 else (1.0 if ring == 1 else 0.5)) * (0.3 + 0.7 * share)
    reach = _reach(s, rows, x, nodes, node, otherwise)
    return state, Kick(node, ring, reach, amount)


@inline
def _fill_kick(kick, nodes, column, step, state):
    """Fills `step` with random moves of a node and of its neighbours; the new state.

    `column` (nodes,) holds the first column of every node.
    """
    count = nodes.width.shape[0]
    step[:] = 0.0
    queue, depth = np.empty(count, np.int64), np.full(count, -1, np.int64)
    queue[0], depth[kick.node] = kick.node, 0
    head, tail = 0, 1
    while head < tail:
        u = queue[head]
        head += 1
        for k in range(nodes.width[u]):
            state, share = next_share(state)
            reach = 1.0 if k == 2 or nodes.is_turn[u] else kick.reach
            step[column[u] + k] = kick.amount * (2.0 * share - 1.0) * reach
        if depth[u] == kick.ring:
            continue
        for at in range(nodes.start[u], nodes.start[u + 1]):
            for k in range(8):
                w = nodes.of_row[nodes.rows[at], k]
                if w >= 0 and depth[w] < 0:
                    depth[w] = depth[u] + 1
                    queue[tail] = w
                    tail += 1
    return state


@inline
def _spacing(s, vertices, x):
    """A length for kicks where no equation has two points: the extent over the root of their number."""
    low, high, count = math.inf, -math.inf, 1
    for v in vertices:
        if s.kind[v] == POINT:
            for k in range(2):
                low, high = min(low, x[s.root[v] + k]), max(high, x[s.root[v] + k])
            count += 1
    return (high - low) / math.sqrt(count) if count > 2 and high > low else 1.0


@inline
def search_cluster(s, unknowns, place, rule):
    """Moves a large cluster until its equations hold to `rule.tolerance`; True when they do.

    On failure the place is as it was; `unknowns` are renumbered.
    """
    vertices, rows, n = unknowns.cluster.vertices, unknowns.cluster.rows, unknowns.n
    nodes = nodes_of(s, unknowns)
    half, column = narrow(unknowns, nodes)
    original, kept = new_kept_place(s, vertices, place), new_kept_place(s, vertices, place)
    keep(s, vertices, place, original)
    gradient, step = np.empty(8), np.empty(n)
    spacing, state = _spacing(s, vertices, place.x), np.int64(12345)
    enough, least = rule.tolerance * rule.tolerance, rule.floor * rule.floor
    limits = DescentLimits(FROM_SKETCH, least, enough, np.int64(120), np.int64(8))
    total, steps = math.inf, 0
    for turn in range(KICKS * rule.attempts + 1):
        if turn > 0:
            if total <= enough or float(steps) * n * half * half > WORK:
                break
            limits = DescentLimits(FROM_KICK, least, enough, np.int64(60), np.int64(4))
            keep(s, vertices, place, kept)
            state, kick = _next_kick(s, rows, place.x, nodes, spacing, state, gradient)
            state = _fill_kick(kick, nodes, column, step, state)
            move(s, unknowns, step, 1.0, place)
        after, more = descend_damped(s, unknowns, place, half, limits)
        steps += more
        if after < WORSE * total:
            total = after
        else:
            restore(s, vertices, kept, place)
    if DIGITS * enough < total <= NEAR * enough:
        limits = DescentLimits(1e-12, least, 0.0, np.int64(40), np.int64(40))
        total, _ = descend_damped(s, unknowns, place, half, limits)
    if total > enough:
        restore(s, vertices, original, place)
        return False
    return True


@kernel
def solve_block(s, cluster, place, rule):
    """Moves a cluster until its equations hold, by the method for its number of unknowns; True when they do.

    On failure the place is as it was.
    """
    unknowns = unknowns_of(s, cluster)
    if unknowns.n < BANDED:
        return newton(s, unknowns, place, rule)
    return search_cluster(s, unknowns, place, rule)

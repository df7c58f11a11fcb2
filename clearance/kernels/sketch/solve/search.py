"""Numeric clusters of any size: small ones by Newton, large ones by descents that learn where they fail.

A descent of a large cluster mostly ends either at a root or in a minimum whose error sits in one place, where
a few vertices lie on the wrong side of each other. Such a minimum is kicked there only: a vertex of a
violated equation, chosen with the error as weight, and its neighbours up to two equations away are moved
at random, and the descent goes on; what was right elsewhere stays. A worse minimum is taken if it is
not much worse. The sequence of random numbers is fixed.
Source: basin hopping, Wales and Doye 1997, with moves in one place.
"""

import math

import numpy as np

from clearance.compile.jit import inline, kernel
from clearance.kernels.sketch.equations import evaluate
from clearance.kernels.sketch.graph.graph import POINT, TURN
from clearance.kernels.sketch.solve.damped import descend_damped, incidence, narrow, nodes_of
from clearance.kernels.sketch.solve.motion import columns, freedoms, keep, move, room
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


@inline
def next_share(state):
    """(state, uniform number in [0, 1)) of a linear congruential sequence."""
    state = (state * 6364136223846793005 + 1442695040888963407) & 0x7FFFFFFFFFFFFFFF
    return state, (state >> 22) / 2199023255552.0


@inline
def _violated(s, rows, x, of_row, state, gradient):
    """A node of an equation that does not hold, chosen with the error as weight; (state, node)."""
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
def _reach(s, rows, x, node, of_row, start, mine, otherwise):
    """The mean distance between the points of a node's equations; `otherwise` where there are none."""
    total, count = 0.0, 0
    for at in range(start[node], start[node + 1]):
        row = rows[mine[at]]
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
def _kick(node, ring, of_row, start, mine, reach, amount, column, width, is_turn, step, state):
    """Fills `step` with random moves of a node and of its neighbours up to `ring` equations away."""
    count = width.shape[0]
    step[:] = 0.0
    queue, depth = np.empty(count, np.int64), np.full(count, -1, np.int64)
    queue[0], depth[node] = node, 0
    head, tail = 0, 1
    while head < tail:
        u = queue[head]
        head += 1
        for k in range(width[u]):
            state, share = next_share(state)
            turning = k == 2 or is_turn[u]
            step[column[u] + k] = amount * (2.0 * share - 1.0) * (1.0 if turning else reach)
        if depth[u] == ring:
            continue
        for at in range(start[u], start[u + 1]):
            for k in range(8):
                w = of_row[mine[at], k]
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
def search(s, vertices, rows, x, body_of, pivot, first, floor, tolerance, kicks):
    """Moves the vertices of a large cluster until their equations hold; True when they do.

    On failure x is as it was. `first` (v,) is scratch: -1 on entry and on return. Over 60 lines: kicks and
    descents share the numbering, the random state and what is kept; a phase apart would take all of it.
    """
    n = columns(s, vertices, body_of, first)
    node_at, width, of_row = nodes_of(s, vertices, rows, first, n)
    start, mine = incidence(of_row, width.shape[0])
    is_turn = np.zeros(width.shape[0], np.uint8)
    for v in vertices:
        is_turn[node_at[first[v]]] = body_of[v] < 0 and s.kind[v] == TURN
    half, column = narrow(vertices, first, n, node_at, width, of_row, start, mine)
    original, kept = np.empty(room(s, vertices)), np.empty(room(s, vertices))
    keep(s, vertices, x, original, False)
    pivots, kept_pivots = pivot.copy(), pivot.copy()
    gradient, step = np.empty(8), np.empty(n)
    spacing, state = _spacing(s, vertices, x), np.int64(12345)
    enough, least = tolerance * tolerance, floor * floor
    total, steps, damping = math.inf, 0, FROM_SKETCH
    longest, patience = np.int64(120), np.int64(8)
    for turn in range(kicks + 1):
        if turn > 0:
            if total <= enough or float(steps) * n * half * half > WORK:
                break
            damping, longest, patience = FROM_KICK, np.int64(60), np.int64(4)
            keep(s, vertices, x, kept, False)
            kept_pivots[:] = pivot
            state, node = _violated(s, rows, x, of_row, state, gradient)
            state, which = next_share(state)
            state, share = next_share(state)
            ring = int(3.0 * which)
            amount = (2.0 if ring == 0 else (1.0 if ring == 1 else 0.5)) * (0.3 + 0.7 * share)
            reach = _reach(s, rows, x, node, of_row, start, mine, spacing)
            state = _kick(
                node, ring, of_row, start, mine, reach, amount, column, width, is_turn, step, state
            )
            move(s, vertices, step, 1.0, x, first, body_of, pivot)
        after, more = descend_damped(
            s, vertices, rows, x, body_of, pivot, first, n, half, damping, least, enough, longest,
            patience,
        )  # fmt: skip
        steps += more
        if after < WORSE * total:
            total = after
        else:
            keep(s, vertices, x, kept, True)
            pivot[:] = kept_pivots
    if DIGITS * enough < total <= NEAR * enough:
        longest = np.int64(40)
        total, _ = descend_damped(
            s,
            vertices,
            rows,
            x,
            body_of,
            pivot,
            first,
            n,
            half,
            1e-12,
            least,
            0.0,
            longest,
            longest,
        )
    for v in vertices:
        first[v] = -1
    if total > enough:
        keep(s, vertices, x, original, True)
        pivot[:] = pivots
        return False
    return True


@kernel
def solve_block(s, vertices, rows, x, body_of, pivot, floor, tolerance, attempts):
    """Moves the vertices until their equations hold, by the method for their number; True when they do.

    `vertices` lists a body's members together; on failure x is as it was.
    """
    first = np.full(s.kind.shape[0], -1, np.int64)
    if freedoms(s, vertices, body_of) < BANDED:
        return newton(s, vertices, rows, x, body_of, pivot, first, floor, tolerance, attempts)
    kicks = KICKS * attempts
    return search(s, vertices, rows, x, body_of, pivot, first, floor, tolerance, kicks)

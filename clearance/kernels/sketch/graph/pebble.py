"""The pebble game: which equations of the core depend on others by Definitions 1 to 3, and on
which.

Every vertex holds as many pebbles as degrees of freedom; an equation is independent when four
pebbles can be gathered on its vertices, and then one of them pays for it. A dependent equation
closes a circuit: itself and the equations of the least tight set around it (three pebbles in all),
found by following payments.
Source: Jacobs and Hendrickson 1997; Lee and Streinu 2008 for hypergraphs and other counts.
"""

import numpy as np

from clearance.compile.jit import inline, kernel
from clearance.kernels.sketch.graph.graph import POINT


@inline
def _search(v, stamp, ends, paid_start, paid_next, pebbles, seen, came, via, queue):
    """Frees one pebble onto v by passing payments along; True when one was found.

    `seen` marks with `stamp` what was visited; vertices already marked are not entered.
    """
    head, tail = 0, 1
    queue[0] = v
    while head < tail:
        u = queue[head]
        head += 1
        row = paid_start[u]
        while row >= 0:
            for k in range(ends.shape[1]):
                w = ends[row, k]
                if w < 0 or seen[w] == stamp:
                    continue
                seen[w] = stamp
                came[w], via[w] = u, row
                if pebbles[w] > 0:
                    _pass(v, w, paid_start, paid_next, pebbles, came, via)
                    return True
                queue[tail] = w
                tail += 1
            row = paid_next[row]
    return False


@inline
def _pass(v, w, paid_start, paid_next, pebbles, came, via):
    """Lets w pay for the edge it was reached by, that edge's payer for the one before, and so on to
    v."""
    pebbles[w] -= 1
    while True:
        u, row = came[w], via[w]
        before = -1
        at = paid_start[u]
        while at != row:
            before = at
            at = paid_next[at]
        if before < 0:
            paid_start[u] = paid_next[row]
        else:
            paid_next[before] = paid_next[row]
        paid_next[row] = paid_start[w]
        paid_start[w] = row
        if u == v:
            pebbles[v] += 1
            return
        w = u


@kernel
def play(kind, ends, absolute, live):
    """Which live equations are dependent, with their circuits.

    Returns (dependent rows (k,), circuit starts (k + 1,), circuit rows).
    The known direction of the ground is a vertex of its own, tied to the ground by one extra edge.
    """
    n, m = kind.shape[0], ends.shape[0]
    pebbles = np.ones(n + 1, np.int64)
    for v in range(n):
        if kind[v] == POINT:
            pebbles[v] = 2
    pebbles[0], pebbles[n] = 3, 0
    mine = np.full((m + 1, 5), -1, np.int64)
    mine[m, 0], mine[m, 1] = 0, n
    paid_start = np.full(n + 1, -1, np.int64)
    paid_next = np.full(m + 1, -1, np.int64)
    paid_start[n] = m
    seen = np.full(n + 1, -1, np.int64)
    came = np.empty(n + 1, np.int64)
    via = np.empty(n + 1, np.int64)
    queue = np.empty(n + 2, np.int64)
    dependent = np.empty(m, np.int64)
    starts = np.zeros(m + 1, np.int64)
    circuit = np.empty(max(m, 1) * 4 + 16, np.int64)
    count, filled, stamp = 0, 0, 0
    for turn in range(2 * m):  # what is held by the ground first: a dimension is the better suspect
        row = turn % m
        if not live[row] or (absolute[row] == 1) != (turn < m):
            continue
        for k in range(5):
            mine[row, k] = ends[row, k]
            if ends[row, k] == 0 and absolute[row] != 1:
                mine[row, k] = n
        total = 0
        for k in range(5):
            total += pebbles[mine[row, k]] if mine[row, k] >= 0 else 0
        grew = True
        while total < 4 and grew:
            grew = False
            for k in range(5):
                v = mine[row, k]
                if v < 0:
                    continue
                stamp += 1
                for j in range(5):
                    if mine[row, j] >= 0:
                        seen[mine[row, j]] = stamp
                if _search(v, stamp, mine, paid_start, paid_next, pebbles, seen, came, via, queue):
                    total += 1
                    grew = True
                    break
        if total >= 4:
            for k in range(5):
                v = mine[row, k]
                if v >= 0 and pebbles[v] > 0:
                    pebbles[v] -= 1
                    paid_next[row] = paid_start[v]
                    paid_start[v] = row
                    break
            continue
        stamp += 1
        tail = 0
        for k in range(5):
            if mine[row, k] >= 0:
                seen[mine[row, k]] = stamp
                queue[tail] = mine[row, k]
                tail += 1
        head = 0
        while head < tail:
            at = paid_start[queue[head]]
            head += 1
            while at >= 0:
                if at < m:
                    if filled + 1 >= circuit.shape[0]:
                        larger = np.empty(2 * circuit.shape[0], np.int64)
                        larger[:filled] = circuit[:filled]
                        circuit = larger
                    circuit[filled] = at
                    filled += 1
                for k in range(5):
                    w = mine[at, k]
                    if w >= 0 and seen[w] != stamp:
                        seen[w] = stamp
                        queue[tail] = w
                        tail += 1
                at = paid_next[at]
        circuit[filled] = row
        filled += 1
        dependent[count] = row
        count += 1
        starts[count] = filled
        mine[row, :] = -1
    return dependent[:count], starts[: count + 1], circuit[:filled]

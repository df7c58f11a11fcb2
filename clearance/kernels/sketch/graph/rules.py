"""Rules A and B: in which order the nodes of an under-constrained core are merged.

A node is a rigid body or a single vertex. Basic clusters (Fig. 8 b to d) are merged first; when there is
none, freedom is left and an under-constrained cluster (Fig. 13) is merged, as many conditions being
assumed as it lacks. Rule B takes it from the cycle of least freedom and, among those, of most vertices,
and starts a body there if the cycle has none; rule A takes any where there is no cycle. The wrong choice
would leave a rest that no basic cluster takes in (Fig. 14).
Source: Kwon, Lee, Lee 2001, section 4.1; candidates for the least cycle: Horton 1987.
"""

from typing import NamedTuple

import numpy as np

from clearance.compile.jit import inline, kernel

RULED = 100
"""Nodes of a core up to which the rules are applied: the search for cycles grows with the cube."""


class MergeOrder(NamedTuple):
    """The order in which nodes (or the vertices in them) are taken in.

    Attributes:
        turn: (n,) counted from 0; ties are those merged at once.
        lacking: (n,) how many conditions are missing then.
        home: (n,) a cluster that began without a body and took in single nodes until it met another
            cluster; -1 outside such.
    """

    turn: np.ndarray
    lacking: np.ndarray
    home: np.ndarray


@inline
def _labels(row_nodes, row, group, mine):
    """The distinct clusters of an equation, in `mine`; how many."""
    count = 0
    for k in range(5):
        node = row_nodes[row, k]
        if node < 0:
            continue
        g = group[node]
        fresh = True
        for j in range(count):
            fresh = fresh and mine[j] != g
        if fresh:
            mine[count] = g
            count += 1
    return count


@inline
def _between(row_nodes, group, n):
    """How many equations join every two clusters (n, n), those of just the two."""
    out, mine = np.zeros((n, n), np.int64), np.empty(5, np.int64)
    for row in range(row_nodes.shape[0]):
        if _labels(row_nodes, row, group, mine) == 2:
            out[mine[0], mine[1]] += 1
            out[mine[1], mine[0]] += 1
    return out


@inline
def _freedom(inside, row_nodes, group, dof):
    """The freedom left in a set of clusters: their own less the equations among them."""
    total, mine = 0, np.empty(5, np.int64)
    for g in range(inside.shape[0]):
        if inside[g]:
            total += dof[g]
    for row in range(row_nodes.shape[0]):
        count = _labels(row_nodes, row, group, mine)
        within = count > 1
        for k in range(count):
            within = within and inside[mine[k]]
        total -= within
    return total


@inline
def _basic(joined, dof):
    """Two or three clusters that the equations among them make rigid (Fig. 8 b, c, d); -1 pads."""
    n = dof.shape[0]
    for a in range(n):
        for b in range(a + 1, n):
            if joined[a, b] and max(dof[a], dof[b]) == 3 and dof[a] + dof[b] - joined[a, b] <= 3:
                return a, b, -1
    for a in range(n):
        for b in range(a + 1, n):
            if not joined[a, b]:
                continue
            for c in range(b + 1, n):
                bodies = int(dof[a] == 3) + int(dof[b] == 3) + int(dof[c] == 3)
                if joined[a, c] and joined[b, c] and bodies >= 2:
                    within = joined[a, b] + joined[a, c] + joined[b, c]
                    if dof[a] + dof[b] + dof[c] - within <= 3:
                        return a, b, c
    return -1, -1, -1


@inline
def _tree(root, joined, came, depth):
    """Breadth first from a cluster: `came` and `depth` (n,), -1 where not reached."""
    n = joined.shape[0]
    came[:], depth[:] = -1, -1
    queue = np.empty(n, np.int64)
    queue[0], depth[root] = root, 0
    head, tail = 0, 1
    while head < tail:
        u = queue[head]
        head += 1
        for v in range(n):
            if joined[u, v] and depth[v] < 0:
                depth[v], came[v] = depth[u] + 1, u
                queue[tail] = v
                tail += 1


@inline
def rule_b(joined, row_nodes, group, dof):
    """Marks (n,) of the cycle of least freedom and most vertices; no mark where there is no cycle.

    Two clusters joined by two equations are a cycle, too.
    """
    n = dof.shape[0]
    best, inside = np.zeros(n, np.uint8), np.zeros(n, np.uint8)
    least, most = 1 << 30, 0
    came, depth = np.empty(n, np.int64), np.empty(n, np.int64)
    for root in range(n):
        _tree(root, joined, came, depth)
        for u in range(n):
            for v in range(u + 1, n):
                double = came[v] == u or came[u] == v
                if not joined[u, v] or depth[u] < 0 or (double and joined[u, v] < 2):
                    continue
                inside[:] = 0
                a, b, count = u, v, 0
                while a >= 0 or b >= 0:
                    if a >= 0 and not inside[a]:
                        inside[a] = 1
                        count += 1
                    if b >= 0 and not inside[b]:
                        inside[b] = 1
                        count += 1
                    a, b = came[a] if a >= 0 else -1, came[b] if b >= 0 else -1
                if double and root != u and root != v:
                    continue
                if not double and count != depth[u] + depth[v] + 1:
                    continue
                freedom = _freedom(inside, row_nodes, group, dof)
                if freedom < least or (freedom == least and count > most):
                    least, most = freedom, count
                    best[:] = inside
    return best


@inline
def rule_a(joined):
    """Marks (n,) of everything: without a cycle no assumption can contradict another."""
    return np.ones(joined.shape[0], np.uint8)


@inline
def _under(inside, joined, dof):
    """The two marked clusters to merge with the fewest assumptions (Fig. 13 b, c, d); without a body,
    the two of an initial one (Fig. 13 a). -1 where nothing is joined."""
    n = dof.shape[0]
    body = False
    for g in range(n):
        body = body or (inside[g] and dof[g] == 3)
    least, first, second = 1 << 30, -1, -1
    for a in range(n):
        for b in range(a + 1, n):
            if not (inside[a] and inside[b] and joined[a, b]):
                continue
            if body and max(dof[a], dof[b]) < 3:
                continue
            missing = dof[a] + dof[b] - joined[a, b] - 3
            if missing < least:
                least, first, second = missing, a, b
    return first, second


@inline
def _take_in(order, chosen, own, now, missing):
    """Gives the chosen nodes (n,) their turns, where a body starts it goes first; the next turn.

    What is missing is noted at the first of the nodes that come in. `own` (n,) are the nodes' freedoms.
    """
    turn = order.turn
    begun, leader = False, -1
    for g in range(turn.shape[0]):
        if chosen[g]:
            begun = begun or turn[g] >= 0
            if leader < 0 or (own[g] == 3 and own[leader] < 3):
                leader = g
    if not begun:
        turn[leader] = now
        now += 1
    for g in range(turn.shape[0]):
        if turn[g] < 0 and chosen[g]:
            turn[g] = now
            order.lacking[g] = missing
            missing = 0
    return now + 1


@inline
def _next_merge(row_nodes, group, dof):
    """The clusters a, b and c to merge next (-1 pads; a is -1 where nothing is joined), and what they lack."""
    joined = _between(row_nodes, group, dof.shape[0])
    a, b, c = _basic(joined, dof)
    if a >= 0:
        return a, b, c, 0
    inside = rule_b(joined, row_nodes, group, dof)
    if not inside.any():
        inside = rule_a(joined)
    a, b = _under(inside, joined, dof)
    missing = max(dof[a] + dof[b] - joined[a, b] - 3, 0) if a >= 0 else 0
    return a, b, -1, missing


@kernel
def merge_order(row_nodes, dof):
    """The order in which the nodes are taken in; see `MergeOrder`.

    Args:
        row_nodes: (m, 5) the distinct nodes of every equation between nodes, -1 pads.
        dof: (n,) freedoms of the nodes: 3 of a body, 2 or 1 of a vertex; becomes those of clusters.
    """
    n = dof.shape[0]
    order = MergeOrder(np.full(n, -1, np.int64), np.zeros(n, np.int64), np.full(n, -1, np.int64))
    group, own, now = np.arange(n), dof.copy(), 0
    closed, chosen = np.zeros(n, np.uint8), np.zeros(n, np.uint8)
    while True:
        a, b, c, missing = _next_merge(row_nodes, group, dof)
        if a < 0:
            break
        for g in range(n):
            chosen[g] = group[g] == a or group[g] == b or (c >= 0 and group[g] == c)
        now = _take_in(order, chosen, own, now, missing)
        clusters = int(dof[a] == 3) + int(dof[b] == 3) + int(c >= 0 and dof[c] == 3)
        if clusters > 1 or closed[a] or closed[b] or own[a] == 3 or own[b] == 3:
            closed[a] = 1
        else:
            for g in range(n):
                if chosen[g]:
                    order.home[g] = a
        for g in range(n):
            if chosen[g]:
                group[g] = a
        dof[a], dof[b] = 3, 0
        if c >= 0:
            dof[c] = 0
    for g in range(n):
        if order.turn[g] < 0:
            order.turn[g] = now
    return order

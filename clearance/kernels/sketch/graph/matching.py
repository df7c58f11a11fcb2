"""The least sets of nodes that are solvable at once, in the order of placing.

A node is a rigid body of three freedoms or a vertex, and one of them is held. A matching of edges to freedoms and
the strongly connected parts of the directed graph give the smallest clusters (Fig. 8 c and d of the paper, and
extended ones). Not for: finding the bodies (`sketch.graph.bodies`).
Source: Kwon, Lee, Lee 2001, section 3.5; Hoffmann, Lomonosov, Sitharam 1997 for minimal dense subgraphs.
"""

from typing import NamedTuple

import numpy as np

from clearance.compile.jit import inline


class Matching(NamedTuple):
    """Edges assigned to freedoms of nodes, and the search for a freedom of one more.

    Attributes:
        ends: (m, 5) the vertices of every edge, -1 pads.
        hold: (v,) the node of every vertex, -1: held fast.
        capacity: (nodes,) the freedoms of every node that are not used yet.
        owner: (m,) the node of every edge, -1 for none.
        paid: (2, ...) the first edge of every node, and of every edge the next one of its node.
        seen: (nodes,) the last edge whose search came by.
        came: (m,) the edge by which the search came; queue: (m + 1,) its edges.
    """

    ends: np.ndarray
    hold: np.ndarray
    capacity: np.ndarray
    owner: np.ndarray
    paid: np.ndarray
    seen: np.ndarray
    came: np.ndarray
    queue: np.ndarray


@inline(force=True)
def _augment(matching, row):
    """Finds a freedom for an edge by moving others; True when it has one."""
    ends, hold, queue, came = matching.ends, matching.hold, matching.queue, matching.came
    seen, paid = matching.seen, matching.paid
    head, tail = 0, 1
    queue[0] = row
    came[row] = -1
    while head < tail:
        e = queue[head]
        head += 1
        for k in range(5):
            v = ends[e, k]
            if v < 0:
                continue
            node = hold[v]
            if node < 0 or seen[node] == row:
                continue
            seen[node] = row
            if matching.capacity[node] > 0:
                matching.capacity[node] -= 1
                _hand_over(matching, e, node)
                return True
            at = paid[0, node]
            while at >= 0:
                queue[tail] = at
                came[at] = e
                tail += 1
                at = paid[1, at]
    return False


@inline(force=True)
def _hand_over(matching, e, node):
    """Gives e the node; the node that it leaves goes to the edge before it, and so on to the first."""
    owner = matching.owner
    while e >= 0:
        before = owner[e]
        _move_payment(e, before, node, matching.paid)
        owner[e] = node
        node = before
        e = matching.came[e]


@inline(force=True)
def _move_payment(e, before, node, paid):
    """Takes edge e off the list of node `before` (-1: none) and puts it on that of `node`."""
    if before >= 0:
        at, last = paid[0, before], -1
        while at != e:
            last = at
            at = paid[1, at]
        if last < 0:
            paid[0, before] = paid[1, e]
        else:
            paid[1, last] = paid[1, e]
    paid[1, e] = paid[0, node]
    paid[0, node] = e


@inline(reference_counts=True)
def match(order, ends, live, hold, capacity):
    """Assigns the live edges, in `order`, each to the first of its nodes with freedom left.

    `capacity` (nodes,) becomes what is unused. `hold` (v,) is the node of every vertex (-1: held fast).
    Returns the node (m,) of every edge, -1 where there was none.
    """
    m = ends.shape[0]
    owner = np.full(m, -1, np.int64)
    paid = np.full((2, max(m, capacity.shape[0])), -1, np.int64)
    seen = np.full(capacity.shape[0], -1, np.int64)
    came = np.empty(m, np.int64)
    queue = np.empty(m + 1, np.int64)
    matching = Matching(ends, hold, capacity, owner, paid, seen, came, queue)
    for row in order:
        if live[row]:
            _augment(matching, row)
    return owner


@inline
def _rows_of_nodes(live, owner, n_nodes):
    """The live edges that every node owns as (starts (nodes + 1,), rows)."""
    start = np.zeros(n_nodes + 1, np.int64)
    for row in range(owner.shape[0]):
        if live[row] and owner[row] >= 0:
            start[owner[row] + 1] += 1
    start = np.cumsum(start)
    rows = np.empty(start[-1], np.int64)
    fill = start[:-1].copy()
    for row in range(owner.shape[0]):
        if live[row] and owner[row] >= 0:
            rows[fill[owner[row]]] = row
            fill[owner[row]] += 1
    return start, rows


@inline(reference_counts=True)
def ordered_parts(ends, live, hold, owner, n_nodes, present):
    """Strongly connected parts of "is placed from" in the order of placing.

    Returns (part of every node (-1 where absent), number of parts). Tarjan's algorithm, without
    recursion.
    """
    start, mine = _rows_of_nodes(live, owner, n_nodes)
    part = np.full(n_nodes, -1, np.int64)
    index = np.full(n_nodes, -1, np.int64)
    low = np.zeros(n_nodes, np.int64)
    stack, calls = np.empty(n_nodes, np.int64), np.empty(n_nodes, np.int64)
    where = np.zeros(n_nodes, np.int64)
    height, clock, parts = 0, 0, 0
    for first in range(n_nodes):
        if not present[first] or index[first] >= 0:
            continue
        depth = 0
        calls[0] = first
        index[first] = low[first] = clock
        clock += 1
        stack[height] = first
        height += 1
        while depth >= 0:
            u = calls[depth]
            if where[u] < 5 * (start[u + 1] - start[u]):
                row = mine[start[u] + where[u] // 5]
                v = ends[row, where[u] % 5]
                where[u] += 1
                w = hold[v] if v >= 0 else -1
                if w < 0 or w == u:
                    continue
                if index[w] < 0:
                    index[w] = low[w] = clock
                    clock += 1
                    stack[height] = w
                    height += 1
                    depth += 1
                    calls[depth] = w
                elif part[w] < 0:
                    low[u] = min(low[u], index[w])
                continue
            if low[u] == index[u]:
                while True:
                    height -= 1
                    w = stack[height]
                    part[w] = parts
                    if w == u:
                        break
                parts += 1
            depth -= 1
            if depth >= 0:
                low[calls[depth]] = min(low[calls[depth]], low[u])
    return part, parts

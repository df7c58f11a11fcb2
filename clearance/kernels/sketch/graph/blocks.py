"""The core in clusters: rigid bodies grown along rigid chains, then the least sets solvable at
once.

A body starts from two entities with three degrees of freedom and takes in every vertex that hangs
on it by as many edges as it has freedom (Fig. 8 a and b of the paper). With bodies contracted to
vertices of three freedoms and one of them held, a matching of edges to freedoms and the strongly
connected parts of the directed graph give the smallest clusters (Fig. 8 c and d, and extended ones)
in the order of placing.
Source: Kwon, Lee, Lee 2001, section 3.5; Hoffmann, Lomonosov, Sitharam 1997 for minimal dense
subgraphs.
"""

import numpy as np

from clearance.compile.jit import inline, kernel
from clearance.kernels.sketch.graph.graph import POINT, SLIDE, TURN


@inline
def _hangs(row, v, line, ends, body_of, body):
    """Whether all ends of the edge other than v (and `line`, its direction) belong to the body."""
    for k in range(5):
        u = ends[row, k]
        if u >= 0 and u != v and u != line and body_of[u] != body:
            return False
    return True


@inline
def _hanging(v, line, ends, starts, rows, live, body_of, body, found):
    """Up to two edges that tie v to the body, in `found`; how many."""
    count = 0
    for at in range(starts[v], starts[v + 1]):
        if count < 2 and live[rows[at]] and _hangs(rows[at], v, line, ends, body_of, body):
            found[count] = rows[at]
            count += 1
    return count


@inline
def _grow(
    seeds, n_seeds, body, kind, ends, starts, rows, live, theta_of, free, body_of, log, n_log, found
):
    """Grows a body from its seeds; appends (vertex, partner, edges) to `log` from `n_log` on; its
    new end."""
    queue = np.empty(64, np.int64)
    tail = 0
    for k in range(n_seeds):
        queue[tail] = seeds[k]
        tail += 1
    head = 0
    while head < tail:
        u = queue[head]
        head += 1
        for at in range(starts[u], starts[u + 1]):
            row = rows[at]
            if not live[row]:
                continue
            for k in range(5):
                v = ends[row, k]
                if v <= 0 or not free[v] or body_of[v] >= 0 or kind[v] == TURN:
                    continue
                line = -1
                if kind[v] == SLIDE and body_of[theta_of[v]] != body:
                    line = theta_of[v]
                    if line == 0 or body_of[line] >= 0 or not free[line]:
                        continue
                need = 2 if kind[v] == POINT or line >= 0 else 1
                if _hanging(v, line, ends, starts, rows, live, body_of, body, found) < need:
                    continue
                body_of[v] = body
                log[n_log, 0], log[n_log, 1] = v, -1
                if line >= 0:
                    body_of[line] = body
                    log[n_log, 0], log[n_log, 1] = line, v
                log[n_log, 2], log[n_log, 3] = found[0], found[1] if need == 2 else -1
                n_log += 1
                if tail + 2 > queue.shape[0]:
                    larger = np.empty(2 * queue.shape[0], np.int64)
                    larger[:tail] = queue[:tail]
                    queue = larger
                queue[tail] = v
                tail += 1
                if line >= 0:
                    queue[tail] = line
                    tail += 1
    return n_log


@kernel
def bodies(kind, ends, starts, rows, live, theta_of, free):
    """Rigid bodies of at least three entities among the `free` vertices, each entity in at most
    one.

    Returns (body_of (v,), steps (s, 4) of vertex, partner and two edges, step starts of every
    body). The first steps of a body are its initial cluster: they have fewer edges than freedoms.
    """
    n = kind.shape[0]
    body_of = np.full(n, -1, np.int64)
    log = np.full((n + 4, 4), -1, np.int64)
    body_start = np.zeros(n + 1, np.int64)
    found = np.empty(2, np.int64)
    seeds = np.empty(3, np.int64)
    count, n_log = 0, 0
    for row in range(ends.shape[0]):
        if not live[row] or ends[row, 1] <= 0:
            continue
        a, b, c, usable = -1, -1, -1, ends[row, 3] < 0
        for k in range(3):
            v = ends[row, k]
            if v >= 0:
                usable = usable and v > 0 and free[v] and body_of[v] < 0
                if v > 0 and kind[v] == POINT:
                    usable = usable and b < 0  # an edge of two points, not of three
                    a, b = (v, a)
                elif v > 0 and kind[v] == TURN:
                    c = v
                elif v > 0 and kind[v] == SLIDE and b < 0:
                    b = v
                else:
                    usable = False
        if not usable or a < 0 or b < 0 or (kind[b] == POINT) != (c < 0):
            continue
        begin = n_log
        body_of[a] = body_of[b] = count
        seeds[0], seeds[1], seeds[2] = a, b, c
        if c >= 0:
            body_of[c] = count
            log[begin, :] = np.array([c, b, -1, -1])
            log[begin + 1, :] = np.array([a, -1, row, -1])
        else:
            log[begin, :] = np.array([b, -1, -1, -1])
            log[begin + 1, :] = np.array([a, -1, row, -1])
        n_log = _grow(
            seeds, 3 if c >= 0 else 2, count, kind, ends, starts, rows, live, theta_of, free,
            body_of, log, begin + 2, found,
        )  # fmt: skip
        if n_log == begin + 2:
            body_of[a] = body_of[b] = -1
            if c >= 0:
                body_of[c] = -1
            n_log = begin
            continue
        count += 1
        body_start[count] = n_log
    return body_of, log[:n_log], body_start[: count + 1]


@inline
def assumed_bodies(kind, ends, starts, rows, live, body_of, n_bodies, turn, lack, home):
    """Makes bodies of homes of at least three points, each hung on those before it by at most two edges.

    What they lack is assumed inside (Fig. 13 a and b); `lack` (v,) becomes 0 there. Returns (steps as of
    `bodies`, their starts).
    """
    n = kind.shape[0]
    log, start = np.full((n, 4), -1, np.int64), np.zeros(n + 1, np.int64)
    order = np.argsort(turn, kind="mergesort")
    count, n_log = 0, 0
    for h in range(n):
        at_log, good = n_log, True
        for v in order:
            if home[v] != h or v == 0:
                continue
            hung = 0
            for at in range(starts[v], starts[v + 1]):
                if live[rows[at]] and _hangs(rows[at], v, -1, ends, body_of, n_bodies + count):
                    if hung < 2:
                        log[at_log, 2 + hung] = rows[at]
                    hung += 1
            first = at_log - n_log
            good = good and kind[v] == POINT and hung <= 2
            good = good and (first > 1 or hung == first)
            log[at_log, 0] = v
            body_of[v] = n_bodies + count
            at_log += 1
        if good and at_log >= n_log + 3:
            for at in range(n_log, at_log):
                lack[log[at, 0]] = 0
            count, n_log = count + 1, at_log
            start[count] = n_log
            continue
        for at in range(n_log, at_log):
            body_of[log[at, 0]] = -1
            log[at, :] = -1
    return log[:n_log], start[: count + 1]


@inline
def _augment(row, stamp, hold, ends, owner, capacity, paid, seen, came, queue):
    """Finds a freedom for an edge by moving others; True when it has one. `hold` maps vertices to
    nodes."""
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
            if node < 0 or seen[node] == stamp:
                continue
            seen[node] = stamp
            if capacity[node] > 0:
                capacity[node] -= 1
                while (
                    e >= 0
                ):  # e takes this node; the node it leaves is taken by the edge before it
                    before = owner[e]
                    _move_payment(e, before, node, paid)
                    owner[e] = node
                    node = before
                    e = came[e]
                return True
            at = paid[0, node]
            while at >= 0:
                queue[tail] = at
                came[at] = e
                tail += 1
                at = paid[1, at]
    return False


@inline
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


@kernel
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
    for row in order:
        if live[row]:
            _augment(row, row, hold, ends, owner, capacity, paid, seen, came, queue)
    return owner


@kernel
def ordered_parts(ends, live, hold, owner, n_nodes, present):
    """Strongly connected parts of "is placed from" in the order of placing.

    Returns (part of every node (-1 where absent), number of parts). Tarjan's algorithm, without
    recursion.
    """
    start = np.zeros(n_nodes + 1, np.int64)
    for row in range(ends.shape[0]):
        if live[row] and owner[row] >= 0:
            start[owner[row] + 1] += 1
    start = np.cumsum(start)
    mine = np.empty(start[-1], np.int64)
    fill = start[:-1].copy()
    for row in range(ends.shape[0]):
        if live[row] and owner[row] >= 0:
            mine[fill[owner[row]]] = row
            fill[owner[row]] += 1
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

"""The core's parts and nodes: what is held first, what is joined, which equations place what.

A part is what equations connect; a node is a rigid body or a single vertex. Not for: finding the bodies
(`sketch.graph.blocks`), nor the order of the rules (`sketch.graph.rules`).
"""

import numpy as np

from clearance.compile.jit import inline, kernel
from clearance.kernels.arithmetic.union_find import find_root
from clearance.kernels.sketch.graph.blocks import match
from clearance.kernels.sketch.graph.graph import POINT, SLIDE, TURN
from clearance.kernels.sketch.graph.rules import RULED, merge_order


@kernel
def components(kind, ends, theta_of, absolute):
    """The connected part of every vertex (the ground's is -1), and how each hangs on the ground.

    Returns (part (v,), number, hold (parts,)): 0 not at all, 1 by directions only, 2 by position.
    """
    n = kind.shape[0]
    group = np.arange(n)
    for row in range(ends.shape[0]):
        first = -1
        for k in range(5):
            v = ends[row, k]
            if v > 0:
                a = find_root(group, v)
                if first >= 0:
                    group[max(a, first)] = min(a, first)
                    a = min(a, first)
                first = a
    for v in range(1, n):
        if kind[v] == SLIDE and theta_of[v] > 0:
            a, b = find_root(group, v), find_root(group, theta_of[v])
            group[max(a, b)] = min(a, b)
    part = np.full(n, -1, np.int64)
    count = 0
    for v in range(1, n):
        r = find_root(group, v)
        if r == v:
            part[v] = count
            count += 1
        else:
            part[v] = part[r]
    hold = np.zeros(count, np.int64)
    for row in range(ends.shape[0]):
        grounded = False
        for k in range(5):
            grounded = grounded or ends[row, k] == 0
        if grounded:
            for k in range(5):
                if ends[row, k] > 0:
                    p = part[ends[row, k]]
                    hold[p] = max(hold[p], 2 if absolute[row] == 1 else 1)
    for v in range(1, n):
        if kind[v] == SLIDE and theta_of[v] == 0:
            hold[part[v]] = max(hold[part[v]], 1)
    return part, count, hold


@inline
def turns_by_rule(kind, ends, live, free, part, n_parts, hold, body_of, n_bodies, absolute):
    """The turn (v,) at which rules A and B take in every vertex of a core with freedom left, the conditions
    (v,) that are assumed for its node then, and its home (v,), a cluster that begins with an assumption.

    Turns and conditions are 0 and homes -1 where no freedom is left or the core is too large for the rules.
    """
    n, m = kind.shape[0], ends.shape[0]
    turn, lack, home = np.zeros(n, np.int64), np.zeros(n, np.int64), np.full(n, -1, np.int64)
    node = np.full(n, -1, np.int64)
    dof = np.full(n_bodies + n + 1, 3, np.int64)
    present, seen = n_bodies, np.zeros(n_parts, np.uint8)
    spare = 0
    for v in range(1, n):
        if not free[v]:
            continue
        if not seen[part[v]]:
            seen[part[v]] = 1
            spare -= 0 if hold[part[v]] == 2 else 3 - hold[part[v]]
        if body_of[v] >= 0:
            node[v] = body_of[v]
            continue
        node[v] = present
        dof[present] = 2 if kind[v] == POINT else 1
        present += 1
    rows, count = np.full((m, 5), -1, np.int64), 0
    for row in range(m):
        if not live[row]:
            continue
        several = False
        for k in range(5):
            v = ends[row, k]
            if v > 0 or (v == 0 and absolute[row] == 1):
                rows[count, k] = node[v] if v > 0 else present
                several = several or rows[count, k] != rows[count, 0]
        if several:
            count += 1
        else:
            rows[count, :] = -1
    for k in range(present):
        spare += dof[k]
    if present > RULED or spare <= count:
        return turn, lack, home
    turn_of, lacking, home_of = merge_order(rows[:count], dof[: present + 1])
    for v in range(1, n):
        if node[v] >= 0:
            turn[v] = turn_of[node[v]]
            lack[v] = lacking[node[v]]
            lacking[node[v]] = 0
            home[v] = home_of[node[v]]
    return turn, lack, home


@inline
def _by_turn(ends, turn):
    """The order of the edges by their last vertex' turn, and the edges with their last vertex first."""
    m = ends.shape[0]
    late, later = np.zeros(m, np.int64), ends.copy()
    for row in range(m):
        for k in range(1, 5):
            at = k
            while (
                at > 0 and later[row, at] >= 0 and turn[later[row, at]] > turn[later[row, at - 1]]
            ):
                v = later[row, at]
                later[row, at] = later[row, at - 1]
                later[row, at - 1] = v
                at -= 1
        late[row] = turn[later[row, 0]] if later[row, 0] >= 0 else 0
    return np.argsort(late, kind="mergesort"), later


@inline
def matched_by_turn(ends, between, hold, capacity, turn, lack):
    """The node of every edge: those of rules A and B keep the freedom that they assume, if that works out."""
    order, later = _by_turn(ends, turn)
    if lack.any():
        left = capacity.copy()
        for v in range(hold.shape[0]):
            if hold[v] >= 0:
                left[hold[v]] = max(left[hold[v]] - lack[v], 0)
        owner = match(order, later, between, hold, left)
        if not (between.astype(np.bool_) & (owner < 0)).any():
            return owner
    return match(order, later, between, hold, capacity)


@inline
def _seeds(kind, ends, live, free, part, hold, best, turn):
    """The edge (parts,) whose ends begin every part that has no body to begin with: the first by turn."""
    n_parts = best.shape[0]
    seed, least = np.full(n_parts, -1, np.int64), np.full(n_parts, 1 << 30, np.int64)
    for row in range(ends.shape[0]):
        v, u = ends[row, 0], ends[row, 1]
        if not live[row] or v <= 0 or u <= 0 or kind[v] != POINT or not free[v]:
            continue
        p = part[v]
        if hold[p] == 2 or best[p] >= 0:
            continue
        line = kind[u] == TURN and ends[row, 3] < 0 and kind[ends[row, 2]] == SLIDE
        if hold[p] == 1 or (kind[u] == POINT and ends[row, 2] < 0) or line:
            late = max(turn[v], turn[u])
            if late < least[p]:
                seed[p], least[p] = row, late
    return seed


@inline
def bases(kind, ends, live, free, part, n_parts, hold, body_of, n_bodies, turn):
    """Chooses the initial cluster of every part of the core: ground, body, or an edge's two ends.

    The first by `turn`, then the largest body. Returns (held (bodies + n_parts + 1,), n_bodies, seed
    edge of the bodies made here). An edge's ends become a new body; a part held by directions only
    holds its first point.
    """
    held = np.zeros(n_bodies + n_parts + 1, np.uint8)
    made = np.full(n_bodies + n_parts + 1, -1, np.int64)
    weight = np.zeros(n_bodies + 1, np.int64)
    early = np.full(n_parts, 1 << 30, np.int64)
    for v in range(1, kind.shape[0]):
        if free[v]:
            early[part[v]] = min(early[part[v]], turn[v])
            if body_of[v] >= 0:
                weight[body_of[v]] += 1
    best = np.full(n_parts, -1, np.int64)
    for v in range(1, kind.shape[0]):
        b, p = body_of[v], part[v]
        if b >= 0 and hold[p] == 0 and turn[v] == early[p]:
            if best[p] < 0 or weight[b] > weight[best[p]]:
                best[p] = b
    for p in range(n_parts):
        if best[p] >= 0:
            held[best[p]] = 1
    seed = _seeds(kind, ends, live, free, part, hold, best, turn)
    for p in range(n_parts):
        row = seed[p]
        if row < 0 or body_of[ends[row, 0]] >= 0 or body_of[ends[row, 1]] >= 0:
            continue
        v, u = ends[row, 0], ends[row, 1]
        body_of[v] = n_bodies
        if hold[p] == 0:
            body_of[u] = n_bodies
            if kind[u] == TURN:
                body_of[ends[row, 2]] = n_bodies
            made[n_bodies] = row
        held[n_bodies] = 1
        n_bodies += 1
    return held[:n_bodies], n_bodies, made


@inline
def nodes_of_core(kind, free, body_of, held, n_bodies):
    """Contracted nodes: (hold (v,), capacity (nodes,)); bodies first, then single vertices."""
    n = kind.shape[0]
    hold = np.full(n, -1, np.int64)
    capacity = np.zeros(n_bodies + n, np.int64)
    for b in range(n_bodies):
        capacity[b] = 0 if held[b] else 3
    count = n_bodies
    for v in range(1, n):
        if not free[v]:
            continue
        b = body_of[v]
        if b >= 0:
            hold[v] = -1 if held[b] else b
        else:
            hold[v] = count
            capacity[count] = 2 if kind[v] == POINT else 1
            count += 1
    return hold, capacity[:count]


@inline
def edges_between(ends, live, hold, body_of):
    """The live edges that are not inside one body or inside what is held."""
    out = np.zeros(ends.shape[0], np.uint8)
    for row in range(ends.shape[0]):
        if not live[row]:
            continue
        common, first = True, -2
        for k in range(5):
            v = ends[row, k]
            if v < 0:
                continue
            h = hold[v]
            if h >= 0 and body_of[v] < 0:
                common = False
            if first == -2:
                first = h
            elif h != first:
                common = False
        out[row] = not common
    return out


@inline
def vertices_by_part(hold, node_part, body_of, n_clusters):
    """The vertices of every cluster, bodies' members together, as (starts, vertices)."""
    start = np.zeros(n_clusters + 1, np.int64)
    for v in range(hold.shape[0]):
        if hold[v] >= 0:
            start[node_part[hold[v]] + 1] += 1
    start = np.cumsum(start)
    out = np.empty(start[-1], np.int64)
    fill = start[:-1].copy()
    order = np.argsort(body_of, kind="mergesort")
    for v in order:
        if hold[v] >= 0:
            c = node_part[hold[v]]
            out[fill[c]] = v
            fill[c] += 1
    return start, out


@inline
def rows_by_part(owner, between, node_part, n_clusters):
    """The rows that place every cluster as (starts, rows)."""
    start = np.zeros(n_clusters + 1, np.int64)
    for row in range(owner.shape[0]):
        if between[row] and owner[row] >= 0:
            start[node_part[owner[row]] + 1] += 1
    start = np.cumsum(start)
    out = np.empty(start[-1], np.int64)
    fill = start[:-1].copy()
    for row in range(owner.shape[0]):
        if between[row] and owner[row] >= 0:
            c = node_part[owner[row]]
            out[fill[c]] = row
            fill[c] += 1
    return start, out

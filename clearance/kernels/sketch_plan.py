"""The construction plan: which vertices are placed from which equations, in which order.

Peeled vertices come last; before them the core: rigid bodies in their own frame, then the clusters
in the order of placing. A step is closed (one vertex, a line or a circle) or numeric (a block).
Not for: running it (`sketch_execute`).
"""

from typing import NamedTuple

import numpy as np

from clearance.jit import inlined, kernel
from clearance.kernels.sketch_blocks import bodies, match, ordered_parts
from clearance.kernels.sketch_graph import POINT, SLIDE, TURN, lists
from clearance.kernels.sketch_pebble import play
from clearance.kernels.sketch_peel import peel
from clearance.kernels.topology import find_root


class Plan(NamedTuple):
    """Steps (s,) in order: vertex and partner (closed) or block (numeric, else -1), edges (s, 3).

    `origin` says where a step comes from: 0 peeled, 1 inside a body, 2 a cluster of the core.
    Blocks list their vertices and rows. `body_of` (v,) is -1 outside bodies; `held` (b,) marks the
    initial clusters.
    """

    vertex: np.ndarray
    partner: np.ndarray
    edges: np.ndarray
    block: np.ndarray
    origin: np.ndarray
    block_vertex_start: np.ndarray
    block_vertex: np.ndarray
    block_row_start: np.ndarray
    block_row: np.ndarray
    body_of: np.ndarray
    held: np.ndarray
    dependent: np.ndarray
    circuit_start: np.ndarray
    circuit: np.ndarray


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


@inlined
def _bases(kind, ends, live, free, part, n_parts, hold, body_of, n_bodies):
    """Chooses the initial cluster of every part of the core: ground, largest body, or an edge's two
    ends.

    Returns (held (bodies + n_parts + 1,), n_bodies, seed edge of the bodies made here). An edge's
    ends become a new body; a part held by directions only holds its first point.
    """
    held = np.zeros(n_bodies + n_parts + 1, np.uint8)
    seed = np.full(n_bodies + n_parts + 1, -1, np.int64)
    weight = np.zeros(n_bodies + 1, np.int64)
    for v in range(1, kind.shape[0]):
        if body_of[v] >= 0:
            weight[body_of[v]] += 1
    best = np.full(n_parts, -1, np.int64)
    for v in range(1, kind.shape[0]):
        b = body_of[v]
        if b >= 0 and hold[part[v]] == 0:
            if best[part[v]] < 0 or weight[b] > weight[best[part[v]]]:
                best[part[v]] = b
    for p in range(n_parts):
        if best[p] >= 0:
            held[best[p]] = 1
    for row in range(ends.shape[0]):
        v, u = ends[row, 0], ends[row, 1]
        if not live[row] or v <= 0 or u <= 0 or kind[v] != POINT or not free[v]:
            continue
        p = part[v]
        if hold[p] == 2 or best[p] >= 0:
            continue
        if hold[p] == 1:
            body_of[v] = n_bodies
        elif kind[u] == POINT and ends[row, 2] < 0:
            body_of[v] = body_of[u] = n_bodies
            seed[n_bodies] = row
        elif kind[u] == TURN and ends[row, 3] < 0 and kind[ends[row, 2]] == SLIDE:
            body_of[v] = body_of[u] = body_of[ends[row, 2]] = n_bodies
            seed[n_bodies] = row
        else:
            continue
        best[p] = n_bodies
        held[n_bodies] = 1
        n_bodies += 1
    return held[:n_bodies], n_bodies, seed


@inlined
def _nodes(kind, free, body_of, held, n_bodies):
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


@inlined
def _between(ends, live, hold, body_of):
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


@kernel
def make_plan(kind, ends, absolute, theta_of):
    """The plan of a constraint graph; see `Plan`."""
    n, m = kind.shape[0], ends.shape[0]
    starts, rows = lists(ends, n)
    live = np.zeros(m, np.uint8)
    n_live = 0
    for row in range(m):
        live[row] = ends[row, 0] >= 0
        n_live += live[row]
    removed = np.zeros(n, np.uint8)
    v1, p1, e1 = peel(kind, ends, starts, rows, absolute, theta_of, live, removed)
    v2, p2, e2 = v1[:0], p1[:0], e1[:0]
    dependent, circuit_start, circuit = (
        np.empty(0, np.int64),
        np.zeros(1, np.int64),
        np.empty(0, np.int64),
    )
    if live.any():
        dependent, circuit_start, circuit = play(kind, ends, absolute, live)
        for row in dependent:
            live[row] = 0
        if dependent.shape[0] > 0:
            v2, p2, e2 = peel(kind, ends, starts, rows, absolute, theta_of, live, removed)
    body_of = np.full(n, -1, np.int64)
    held = np.zeros(0, np.uint8)
    size = v1.shape[0] + v2.shape[0] + 2 * n
    vertex, partner = np.full(size, -1, np.int64), np.full(size, -1, np.int64)
    edges, block = np.full((size, 3), -1, np.int64), np.full(size, -1, np.int64)
    origin = np.zeros(size, np.int64)
    bvs, bv = np.zeros(n + 1, np.int64), np.empty(n, np.int64)
    brs, br = np.zeros(n + 1, np.int64), np.empty(m, np.int64)
    steps, blocks = 0, 0
    if live.any():
        free = (removed == 0).astype(np.uint8)
        free[0] = 0
        body_of, log, log_start = bodies(kind, ends, starts, rows, live, theta_of, free)
        core_ends = ends.copy()
        for row in range(m):
            if not live[row]:
                core_ends[row, :] = -1
        part, n_parts, hold_kind = components(kind, core_ends, theta_of, absolute)
        held, n_bodies, seed = _bases(
            kind, ends, live, free, part, n_parts, hold_kind, body_of, log_start.shape[0] - 1
        )
        for at in range(log.shape[0]):
            vertex[steps], partner[steps] = log[at, 0], log[at, 1]
            edges[steps, 0], edges[steps, 1] = log[at, 2], log[at, 3]
            origin[steps] = 1
            steps += 1
        for b in range(log_start.shape[0] - 1, n_bodies):
            if seed[b] >= 0:
                vertex[steps], edges[steps, 0], origin[steps] = ends[seed[b], 0], seed[b], 1
                steps += 1
        hold, capacity = _nodes(kind, free, body_of, held, n_bodies)
        between = _between(ends, live, hold, body_of)
        owner = match(kind, ends, between, hold, capacity)
        present = np.zeros(capacity.shape[0], np.uint8)
        for v in range(n):
            if hold[v] >= 0:
                present[hold[v]] = 1
        node_part, n_clusters = ordered_parts(
            ends, between, hold, owner, capacity.shape[0], present
        )
        vs, vl = _by_part(hold, node_part, body_of, n_clusters)
        es, el = _rows_by_part(owner, between, node_part, n_clusters)
        for c in range(n_clusters):
            chosen, mine = vl[vs[c] : vs[c + 1]], el[es[c] : es[c + 1]]
            origin[steps] = 2
            count = chosen.shape[0]
            closed = count == 1 and body_of[chosen[0]] < 0
            if count == 2 and kind[chosen[0]] == TURN and kind[chosen[1]] == SLIDE:
                closed = theta_of[chosen[1]] == chosen[0] and body_of[chosen[0]] < 0
                partner[steps] = chosen[1] if closed else -1
            if closed:
                vertex[steps] = chosen[0]
                for k in range(mine.shape[0]):
                    edges[steps, k] = mine[k]
            else:
                block[steps] = blocks
                bvs[blocks + 1] = bvs[blocks] + count
                bv[bvs[blocks] : bvs[blocks + 1]] = chosen
                brs[blocks + 1] = brs[blocks] + mine.shape[0]
                br[brs[blocks] : brs[blocks + 1]] = mine
                blocks += 1
            steps += 1
    for at in range(v2.shape[0] - 1, -1, -1):
        vertex[steps], partner[steps], edges[steps] = v2[at], p2[at], e2[at]
        steps += 1
    for at in range(v1.shape[0] - 1, -1, -1):
        vertex[steps], partner[steps], edges[steps] = v1[at], p1[at], e1[at]
        steps += 1
    return Plan(
        vertex[:steps], partner[:steps], edges[:steps], block[:steps], origin[:steps], bvs[: blocks
        + 1], bv[: bvs[blocks]], brs[: blocks + 1], br[: brs[blocks]], body_of, held, dependent,
        circuit_start, circuit,
    )  # fmt: skip


@inlined
def _by_part(hold, node_part, body_of, n_clusters):
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


@inlined
def _rows_by_part(owner, between, node_part, n_clusters):
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

"""The construction plan: which vertices are placed from which equations, in which order.

Peeled vertices come last; before them the core: rigid bodies in their own frame, then the clusters
in the order of placing. A step is closed (one vertex, a line or a circle) or numeric (a block).
Not for: running it (`sketch.solve.execute`).
"""

from typing import NamedTuple

import numpy as np

from clearance.compile.jit import kernel
from clearance.kernels.sketch.graph.blocks import assumed_bodies, bodies, ordered_parts
from clearance.kernels.sketch.graph.core import (
    bases,
    components,
    edges_between,
    matched_by_turn,
    nodes_of_core,
    rows_by_part,
    turns_by_rule,
    vertices_by_part,
)
from clearance.kernels.sketch.graph.graph import SLIDE, TURN, lists
from clearance.kernels.sketch.graph.pebble import play
from clearance.kernels.sketch.graph.peel import peel


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
def peeled_plan(kind, ends, absolute, theta_of):
    """(the plan, True) of a graph that can be peeled as a whole, else (a part of it, False)."""
    n = kind.shape[0]
    starts, rows = lists(ends, n)
    live, removed = (ends[:, 0] >= 0).astype(np.uint8), np.zeros(n, np.uint8)
    vertex, partner, edges = peel(kind, ends, starts, rows, absolute, theta_of, live, removed)
    size = vertex.shape[0]
    none, zero = np.empty(0, np.int64), np.zeros(1, np.int64)
    plan = Plan(
        vertex[::-1].copy(), partner[::-1].copy(), edges[::-1].copy(), np.full(size, -1, np.int64),
        np.zeros(size, np.int64), zero, none, zero, none, np.full(n, -1, np.int64),
        np.zeros(0, np.uint8), none, zero, none,
    )  # fmt: skip
    return plan, not live.any()


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
        n_bodies = log_start.shape[0] - 1
        turn, lack, home = turns_by_rule(
            kind, ends, live, free, part, n_parts, hold_kind, body_of, n_bodies, absolute
        )
        more, more_start = assumed_bodies(
            kind, ends, starts, rows, live, body_of, n_bodies, turn, lack, home
        )
        log = np.concatenate((log, more))
        log_start = np.concatenate((log_start, log_start[-1] + more_start[1:]))
        n_bodies = log_start.shape[0] - 1
        held, n_bodies, seed = bases(
            kind, ends, live, free, part, n_parts, hold_kind, body_of, n_bodies, turn
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
        hold, capacity = nodes_of_core(kind, free, body_of, held, n_bodies)
        between = edges_between(ends, live, hold, body_of)
        owner = matched_by_turn(ends, between, hold, capacity, turn, lack)
        present = np.zeros(capacity.shape[0], np.uint8)
        for v in range(n):
            if hold[v] >= 0:
                present[hold[v]] = 1
        node_part, n_clusters = ordered_parts(
            ends, between, hold, owner, capacity.shape[0], present
        )
        vs, vl = vertices_by_part(hold, node_part, body_of, n_clusters)
        es, el = rows_by_part(owner, between, node_part, n_clusters)
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

"""The construction plan: which vertices are placed from which equations, in which order.

Peeled vertices come last; before them the core: rigid bodies in their own frame, then the clusters
in the order of placing. A step is closed (one vertex, a line or a circle) or numeric (a block).
Not for: running it (`sketch.solve.execute`).
"""

from typing import NamedTuple

import numpy as np

from clearance.compile.jit import inline, kernel
from clearance.kernels.sketch.graph.bodies import bodies, with_assumed
from clearance.kernels.sketch.graph.core import (
    clusters_of,
    components,
    initial_clusters,
    turns_by_rule,
)
from clearance.kernels.sketch.graph.graph import SLIDE, TURN, graph_of
from clearance.kernels.sketch.graph.pebble import no_circuits, play
from clearance.kernels.sketch.graph.peel import ClosedSteps, peel

PEELED, IN_BODY, IN_CORE = 0, 1, 2
"""Where a step comes from: peeled off, inside a body, a cluster of the core."""


class Plan(NamedTuple):
    """Steps (s,) in order: vertex and partner (closed) or block (numeric, else -1), edges (s, 3).

    `origin` says where a step comes from: PEELED, IN_BODY or IN_CORE.
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


class PlanDraft(NamedTuple):
    """A plan while it is written: the room for its steps and blocks, as of `Plan`, and how much is filled.

    `filled` (2,) holds the number of steps and of blocks.
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
    filled: np.ndarray


class Core(NamedTuple):
    """What the core's phases leave behind: bodies by vertex (v,), and which of them are held (b,)."""

    body_of: np.ndarray
    held: np.ndarray


@inline
def _new_draft(size, n, m):
    """A draft with room for `size` steps and for the blocks of n vertices and m edges."""
    return PlanDraft(
        np.full(size, -1, np.int64),
        np.full(size, -1, np.int64),
        np.full((size, 3), -1, np.int64),
        np.full(size, -1, np.int64),
        np.zeros(size, np.int64),
        np.zeros(n + 1, np.int64),
        np.empty(n, np.int64),
        np.zeros(n + 1, np.int64),
        np.empty(m, np.int64),
        np.zeros(2, np.int64),
    )


@inline(force=True)
def _next_step(draft, origin):
    """The number of a new step of this origin."""
    k = draft.filled[0]
    draft.origin[k] = origin
    draft.filled[0] += 1
    return k


@inline
def _write_bodies(draft, graph, bodies, initial):
    """Writes the steps of the bodies, and the first step of those that only begin with an edge."""
    for at in range(bodies.steps.shape[0]):
        k = _next_step(draft, IN_BODY)
        draft.vertex[k], draft.partner[k] = bodies.steps[at, 0], bodies.steps[at, 1]
        draft.edges[k, 0], draft.edges[k, 1] = bodies.steps[at, 2], bodies.steps[at, 3]
    for b in range(bodies.start.shape[0] - 1, initial.held.shape[0]):
        row = initial.seed[b]
        if row >= 0:
            k = _next_step(draft, IN_BODY)
            draft.vertex[k], draft.edges[k, 0] = graph.ends[row, 0], row


@inline
def _write_block(draft, k, vertices, rows):
    """Makes step k numeric: a block of these vertices and rows."""
    b = draft.filled[1]
    draft.block[k] = b
    at, end = draft.block_vertex_start[b], draft.block_vertex_start[b] + vertices.shape[0]
    draft.block_vertex_start[b + 1] = end
    draft.block_vertex[at:end] = vertices
    at, end = draft.block_row_start[b], draft.block_row_start[b] + rows.shape[0]
    draft.block_row_start[b + 1] = end
    draft.block_row[at:end] = rows
    draft.filled[1] += 1


@inline
def _write_clusters(draft, graph, clusters, body_of):
    """Writes the core's clusters: closed steps for one vertex or one line, blocks for all others."""
    for c in range(clusters.count):
        vertices = clusters.vertex[clusters.vertex_start[c] : clusters.vertex_start[c + 1]]
        rows = clusters.row[clusters.row_start[c] : clusters.row_start[c + 1]]
        k, v = _next_step(draft, IN_CORE), vertices[0]
        closed = vertices.shape[0] == 1 and body_of[v] < 0
        if vertices.shape[0] == 2 and graph.kind[v] == TURN and graph.kind[vertices[1]] == SLIDE:
            closed = graph.theta_of[vertices[1]] == v and body_of[v] < 0
            draft.partner[k] = vertices[1] if closed else -1
        if closed:
            draft.vertex[k] = v
            draft.edges[k, : rows.shape[0]] = rows
        else:
            _write_block(draft, k, vertices, rows)


@inline
def _write_reversed(draft, steps):
    """Writes peeled steps, the last taken off first."""
    for at in range(steps.vertex.shape[0] - 1, -1, -1):
        k = _next_step(draft, PEELED)
        draft.vertex[k], draft.partner[k] = steps.vertex[at], steps.partner[at]
        draft.edges[k] = steps.edges[at]


@inline
def _plan_core(draft, graph, live, removed):
    """Plans what peeling leaves: bodies, the order of the rules, what is held first, clusters."""
    free = (removed == 0).astype(np.uint8)
    free[0] = 0
    grown = bodies(graph, live, free)
    ends = graph.ends.copy()
    for row in range(ends.shape[0]):
        if not live[row]:
            ends[row, :] = -1
    parts = components(graph.kind, ends, graph.theta_of, graph.absolute)
    order = turns_by_rule(graph, live, free, parts, grown)
    every = with_assumed(graph, live, grown, order)
    initial = initial_clusters(graph, live, free, parts, every, order.turn)
    _write_bodies(draft, graph, every, initial)
    clusters = clusters_of(graph, live, free, every.body_of, initial.held, order)
    _write_clusters(draft, graph, clusters, every.body_of)
    return Core(every.body_of, initial.held)


@inline
def _finished(draft, core, circuits):
    """The plan as far as the draft is filled."""
    steps, blocks = draft.filled[0], draft.filled[1]
    return Plan(
        draft.vertex[:steps], draft.partner[:steps], draft.edges[:steps], draft.block[:steps],
        draft.origin[:steps], draft.block_vertex_start[: blocks + 1],
        draft.block_vertex[: draft.block_vertex_start[blocks]], draft.block_row_start[: blocks + 1],
        draft.block_row[: draft.block_row_start[blocks]], core.body_of, core.held,
        circuits.dependent, circuits.start, circuits.rows,
    )  # fmt: skip


@kernel
def peeled_plan(kind, ends, absolute, theta_of):
    """(the plan, True) of a graph that can be peeled as a whole, else (a part of it, False)."""
    n = kind.shape[0]
    graph = graph_of(kind, ends, absolute, theta_of)
    live, removed = (ends[:, 0] >= 0).astype(np.uint8), np.zeros(n, np.uint8)
    steps = peel(graph, live, removed)
    size = steps.vertex.shape[0]
    none, zero = np.empty(0, np.int64), np.zeros(1, np.int64)
    plan = Plan(
        steps.vertex[::-1].copy(), steps.partner[::-1].copy(), steps.edges[::-1].copy(),
        np.full(size, -1, np.int64), np.zeros(size, np.int64), zero, none, zero, none,
        np.full(n, -1, np.int64), np.zeros(0, np.uint8), none, zero, none,
    )  # fmt: skip
    return plan, not live.any()


@kernel
def make_plan(kind, ends, absolute, theta_of):
    """The plan of a constraint graph; see `Plan`.

    Dependent edges are left out; where there are some, what hung on them is peeled as well.
    """
    n, m = kind.shape[0], ends.shape[0]
    graph = graph_of(kind, ends, absolute, theta_of)
    live, removed = (ends[:, 0] >= 0).astype(np.uint8), np.zeros(n, np.uint8)
    last = peel(graph, live, removed)
    before = ClosedSteps(last.vertex[:0], last.partner[:0], last.edges[:0])
    circuits = no_circuits()
    if live.any():
        circuits = play(kind, ends, absolute, live)
        for row in circuits.dependent:
            live[row] = 0
        if circuits.dependent.shape[0] > 0:
            before = peel(graph, live, removed)
    draft = _new_draft(last.vertex.shape[0] + before.vertex.shape[0] + 2 * n, n, m)
    core = Core(np.full(n, -1, np.int64), np.zeros(0, np.uint8))
    if live.any():
        core = _plan_core(draft, graph, live, removed)
    _write_reversed(draft, before)
    _write_reversed(draft, last)
    return _finished(draft, core, circuits)

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
from clearance.kernels.sketch.graph.plan_steps import IN_BODY, IN_CORE, PEELED, PlanSteps


class ConstructionPlan(NamedTuple):
    """A construction plan: its steps, and what is known of the graph.

    Attributes:
        steps: of `PlanSteps`, in the order of placing.
        body_of: (v,) the body of every vertex, -1 outside bodies.
        held: (b,) marks the initial clusters.
        dependent: (k,) the edges that others imply.
        circuit_start, circuit: the edges of the circuit of each, (k + 1,) starts.
    """

    steps: PlanSteps
    body_of: np.ndarray
    held: np.ndarray
    dependent: np.ndarray
    circuit_start: np.ndarray
    circuit: np.ndarray


class PlanDraft(NamedTuple):
    """A plan while it is written: room for its steps and blocks, and (2,) how many of each are there."""

    steps: PlanSteps
    filled: np.ndarray


class Core(NamedTuple):
    """What the core's phases leave behind: bodies by vertex (v,), and which of them are held (b,)."""

    body_of: np.ndarray
    held: np.ndarray


@inline
def _new_draft(size, n, m):
    """A draft with room for `size` steps and for the blocks of n vertices and m edges."""
    steps = PlanSteps(
        np.full(size, -1, np.int64),
        np.full(size, -1, np.int64),
        np.full((size, 3), -1, np.int64),
        np.full(size, -1, np.int64),
        np.zeros(size, np.int64),
        np.zeros(n + 1, np.int64),
        np.empty(n, np.int64),
        np.zeros(n + 1, np.int64),
        np.empty(m, np.int64),
    )
    return PlanDraft(steps, np.zeros(2, np.int64))


@inline(force=True)
def _next_step(draft, origin):
    """The number of a new step of this origin."""
    k = draft.filled[0]
    draft.steps.origin[k] = origin
    draft.filled[0] += 1
    return k


@inline
def _write_bodies(draft, graph, bodies, initial):
    """Writes the steps of the bodies, and the first step of those that only begin with an edge."""
    steps = draft.steps
    for at in range(bodies.steps.shape[0]):
        k = _next_step(draft, IN_BODY)
        steps.vertex[k], steps.partner[k] = bodies.steps[at, 0], bodies.steps[at, 1]
        steps.edges[k, 0], steps.edges[k, 1] = bodies.steps[at, 2], bodies.steps[at, 3]
    for b in range(bodies.start.shape[0] - 1, initial.held.shape[0]):
        row = initial.seed[b]
        if row >= 0:
            k = _next_step(draft, IN_BODY)
            steps.vertex[k], steps.edges[k, 0] = graph.ends[row, 0], row


@inline
def _write_block(draft, k, vertices, rows):
    """Makes step k numeric: a block of these vertices and rows."""
    steps, b = draft.steps, draft.filled[1]
    steps.block[k] = b
    at, end = steps.block_vertex_start[b], steps.block_vertex_start[b] + vertices.shape[0]
    steps.block_vertex_start[b + 1] = end
    steps.block_vertex[at:end] = vertices
    at, end = steps.block_row_start[b], steps.block_row_start[b] + rows.shape[0]
    steps.block_row_start[b + 1] = end
    steps.block_row[at:end] = rows
    draft.filled[1] += 1


@inline
def _write_clusters(draft, graph, clusters, body_of):
    """Writes the core's clusters: closed steps for one vertex or one line, blocks for all others."""
    steps = draft.steps
    for c in range(clusters.count):
        vertices = clusters.vertex[clusters.vertex_start[c] : clusters.vertex_start[c + 1]]
        rows = clusters.row[clusters.row_start[c] : clusters.row_start[c + 1]]
        k, v = _next_step(draft, IN_CORE), vertices[0]
        closed = vertices.shape[0] == 1 and body_of[v] < 0
        if vertices.shape[0] == 2 and graph.kind[v] == TURN and graph.kind[vertices[1]] == SLIDE:
            closed = graph.theta_of[vertices[1]] == v and body_of[v] < 0
            steps.partner[k] = vertices[1] if closed else -1
        if closed:
            steps.vertex[k] = v
            steps.edges[k, : rows.shape[0]] = rows
        else:
            _write_block(draft, k, vertices, rows)


@inline
def _write_reversed(draft, peeled):
    """Writes peeled steps, the last taken off first."""
    steps = draft.steps
    for at in range(peeled.vertex.shape[0] - 1, -1, -1):
        k = _next_step(draft, PEELED)
        steps.vertex[k], steps.partner[k] = peeled.vertex[at], peeled.partner[at]
        steps.edges[k] = peeled.edges[at]


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
    room, n_steps, n_blocks = draft.steps, draft.filled[0], draft.filled[1]
    steps = PlanSteps(
        room.vertex[:n_steps], room.partner[:n_steps], room.edges[:n_steps],
        room.block[:n_steps], room.origin[:n_steps], room.block_vertex_start[: n_blocks + 1],
        room.block_vertex[: room.block_vertex_start[n_blocks]], room.block_row_start[: n_blocks + 1],
        room.block_row[: room.block_row_start[n_blocks]],
    )  # fmt: skip
    return ConstructionPlan(
        steps, core.body_of, core.held, circuits.dependent, circuits.start, circuits.rows
    )


@kernel
def peeled_plan(kind, ends, absolute, theta_of):
    """(the plan, True) of a graph that can be peeled as a whole, else (a part of it, False)."""
    n = kind.shape[0]
    graph = graph_of(kind, ends, absolute, theta_of)
    live, removed = (ends[:, 0] >= 0).astype(np.uint8), np.zeros(n, np.uint8)
    peeled = peel(graph, live, removed)
    size = peeled.vertex.shape[0]
    none, zero = np.empty(0, np.int64), np.zeros(1, np.int64)
    steps = PlanSteps(
        peeled.vertex[::-1].copy(), peeled.partner[::-1].copy(), peeled.edges[::-1].copy(),
        np.full(size, -1, np.int64), np.zeros(size, np.int64), zero, none, zero, none,
    )  # fmt: skip
    plan = ConstructionPlan(
        steps, np.full(n, -1, np.int64), np.zeros(0, np.uint8), none, zero, none
    )
    return plan, not live.any()


@kernel
def make_plan(kind, ends, absolute, theta_of):
    """The plan of a constraint graph; see `ConstructionPlan`.

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

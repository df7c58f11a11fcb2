"""Peeling: a vertex with no more edges than degrees of freedom is placed last, given all the
others.

Taking such vertices off one after another until none is left orders every ruler-and-compass sketch
in linear time, without a search for clusters; the reverse order is a plan. What remains (the core)
has only vertices with more edges than freedom. A vertex taken off with fewer edges leaves freedom:
an assumption.
Source: Owen 1991 and the inverse of the first Henneberg step; joint vertices (a line's direction
and offset, a circle's centre and radius) are ours.
"""

from typing import NamedTuple

import numpy as np

from clearance.compile.jit import inline
from clearance.kernels.sketch.graph.graph import GROUND, POINT, SIZE, SLIDE, TURN


class ClosedSteps(NamedTuple):
    """Steps (s,) that place one vertex, with its partner or -1, from edges (s, 3), -1 pads."""

    vertex: np.ndarray
    partner: np.ndarray
    edges: np.ndarray


class Peeling(NamedTuple):
    """What is left of a graph while it is peeled, and the vertices that wait to be looked at.

    Attributes:
        live: (m,) marks the edges that are left.
        removed: (v,) marks the vertices that are taken off.
        degree: (v,) the live edges of every vertex.
        n_slides: (v,) the offsets left of every class of directions.
        waiting: (v,) marks the vertices in the queue.
        queue: (v + 1,) a ring.
        span: (2,) the queue's head, and how many vertices it holds.
    """

    live: np.ndarray
    removed: np.ndarray
    degree: np.ndarray
    n_slides: np.ndarray
    waiting: np.ndarray
    queue: np.ndarray
    span: np.ndarray


@inline(force=True)
def _freedom(kind):
    if kind == GROUND:
        return 3
    return 2 if kind == POINT else 1


@inline(force=True)
def _collect(graph, live, v, partner, found):
    """Fills `found` with the live edges of v and partner, each once; the count, or 4 when there are
    more."""
    count = 0
    for which in range(2):
        u = v if which == 0 else partner
        if u < 0:
            continue
        for at in range(graph.start[u], graph.start[u + 1]):
            row = graph.rows[at]
            if not live[row]:
                continue
            fresh = True
            for k in range(count):
                if found[k] == row:
                    fresh = False
            if fresh:
                if count == 3:
                    return 4
                found[count] = row
                count += 1
    return count


@inline(force=True)
def _independent(graph, v, partner, found, count):
    """Whether the count of freedoms allows these edges at v (3 must remain for the part as a
    whole)."""
    kind, ends = graph.kind, graph.ends
    total = _freedom(kind[v]) + (_freedom(kind[partner]) if partner >= 0 else 0)
    for a in range(count):
        for k in range(5):
            u = ends[found[a], k]
            if u < 0 or u == v or u == partner:
                continue
            fresh = True
            for b in range(a):
                for j in range(5):
                    if ends[found[b], j] == u:
                        fresh = False
            if fresh:
                on_ground = u == 0 and graph.absolute[found[a]] == 1
                total += 3 if on_ground else _freedom(kind[u]) if u > 0 else 1
    return total - count >= 3


@inline(force=True)
def _offset_of(graph, peeling, v):
    """The offset that a class of directions is tied to by an edge; -1 for none."""
    for at in range(graph.start[v], graph.start[v + 1]):
        row = graph.rows[at]
        if peeling.live[row]:
            for k in range(5):
                u = graph.ends[row, k]
                if u > 0 and graph.kind[u] == SLIDE and graph.theta_of[u] == v:
                    if not peeling.removed[u]:
                        return u
    return -1


@inline(force=True)
def _only_with(graph, live, u, v):
    """Whether every live edge of u has v as well."""
    for at in range(graph.start[u], graph.start[u + 1]):
        if live[graph.rows[at]]:
            has = False
            for j in range(5):
                has = has or graph.ends[graph.rows[at], j] == v
            if not has:
                return False
    return True


@inline(force=True)
def _joint_partner(graph, peeling, v):
    """The vertex that v may only be placed with: a direction's one offset, a centre's own radius;
    or -1."""
    kind, live = graph.kind, peeling.live
    if kind[v] == TURN and peeling.n_slides[v] == 1:
        u = _offset_of(graph, peeling, v)
        if u >= 0:
            return u
    if kind[v] == POINT and peeling.degree[v] == 3:
        for at in range(graph.start[v], graph.start[v + 1]):
            row = graph.rows[at]
            if not live[row]:
                continue
            for k in range(5):
                u = graph.ends[row, k]
                if u > 0 and kind[u] == SIZE and peeling.degree[u] <= 3:
                    if _only_with(graph, live, u, v):
                        return u
    return -1


@inline
def _begin(graph, live, removed):
    """A peeling in which every vertex that is left waits."""
    kind = graph.kind
    n = kind.shape[0]
    degree, n_slides = np.zeros(n, np.int64), np.zeros(n, np.int64)
    for v in range(n):
        for at in range(graph.start[v], graph.start[v + 1]):
            degree[v] += live[graph.rows[at]]
        if kind[v] == SLIDE and not removed[v]:
            n_slides[graph.theta_of[v]] += 1
    waiting, queue, span = np.zeros(n, np.uint8), np.empty(n + 1, np.int64), np.zeros(2, np.int64)
    peeling = Peeling(live, removed, degree, n_slides, waiting, queue, span)
    for v in range(1, n):
        if not removed[v]:
            _wait(peeling, v)
    return peeling


@inline(force=True)
def _wait(peeling, v):
    """Puts a vertex at the end of the queue."""
    queue, span = peeling.queue, peeling.span
    queue[(span[0] + span[1]) % queue.shape[0]] = v
    span[1] += 1
    peeling.waiting[v] = 1


@inline(force=True)
def _next(peeling):
    """Takes the vertex at the head of the queue."""
    queue, span = peeling.queue, peeling.span
    v = queue[span[0]]
    span[0] = (span[0] + 1) % queue.shape[0]
    span[1] -= 1
    peeling.waiting[v] = 0
    return v


@inline(force=True)
def _edges_to_peel(graph, peeling, v, found):
    """The partner with which v can be taken off, and how many edges (in `found`) place them.

    The count is -1 where v cannot be taken off.
    """
    kind, partner = graph.kind, -1
    if peeling.removed[v] or peeling.degree[v] > 3:
        return partner, -1
    allowed = _freedom(kind[v])
    if peeling.degree[v] > allowed or kind[v] == TURN:
        partner = _joint_partner(graph, peeling, v)
        if partner >= 0:
            allowed += 1
    if peeling.degree[v] > allowed:
        return partner, -1
    count = _collect(graph, peeling.live, v, partner, found)
    if count > allowed or not _independent(graph, v, partner, found, count):
        return partner, -1
    return partner, count


@inline(force=True)
def _take_off(graph, peeling, v, partner, edges):
    """Removes a vertex with its partner and edges; what they were tied to waits again."""
    peeling.removed[v] = 1
    if graph.kind[v] == SLIDE:
        peeling.n_slides[graph.theta_of[v]] -= 1
    if partner >= 0:
        peeling.removed[partner] = 1
    for row in edges:
        peeling.live[row] = 0
        for k in range(5):
            if graph.ends[row, k] >= 0:
                peeling.degree[graph.ends[row, k]] -= 1
    for a in range(edges.shape[0] + 1):
        for k in range(5):
            u = graph.theta_of[v] if a == edges.shape[0] else graph.ends[edges[a], k]
            if u > 0 and not peeling.removed[u] and not peeling.waiting[u]:
                _wait(peeling, u)


@inline(reference_counts=True)
def peel(graph, live, removed):
    """Takes off what can be, in the order of taking off; clears `live` and sets `removed` in place."""
    n = graph.kind.shape[0]
    peeling = _begin(graph, live, removed)
    vertex, partner = np.empty(n, np.int64), np.full(n, -1, np.int64)
    edges = np.full((n, 3), -1, np.int64)
    found = np.empty(3, np.int64)
    steps = 0
    while peeling.span[1] > 0:
        v = _next(peeling)
        joint, count = _edges_to_peel(graph, peeling, v, found)
        if count < 0:
            continue
        vertex[steps], partner[steps] = v, joint
        edges[steps, :count] = found[:count]
        _take_off(graph, peeling, v, joint, found[:count])
        steps += 1
    return ClosedSteps(vertex[:steps], partner[:steps], edges[:steps])

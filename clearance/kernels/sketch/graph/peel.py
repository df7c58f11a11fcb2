"""Peeling: a vertex with no more edges than degrees of freedom is placed last, given all the
others.

Taking such vertices off one after another until none is left orders every ruler-and-compass sketch
in linear time, without a search for clusters; the reverse order is a plan. What remains (the core)
has only vertices with more edges than freedom. A vertex taken off with fewer edges leaves freedom:
an assumption.
Source: Owen 1991 and the inverse of the first Henneberg step; joint vertices (a line's direction
and offset, a circle's centre and radius) are ours.
"""

import numpy as np

from clearance.compile.jit import inline, kernel
from clearance.kernels.sketch.graph.graph import GROUND, POINT, SIZE, SLIDE, TURN


@inline
def _freedom(kind):
    if kind == GROUND:
        return 3
    return 2 if kind == POINT else 1


@inline
def _collect(v, partner, starts, rows, live, found):
    """Fills `found` with the live edges of v and partner, each once; the count, or 4 when there are
    more."""
    count = 0
    for which in range(2):
        u = v if which == 0 else partner
        if u < 0:
            continue
        for at in range(starts[u], starts[u + 1]):
            row = rows[at]
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


@inline
def _independent(v, partner, found, count, kind, ends, absolute):
    """Whether the count of freedoms allows these edges at v (3 must remain for the part as a
    whole)."""
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
                total += (
                    3 if u == 0 and absolute[found[a]] == 1 else _freedom(kind[u]) if u > 0 else 1
                )
    return total - count >= 3


@inline
def _joint_partner(v, kind, ends, starts, rows, live, slide_count, theta_of, degree, removed):
    """The vertex that v may only be placed with: a direction's one offset, a centre's own radius;
    or -1."""
    if kind[v] == TURN and slide_count[v] == 1:
        for at in range(starts[v], starts[v + 1]):
            row = rows[at]
            if live[row]:
                for k in range(5):
                    u = ends[row, k]
                    if u > 0 and kind[u] == SLIDE and theta_of[u] == v and not removed[u]:
                        return u
    if kind[v] == POINT and degree[v] == 3:
        for at in range(starts[v], starts[v + 1]):
            row = rows[at]
            if not live[row]:
                continue
            for k in range(5):
                u = ends[row, k]
                if u > 0 and kind[u] == SIZE and degree[u] <= 3:
                    own = True
                    for other in range(starts[u], starts[u + 1]):
                        if live[rows[other]]:
                            has = False
                            for j in range(5):
                                has = has or ends[rows[other], j] == v
                            own = own and has
                    if own:
                        return u
    return -1


@kernel
def peel(kind, ends, starts, rows, absolute, theta_of, live, removed):
    """Takes off what can be; clears `live` and sets `removed` in place.

    Returns the steps in the order of taking off: (vertex (s,), partner (s,), edges (s, 3) with -1
    padding).
    """
    n = kind.shape[0]
    degree = np.zeros(n, np.int64)
    slide_count = np.zeros(n, np.int64)
    for v in range(n):
        for at in range(starts[v], starts[v + 1]):
            degree[v] += live[rows[at]]
        if kind[v] == SLIDE and not removed[v]:
            slide_count[theta_of[v]] += 1
    queue = np.empty(n + 1, np.int64)
    waiting = np.zeros(n, np.uint8)
    head, tail, held = 0, 0, 0
    for v in range(1, n):
        if not removed[v]:
            queue[tail] = v
            tail += 1
            held += 1
            waiting[v] = 1
    step_vertex = np.empty(n, np.int64)
    step_partner = np.full(n, -1, np.int64)
    step_edges = np.full((n, 3), -1, np.int64)
    found = np.empty(3, np.int64)
    steps = 0
    while held > 0:
        v = queue[head]
        head = (head + 1) % (n + 1)
        held -= 1
        waiting[v] = 0
        if removed[v] or degree[v] > 3:
            continue
        partner = -1
        allowed = _freedom(kind[v])
        if degree[v] > allowed or kind[v] == TURN:
            partner = _joint_partner(
                v, kind, ends, starts, rows, live, slide_count, theta_of, degree, removed
            )
            if partner >= 0:
                allowed += 1
        if degree[v] > allowed:
            continue
        count = _collect(v, partner, starts, rows, live, found)
        if count > allowed or not _independent(v, partner, found, count, kind, ends, absolute):
            continue
        step_vertex[steps], step_partner[steps] = v, partner
        removed[v] = 1
        if kind[v] == SLIDE:
            slide_count[theta_of[v]] -= 1
        if partner >= 0:
            removed[partner] = 1
        for a in range(count):
            step_edges[steps, a] = found[a]
            live[found[a]] = 0
            for k in range(5):
                if ends[found[a], k] >= 0:
                    degree[ends[found[a], k]] -= 1
        for a in range(count + 1):
            for k in range(5):
                u = theta_of[v] if a == count else ends[found[a], k]
                if u > 0 and not removed[u] and not waiting[u]:
                    waiting[u] = 1
                    queue[tail] = u
                    tail = (tail + 1) % (n + 1)
                    held += 1
        steps += 1
    return step_vertex[:steps], step_partner[:steps], step_edges[:steps]

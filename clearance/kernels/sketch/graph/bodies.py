"""Rigid bodies: grown along rigid chains, or made of what is assumed to be rigid.

A body starts from two entities with three degrees of freedom and takes in every vertex that hangs
on it by as many edges as it has freedom (Fig. 8 a and b of the paper). Not for: the clusters of bodies and
vertices that are solved at once (`sketch.graph.matching`).
Source: Kwon, Lee, Lee 2001, section 3.5.
"""

from typing import NamedTuple

import numpy as np

from clearance.compile.jit import inline, kernel
from clearance.kernels.sketch.graph.graph import POINT, SLIDE, TURN


class Bodies(NamedTuple):
    """Rigid bodies and the steps that build them.

    Attributes:
        body_of: (v,) the body of every vertex, -1 outside bodies.
        steps: (s, 4) vertex, partner and two edges, -1 pads.
        start: (b + 1,) where the steps of every body begin.
    """

    body_of: np.ndarray
    steps: np.ndarray
    start: np.ndarray


class BodyGrowth(NamedTuple):
    """Bodies while they grow: the edges (m,) and vertices (v,) that may be taken in, and what was taken in.

    `hooks` (2,) is room for the edges by which a vertex hangs on a body.
    """

    live: np.ndarray
    free: np.ndarray
    body_of: np.ndarray
    steps: np.ndarray
    hooks: np.ndarray


@inline(force=True)
def _hangs(row, v, line, ends, body_of, body):
    """Whether all ends of the edge other than v (and `line`, its direction) belong to the body."""
    for k in range(5):
        u = ends[row, k]
        if u >= 0 and u != v and u != line and body_of[u] != body:
            return False
    return True


@inline(force=True)
def _n_hooks(graph, growth, v, line, body):
    """Up to two edges that tie v to the body, in `hooks`; how many."""
    count = 0
    for at in range(graph.start[v], graph.start[v + 1]):
        row = graph.rows[at]
        if count < 2 and growth.live[row]:
            if _hangs(row, v, line, graph.ends, growth.body_of, body):
                growth.hooks[count] = row
                count += 1
    return count


@inline(force=True)
def _line_with(graph, growth, v, body):
    """The direction that an offset brings into a body with it: -1 for none, -2 where it must not."""
    if graph.kind[v] != SLIDE or growth.body_of[graph.theta_of[v]] == body:
        return -1
    line = graph.theta_of[v]
    if line == 0 or growth.body_of[line] >= 0 or not growth.free[line]:
        return -2
    return line


@inline
def _take_in(graph, growth, v, body, n_steps):
    """Takes v into the body if it hangs on it by as many edges as it has freedom.

    Returns (the steps' new end, the direction that came with v or -1); the same end if it does not hang.
    """
    line = _line_with(graph, growth, v, body)
    if line == -2:
        return n_steps, -1
    need = 2 if graph.kind[v] == POINT or line >= 0 else 1
    if _n_hooks(graph, growth, v, line, body) < need:
        return n_steps, -1
    growth.body_of[v] = body
    step = growth.steps[n_steps]
    step[0], step[1] = v, -1
    if line >= 0:
        growth.body_of[line] = body
        step[0], step[1] = line, v
    step[2], step[3] = growth.hooks[0], growth.hooks[1] if need == 2 else -1
    return n_steps + 1, line


@inline
def _grow(graph, growth, seeds, body, n_steps):
    """Grows a body from its seeds; appends its steps from `n_steps` on; their new end."""
    queue = np.empty(64, np.int64)
    tail = seeds.shape[0]
    queue[:tail] = seeds
    head = 0
    while head < tail:
        u = queue[head]
        head += 1
        for at in range(graph.start[u], graph.start[u + 1]):
            row = graph.rows[at]
            if not growth.live[row]:
                continue
            for k in range(5):
                v = graph.ends[row, k]
                if v <= 0 or not growth.free[v] or growth.body_of[v] >= 0 or graph.kind[v] == TURN:
                    continue
                before = n_steps
                n_steps, line = _take_in(graph, growth, v, body, n_steps)
                if n_steps == before:
                    continue
                if tail + 2 > queue.shape[0]:
                    larger = np.empty(2 * queue.shape[0], np.int64)
                    larger[:tail] = queue[:tail]
                    queue = larger
                queue[tail] = v
                tail += 1
                if line >= 0:
                    queue[tail] = line
                    tail += 1
    return n_steps


@inline(force=True)
def _seeds_of(graph, growth, row, seeds):
    """The ends of an edge that can begin a body, in `seeds`: a point, what it is tied to, a direction.

    Returns how many: 3 for a point on a line (offset and direction), 2 for two points, 0 where none can.
    """
    a, b, c, usable = -1, -1, -1, graph.ends[row, 3] < 0
    kind = graph.kind
    for k in range(3):
        v = graph.ends[row, k]
        if v >= 0:
            usable = usable and v > 0 and growth.free[v] and growth.body_of[v] < 0
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
        return 0
    seeds[0], seeds[1], seeds[2] = a, b, c
    return 3 if c >= 0 else 2


@kernel
def bodies(graph, live, free):
    """Rigid bodies of at least three entities among the `free` vertices, each entity in at most one.

    The first steps of a body are its initial cluster: they have fewer edges than freedoms.
    """
    n = graph.kind.shape[0]
    body_of = np.full(n, -1, np.int64)
    steps = np.full((n + 4, 4), -1, np.int64)
    start = np.zeros(n + 1, np.int64)
    growth = BodyGrowth(live, free, body_of, steps, np.empty(2, np.int64))
    seeds = np.empty(3, np.int64)
    count, n_steps = 0, 0
    for row in range(graph.ends.shape[0]):
        if not live[row] or graph.ends[row, 1] <= 0:
            continue
        n_seeds = _seeds_of(graph, growth, row, seeds)
        if n_seeds == 0:
            continue
        for v in seeds[:n_seeds]:
            body_of[v] = count
        steps[n_steps, :] = -1
        steps[n_steps + 1, :] = -1
        steps[n_steps, 0] = seeds[n_seeds - 1]
        steps[n_steps, 1] = seeds[1] if n_seeds == 3 else -1
        steps[n_steps + 1, 0], steps[n_steps + 1, 2] = seeds[0], row
        end = _grow(graph, growth, seeds[:n_seeds], count, n_steps + 2)
        if end == n_steps + 2:
            for v in seeds[:n_seeds]:
                body_of[v] = -1
            continue
        count, n_steps = count + 1, end
        start[count] = n_steps
    return Bodies(body_of, steps[:n_steps], start[: count + 1])


@inline
def with_assumed(graph, live, bodies, order):
    """The bodies, and after them bodies made of homes of at least three points, each hung on those before
    it by at most two edges.

    What they lack is assumed inside (Fig. 13 a and b): `order.lacking` becomes 0 there. `bodies.body_of`
    changes in place.
    """
    n, body_of = graph.kind.shape[0], bodies.body_of
    n_bodies = bodies.start.shape[0] - 1
    steps, start = np.full((n, 4), -1, np.int64), np.zeros(n + 1, np.int64)
    by_turn = np.argsort(order.turn, kind="mergesort")
    count, n_steps = 0, 0
    for h in range(n):
        end, good = n_steps, True
        for v in by_turn:
            if order.home[v] != h or v == 0:
                continue
            hung = 0
            for at in range(graph.start[v], graph.start[v + 1]):
                row = graph.rows[at]
                if live[row] and _hangs(row, v, -1, graph.ends, body_of, n_bodies + count):
                    if hung < 2:
                        steps[end, 2 + hung] = row
                    hung += 1
            first = end - n_steps
            good = good and graph.kind[v] == POINT and hung <= 2
            good = good and (first > 1 or hung == first)
            steps[end, 0] = v
            body_of[v] = n_bodies + count
            end += 1
        if good and end >= n_steps + 3:
            for at in range(n_steps, end):
                order.lacking[steps[at, 0]] = 0
            count, n_steps = count + 1, end
            start[count] = n_steps
            continue
        for at in range(n_steps, end):
            body_of[steps[at, 0]] = -1
            steps[at, :] = -1
    return Bodies(
        body_of,
        np.concatenate((bodies.steps, steps[:n_steps])),
        np.concatenate((bodies.start, bodies.start[-1] + start[1 : count + 1])),
    )

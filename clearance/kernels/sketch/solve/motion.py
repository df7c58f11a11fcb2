"""The freedoms of a numeric cluster: its columns, its squared error, its moves and how to undo them.

Unknowns are the freedoms of the vertices and, for a body, a shift and a turn about its pivot; a body's
members are moved rigidly, so that what is already true inside it stays true.
"""

import math

import numpy as np

from clearance.compile.jit import inline
from clearance.kernels.sketch.equations import evaluate
from clearance.kernels.sketch.graph.graph import POINT, SLIDE, TURN
from clearance.kernels.sketch.solve.place import assign


@inline
def columns(s, vertices, body_of, first):
    """Fills `first` (v,) with the first column of every vertex (of its body, if it has one); their
    number.

    `first` must be -1 for all others.
    """
    count = 0
    for v in vertices:
        if body_of[v] >= 0:
            continue
        first[v] = count
        count += 2 if s.kind[v] == POINT else 1
    for v in vertices:
        b = body_of[v]
        if b < 0 or first[v] >= 0:
            continue
        for u in vertices:
            if body_of[u] == b:
                first[u] = count
        count += 3
    return count


@inline
def freedoms(s, vertices, body_of):
    """How many unknowns a cluster has; a body's members are listed together."""
    count, last = 0, -1
    for v in vertices:
        b = body_of[v]
        if b < 0:
            count += 2 if s.kind[v] == POINT else 1
        elif b != last:
            count += 3
        last = b
    return count


@inline
def total_of(s, rows, x, gradient):
    """The sum of squared residuals."""
    total = 0.0
    for row in rows:
        f = evaluate(s.code, s.var, s.coef, s.value, x, row, gradient)
        total += f * f
    return total


@inline
def move(s, vertices, step, size, x, first, body_of, pivot):
    """Adds `size` times `step` to the vertices; bodies turn and shift exactly."""
    for v in vertices:  # offsets first: they need the directions before the turn
        i, at, b = s.root[v], first[v], body_of[v]
        if b >= 0 and s.kind[v] == SLIDE:
            before = x[i - 1]
            after = before + size * step[at + 2]
            d = x[i] + math.sin(before) * pivot[b, 0] - math.cos(before) * pivot[b, 1]
            px, py = pivot[b, 0] + size * step[at], pivot[b, 1] + size * step[at + 1]
            assign(s, v, d + math.cos(after) * py - math.sin(after) * px, x)
    for v in vertices:
        i, at, b = s.root[v], first[v], body_of[v]
        if b < 0:
            if s.kind[v] == POINT:
                x[i] += size * step[at]
                x[i + 1] += size * step[at + 1]
            else:
                assign(s, v, x[i] + size * step[at], x)
        elif s.kind[v] == TURN:
            assign(s, v, x[i] + size * step[at + 2], x)
        elif s.kind[v] == POINT:
            angle = size * step[at + 2]
            c, si = math.cos(angle), math.sin(angle)
            dx, dy = x[i] - pivot[b, 0], x[i + 1] - pivot[b, 1]
            x[i] = pivot[b, 0] + size * step[at] + c * dx - si * dy
            x[i + 1] = pivot[b, 1] + size * step[at + 1] + si * dx + c * dy
    last = -1
    for v in vertices:
        b = body_of[v]
        if b >= 0 and b != last:
            last = b
            pivot[b, 0] += size * step[first[v]]
            pivot[b, 1] += size * step[first[v] + 1]


@inline
def keep(s, vertices, x, kept, back):
    """Copies the vertices' numbers into `kept`, or back from it; returns how many there are."""
    at = 0
    for v in vertices:
        if s.kind[v] == POINT:
            for i in range(s.root[v], s.root[v] + 2):
                if back:
                    x[i] = kept[at]
                else:
                    kept[at] = x[i]
                at += 1
        else:
            for where in range(s.member_start[v], s.member_start[v + 1]):
                i = s.member[where]
                if back:
                    x[i] = kept[at]
                else:
                    kept[at] = x[i]
                at += 1
    return at


@inline
def room(s, vertices):
    """How many numbers `keep` needs."""
    count = 0
    for v in vertices:
        count += 2 if s.kind[v] == POINT else s.member_start[v + 1] - s.member_start[v]
    return count


@inline
def pivots_of(s, body_of, n_bodies, x):
    """The mean of every body's points (n_bodies, 2)."""
    out = np.zeros((n_bodies, 2))
    count = np.zeros(n_bodies)
    for v in range(body_of.shape[0]):
        b = body_of[v]
        if b >= 0 and s.kind[v] == POINT:
            out[b, 0] += x[s.root[v]]
            out[b, 1] += x[s.root[v] + 1]
            count[b] += 1.0
    for b in range(n_bodies):
        out[b] /= max(count[b], 1.0)
    return out

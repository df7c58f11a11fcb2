"""Large numeric clusters: damped least squares on a banded matrix, without leaving compiled code.

The columns are numbered breadth first from a far end of the cluster (Cuthill and McKee), so that the normal
matrix is a band: n columns of width w cost n w^2 instead of n^3. The damping is in the diagonal's own units
(Marquardt), so that lengths and turns may be mixed. Not for: the last digits, which `sketch.solve.newton` adds.
Sources: Cuthill, McKee 1969; Marquardt 1963.
"""

import math

import numpy as np

from clearance.compile.jit import inline
from clearance.kernels.sketch.equations import evaluate
from clearance.kernels.sketch.graph.graph import POINT, SLIDE, TURN
from clearance.kernels.sketch.solve.motion import keep, move, room, total_of


@inline
def nodes_of(s, vertices, rows, first, n):
    """Nodes (vertices or bodies) by first column: (ids by column, widths, nodes (m, 8) of every row)."""
    node_at = np.full(n, -1, np.int64)
    for v in vertices:
        node_at[first[v]] = 0
    count = 0
    for c in range(n):
        if node_at[c] == 0:
            node_at[c] = count
            count += 1
    width = np.zeros(count, np.int64)
    last = -1
    for c in range(n):
        last = node_at[c] if node_at[c] >= 0 else last
        width[last] += 1
    of_row = np.full((rows.shape[0], 8), -1, np.int64)
    for a in range(rows.shape[0]):
        for k in range(8):
            i = s.var[rows[a], k]
            if i >= 0 and s.vertex_of[i] >= 0 and first[s.vertex_of[i]] >= 0:
                of_row[a, k] = node_at[first[s.vertex_of[i]]]
    return node_at, width, of_row


@inline
def incidence(of_row, count):
    """The rows of every node as (starts, rows); a row that names a node twice is listed twice."""
    start = np.zeros(count + 1, np.int64)
    for a in range(of_row.shape[0]):
        for k in range(8):
            if of_row[a, k] >= 0:
                start[of_row[a, k] + 1] += 1
    start = np.cumsum(start)
    mine = np.empty(start[-1], np.int64)
    fill = start[:-1].copy()
    for a in range(of_row.shape[0]):
        for k in range(8):
            if of_row[a, k] >= 0:
                mine[fill[of_row[a, k]]] = a
                fill[of_row[a, k]] += 1
    return start, mine


@inline
def _breadth_first(root, of_row, start, mine, order, seen):
    """Fills `order` with all nodes, breadth first from `root`, then from what is left."""
    count = start.shape[0] - 1
    seen[:] = 0
    head, tail = 0, 1
    order[0] = root
    seen[root] = 1
    following = 0
    while head < count:
        if head == tail:
            while seen[following]:
                following += 1
            order[tail] = following
            seen[following] = 1
            tail += 1
        u = order[head]
        head += 1
        for at in range(start[u], start[u + 1]):
            for k in range(8):
                w = of_row[mine[at], k]
                if w >= 0 and not seen[w]:
                    seen[w] = 1
                    order[tail] = w
                    tail += 1


@inline
def narrow(vertices, first, n, node_at, width, of_row, start, mine):
    """Renumbers the columns in `first` so that the normal matrix is a narrow band; its half width.

    The nodes come from `nodes_of` and `incidence`; returns also the new first column of each.
    """
    count = width.shape[0]
    order, seen = np.zeros(count, np.int64), np.zeros(count, np.uint8)
    for _ in range(3):
        _breadth_first(order[count - 1], of_row, start, mine, order, seen)
    column = np.zeros(count, np.int64)
    at = 0
    for node in order:
        column[node] = at
        at += width[node]
    for v in vertices:  # a body's members share one first column: read the old numbers only
        first[v] = -2 - node_at[first[v]] if first[v] >= 0 else first[v]
    for v in vertices:
        if first[v] <= -2:
            first[v] = column[-2 - first[v]]
    half = 3
    for a in range(of_row.shape[0]):
        low, high = n, -1
        for k in range(8):
            if of_row[a, k] >= 0:
                low = min(low, column[of_row[a, k]])
                high = max(high, column[of_row[a, k]] + width[of_row[a, k]])
        half = max(half, high - low)
    return half, column


@inline
def _entries(s, row, x, first, body_of, pivot, gradient, column, value):
    """The derivative of an equation as (column, value) pairs, from its derivatives by slot; how many."""
    count = 0
    for k in range(8):
        i = s.var[row, k]
        g = gradient[k]
        if i < 0 or g == 0.0 or s.vertex_of[i] < 0 or first[s.vertex_of[i]] < 0:
            continue
        v = s.vertex_of[i]
        at, b, kind = first[v], body_of[v], s.kind[v]
        if b < 0:
            column[count] = at + (i - s.root[v] if kind == POINT else 0)
            value[count] = g if kind == POINT else g * s.scale[i]
            count += 1
            continue
        dx = dy = turn = 0.0
        if kind == TURN:
            turn = g
        elif kind == SLIDE:
            si, c = math.sin(x[i - 1]), math.cos(x[i - 1])
            dx, dy, turn = -g * si, g * c, -g * (c * pivot[b, 0] + si * pivot[b, 1])
        elif i == s.root[v]:
            dx, turn = g, -g * (x[i + 1] - pivot[b, 1])
        else:
            dy, turn = g, g * (x[i - 1] - pivot[b, 0])
        column[count], column[count + 1], column[count + 2] = at, at + 1, at + 2
        value[count], value[count + 1], value[count + 2] = dx, dy, turn
        count += 3
    return count


@inline
def _normal(s, rows, x, first, body_of, pivot, band, right, gradient):
    """Fills the band (n, w) of the normal matrix's upper half and minus the gradient (n,)."""
    column, value = np.empty(24, np.int64), np.empty(24)
    band[:, :] = 0.0
    right[:] = 0.0
    for row in rows:
        f = evaluate(s.code, s.var, s.coef, s.value, x, row, gradient)
        count = _entries(s, row, x, first, body_of, pivot, gradient, column, value)
        for p in range(count):
            right[column[p]] -= f * value[p]
            for q in range(count):
                if column[q] >= column[p]:
                    band[column[p], column[q] - column[p]] += value[p] * value[q]


@inline
def _solve_band(band, right):
    """Solves the positive definite system in place by Cholesky's method; False when it is not definite."""
    n, w = band.shape
    for j in range(n):
        if not band[j, 0] > 0.0:
            return False
        inverse = 1.0 / math.sqrt(band[j, 0])
        band[j, 0] = inverse
        for k in range(1, w):
            band[j, k] *= inverse
        right[j] *= inverse
        for k in range(1, min(w, n - j)):
            c = band[j, k]
            if c != 0.0:
                right[j + k] -= c * right[j]
                for q in range(w - k):
                    band[j + k, q] -= c * band[j, k + q]
    for j in range(n - 1, -1, -1):
        total = right[j]
        for k in range(1, min(w, n - j)):
            total -= band[j, k] * right[j + k]
        right[j] = total * band[j, 0]
    return True


@inline
def descend_damped(
    s,
    vertices,
    rows,
    x,
    body_of,
    pivot,
    first,
    n,
    half,
    damping,
    least,
    enough,
    longest,
    patience,
):
    """Moves the vertices until the sum of squares is at most `least` or falls too little.

    `first` (v,) holds the columns by vertex, `half` the width of their band; `damping` is the first
    one, in units of the diagonal. The sum must fall by a fifth in `patience` steps; below `enough` the
    first step that gains nothing ends it.
    Returns (sum, steps). Over 60 lines by its arguments, one a line.
    """
    band, factor = np.empty((n, half)), np.empty((n, half))
    right, step, unit = np.empty(n), np.empty(n), np.empty(n)
    gradient, kept, pivots = np.empty(8), np.empty(room(s, vertices)), pivot.copy()
    total = total_of(s, rows, x, gradient)
    past, stale, k = total, True, 0
    while k < longest and total > least and damping <= 1e6:
        if stale:
            _normal(s, rows, x, first, body_of, pivot, band, right, gradient)
            stale = False
        if k == 0:
            for c in range(n):
                unit[c] = band[c, 0] if band[c, 0] > 0.0 else 1.0
        factor[:, :] = band
        step[:] = right
        for c in range(n):
            factor[c, 0] += damping * unit[c]
        keep(s, vertices, x, kept, False)
        pivots[:] = pivot
        after = math.inf
        if _solve_band(factor, step):
            move(s, vertices, step, 1.0, x, first, body_of, pivot)
            after = total_of(s, rows, x, gradient)
        if after < total:
            damping *= 0.1 if after < 0.3 * total else (0.4 if after < 0.7 * total else 1.0)
            damping = max(damping, 1e-13)
            total, stale = after, True
        else:
            keep(s, vertices, x, kept, True)
            pivot[:] = pivots
            if total <= enough:
                break
            damping *= 4.0
        k += 1
        if k % patience == 0:
            if total > 0.8 * past:
                break
            past = total
    return total, k

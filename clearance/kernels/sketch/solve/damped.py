"""Large numeric clusters: damped least squares on a banded matrix, without leaving compiled code.

The columns are numbered breadth first from a far end of the cluster (Cuthill and McKee), so that the normal
matrix is a band: n columns of width w cost n w^2 instead of n^3. The damping is in the diagonal's own units
(Marquardt), so that lengths and turns may be mixed. Not for: the last digits, which `sketch.solve.newton` adds.
Sources: Cuthill, McKee 1969; Marquardt 1963.
"""

import math
from typing import NamedTuple

import numpy as np

from clearance.compile.jit import inline
from clearance.kernels.sketch.equations import evaluate
from clearance.kernels.sketch.graph.graph import POINT, SLIDE, TURN, rows_of_each
from clearance.kernels.sketch.solve.motion import keep, move, new_kept_place, restore, total_of


class ClusterNodes(NamedTuple):
    """The nodes of a cluster, each a body or a single vertex, and the equations between them.

    Attributes:
        node_at: (n,) the node that begins at a column, -1 where none does.
        width: (nodes,) the columns of every node.
        is_turn: (nodes,) marks the single directions.
        of_row: (m, 8) the nodes of every equation by slot, -1 pads.
        start, rows: the equations of every node, (nodes + 1,) starts; one that names it twice is listed twice.
    """

    node_at: np.ndarray
    width: np.ndarray
    is_turn: np.ndarray
    of_row: np.ndarray
    start: np.ndarray
    rows: np.ndarray


class NormalEquations(NamedTuple):
    """The upper half of a normal matrix as a band (n, half width), and minus the gradient (n,)."""

    band: np.ndarray
    right: np.ndarray


class DescentLimits(NamedTuple):
    """How a damped descent begins and ends.

    Attributes:
        damping: [-] the first, in units of the diagonal.
        least: [m^2] the sum of squares that is aimed at. enough: [m^2] below it the first step that gains nothing
            ends the descent.
        longest: steps. patience: steps in which the sum must fall by a fifth.
    """

    damping: float
    least: float
    enough: float
    longest: int
    patience: int


@inline
def nodes_of(s, unknowns):
    """The nodes of a cluster in the order of their first columns."""
    cluster, first, n = unknowns.cluster, unknowns.first, unknowns.n
    vertices, rows = cluster.vertices, cluster.rows
    node_at = np.full(n, -1, np.int64)
    for v in vertices:
        node_at[first[v]] = 0
    count = 0
    for c in range(n):
        if node_at[c] == 0:
            node_at[c] = count
            count += 1
    width, is_turn = np.zeros(count, np.int64), np.zeros(count, np.uint8)
    last = -1
    for c in range(n):
        last = node_at[c] if node_at[c] >= 0 else last
        width[last] += 1
    for v in vertices:
        is_turn[node_at[first[v]]] = cluster.body_of[v] < 0 and s.kind[v] == TURN
    of_row = np.full((rows.shape[0], 8), -1, np.int64)
    for a in range(rows.shape[0]):
        for k in range(8):
            i = s.var[rows[a], k]
            if i >= 0 and s.vertex_of[i] >= 0 and first[s.vertex_of[i]] >= 0:
                of_row[a, k] = node_at[first[s.vertex_of[i]]]
    start, mine = rows_of_each(of_row, count)
    return ClusterNodes(node_at, width, is_turn, of_row, start, mine)


@inline
def _breadth_first(root, nodes, order, seen):
    """Fills `order` with all nodes, breadth first from `root`, then from what is left."""
    start, of_row = nodes.start, nodes.of_row
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
                w = of_row[nodes.rows[at], k]
                if w >= 0 and not seen[w]:
                    seen[w] = 1
                    order[tail] = w
                    tail += 1


@inline
def narrow(unknowns, nodes):
    """Renumbers the columns in `unknowns.first` so that the normal matrix is a narrow band.

    Returns (its half width, the new first column of every node).
    """
    vertices, first, n = unknowns.cluster.vertices, unknowns.first, unknowns.n
    node_at, width, of_row = nodes.node_at, nodes.width, nodes.of_row
    count = width.shape[0]
    order, seen = np.zeros(count, np.int64), np.zeros(count, np.uint8)
    for _ in range(3):
        _breadth_first(order[count - 1], nodes, order, seen)
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


@inline(force=True)
def _entries(s, row, unknowns, place, gradient, column, value):
    """The derivative of an equation as (column, value) pairs, from its derivatives by slot; how many."""
    first, body_of, x, pivot = unknowns.first, unknowns.cluster.body_of, place.x, place.pivot
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
def _fill_normal(s, unknowns, place, normal, gradient):
    """Fills the normal equations at a place."""
    band, right = normal.band, normal.right
    column, value = np.empty(24, np.int64), np.empty(24)
    band[:, :] = 0.0
    right[:] = 0.0
    for row in unknowns.cluster.rows:
        f = evaluate(s.code, s.var, s.coef, s.value, place.x, row, gradient)
        count = _entries(s, row, unknowns, place, gradient, column, value)
        for p in range(count):
            right[column[p]] -= f * value[p]
            for q in range(count):
                if column[q] >= column[p]:
                    band[column[p], column[q] - column[p]] += value[p] * value[q]


@inline(one_caller=True)
def _damp(normal, damping, unit, damped):
    """Fills the damped equations: `damping` times the unit (n,) of every diagonal number is added to it."""
    damped.band[:, :] = normal.band
    damped.right[:] = normal.right
    for c in range(unit.shape[0]):
        damped.band[c, 0] += damping * unit[c]


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
def descend_damped(s, unknowns, place, half, limits):
    """Moves the cluster until the sum of squares is at most `limits.least` or falls too little; (sum, steps).

    `half` is the width of the band of `narrow`.
    """
    vertices, rows, n = unknowns.cluster.vertices, unknowns.cluster.rows, unknowns.n
    normal = NormalEquations(np.empty((n, half)), np.empty(n))
    damped = NormalEquations(np.empty((n, half)), np.empty(n))
    unit, gradient, kept = np.empty(n), np.empty(8), new_kept_place(s, vertices, place)
    total, damping = total_of(s, rows, place.x, gradient), limits.damping
    past, stale, k = total, True, 0
    while k < limits.longest and total > limits.least and damping <= 1e6:
        if stale:
            _fill_normal(s, unknowns, place, normal, gradient)
            stale = False
        if k == 0:
            for c in range(n):
                unit[c] = normal.band[c, 0] if normal.band[c, 0] > 0.0 else 1.0
        _damp(normal, damping, unit, damped)
        keep(s, vertices, place, kept)
        after = math.inf
        if _solve_band(damped.band, damped.right):
            move(s, unknowns, damped.right, 1.0, place)
            after = total_of(s, rows, place.x, gradient)
        if after < total:
            damping *= 0.1 if after < 0.3 * total else (0.4 if after < 0.7 * total else 1.0)
            damping = max(damping, 1e-13)
            total, stale = after, True
        else:
            restore(s, vertices, kept, place)
            if total <= limits.enough:
                break
            damping *= 4.0
        k += 1
        if k % limits.patience == 0:
            if total > 0.8 * past:
                break
            past = total
    return total, k

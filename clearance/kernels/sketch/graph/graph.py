"""From equations to the constraint graph: pseudo entities merged, then vertices, edges and their
lists.

Relations that are linear between directions, between offsets of parallel lines, or between radii
are merged beforehand by a weighted union-find (the paper's preprocessing: edges of valency 2 make
pseudo entities). What is left is a hypergraph: a vertex is a point (2 degrees of freedom), a class
of directions, of offsets or of radii (1 each), or the ground (vertex 0: a rigid body, 3); an edge
is one equation.
"""

from typing import NamedTuple

import numpy as np

from clearance.compile.jit import inline, kernel
from clearance.kernels.sketch.equations import LINEAR, RATIO

X, Y, DIRECTION, OFFSET, RADIUS = 0, 1, 2, 3, 4
"""Roles of variables."""
GROUND, POINT, TURN, SLIDE, SIZE = 0, 1, 2, 3, 4
"""Kinds of vertices: TURN is a class of directions, SLIDE of offsets, SIZE of radii."""
IN_GRAPH, MERGED, REPEATED, CONTRADICTED = 0, 1, 2, 3
"""What became of an equation: an edge, used by a merge, implied by merges, or contrary to them."""


class ConstraintGraph(NamedTuple):
    """Vertices and edges, and the edges of every vertex.

    Attributes:
        kind: (v,) GROUND, POINT, TURN, SLIDE or SIZE.
        ends: (m, 5) the vertices of every edge, -1 pads.
        absolute: (m,) 1 where an edge refers to the ground by position.
        theta_of: (v,) the class of directions that a class of offsets belongs to.
        start: (v + 1,) where the edges of every vertex begin in `rows`.
        rows: the edges by vertex.
    """

    kind: np.ndarray
    ends: np.ndarray
    absolute: np.ndarray
    theta_of: np.ndarray
    start: np.ndarray
    rows: np.ndarray


@inline
def _root(parent, scale, shift, i):
    """The root r of i and the pair (a, b) with x_i = a x_r + b."""
    a, b = 1.0, 0.0
    while parent[i] != i:
        b += a * shift[i]
        a *= scale[i]
        i = parent[i]
    return i, a, b


@inline
def _mergeable(code, var, role, row):
    """How many variables (1 or 2) a linear relation of directions, offsets or radii has; else 0."""
    if code[row] != LINEAR and code[row] != RATIO:
        return 0
    count = 0
    for k in range(4):
        if var[row, k] >= 0:
            if role[var[row, k]] < DIRECTION:
                return 0
            count += 1
    return count if count <= 2 else 0


@kernel
def merge(code, var, coef, value, role, length_scale, tolerance):
    """Parents, scales, shifts (n + 1,) of the union-find forest and the fate (m,) of every
    equation.

    x_i = scale_i x_parent + shift_i; node n stands for a known number (scale 0).
    """
    n = role.shape[0]
    parent = np.arange(n + 1)
    scale = np.ones(n + 1)
    shift = np.zeros(n + 1)
    rank = np.zeros(n + 1, np.int64)
    fate = np.zeros(code.shape[0], np.int64)
    for row in range(code.shape[0]):
        count = _mergeable(code, var, role, row)
        if count == 0:
            continue
        v = value[row]
        c0, c1 = coef[row, 0], coef[row, 1]
        if code[row] == RATIO:
            c0, c1, v = 1.0, -value[row], 0.0
        i, a, b = _root(parent, scale, shift, var[row, 0])
        j, p, q = n, 0.0, 0.0
        if count == 2:
            j, p, q = _root(parent, scale, shift, var[row, 1])
        else:
            c1 = 0.0
        a, p = c0 * a, c1 * p  # a x_i + p x_j = v - c0 b - c1 q
        rest = v - c0 * b - c1 * q
        if i == j:
            a, p, j = a + p, 0.0, n
        if i == n:
            i, j, a, p = j, i, p, a
        if i == n or abs(a) <= 1e-12 * (abs(c0) + abs(c1)):
            fate[row] = CONTRADICTED if abs(rest) * length_scale[row] > tolerance else REPEATED
            continue
        fate[row] = MERGED
        if j == n:
            p = 0.0
        elif rank[i] > rank[j] and p != 0.0:
            i, j, a, p = j, i, p, a
        parent[i] = j
        scale[i] = -p / a if j != n else 0.0
        shift[i] = rest / a
        rank[j] = max(rank[j], rank[i] + 1)
    for i in range(n):
        r, a, b = _root(parent, scale, shift, i)
        parent[i], scale[i], shift[i] = r, (0.0 if r == n else a), b
    return parent, scale, shift, fate


@kernel
def vertices(role, parent, used):
    """The vertex of every variable (-1: a known radius or unused), and of every vertex its kind and
    root.

    Returns (vertex_of (n,), kind (v,), root (v,)).
    """
    n = role.shape[0]
    vertex_of = np.full(n, -1, np.int64)
    kind = np.empty(n + 1, np.int64)
    root = np.empty(n + 1, np.int64)
    kind[0], root[0] = GROUND, -1
    count = 1
    for i in range(n):
        if role[i] == Y or not used[i]:
            continue
        if role[i] == X:
            vertex_of[i] = vertex_of[i + 1] = count
            kind[count], root[count] = POINT, i
            count += 1
        elif parent[i] == i:
            vertex_of[i] = count
            kind[count], root[count] = role[i], i
            count += 1
    for i in range(n):
        if role[i] >= DIRECTION and used[i]:
            if parent[i] < n:
                vertex_of[i] = vertex_of[parent[i]]
            elif role[i] != RADIUS:
                vertex_of[i] = 0
    return vertex_of, kind[:count], root[:count]


@kernel
def edges(var, absolute, fate, vertex_of):
    """The distinct vertices (m, 5) of every equation that is an edge; -1 pads."""
    out = np.full((var.shape[0], 5), -1, np.int64)
    for row in range(var.shape[0]):
        if fate[row] != IN_GRAPH:
            continue
        count = 0
        if absolute[row]:
            out[row, 0] = 0
            count = 1
        for k in range(8):
            i = var[row, k]
            if i < 0 or vertex_of[i] < 0:
                continue
            fresh = True
            for c in range(count):
                if out[row, c] == vertex_of[i]:
                    fresh = False
            if fresh:
                out[row, count] = vertex_of[i]
                count += 1
    return out


@inline
def rows_of_each(ends, n_vertices):
    """The rows of `ends` that name each vertex, as (starts (v + 1,), rows); -1 names none.

    A row that names a vertex twice is listed twice.
    """
    starts = np.zeros(n_vertices + 1, np.int64)
    for row in range(ends.shape[0]):
        for k in range(ends.shape[1]):
            if ends[row, k] >= 0:
                starts[ends[row, k] + 1] += 1
    starts = np.cumsum(starts)
    rows = np.empty(starts[-1], np.int64)
    fill = starts[:-1].copy()
    for row in range(ends.shape[0]):
        for k in range(ends.shape[1]):
            if ends[row, k] >= 0:
                rows[fill[ends[row, k]]] = row
                fill[ends[row, k]] += 1
    return starts, rows


@inline
def graph_of(kind, ends, absolute, theta_of):
    """The constraint graph of these vertices and edges."""
    start, rows = rows_of_each(ends, kind.shape[0])
    return ConstraintGraph(kind, ends, absolute, theta_of, start, rows)


@kernel
def members(vertex_of, role, parent, n_vertices):
    """The merged variables of every TURN, SLIDE and SIZE vertex as (starts (v + 1,), variables)."""
    n = role.shape[0]
    starts = np.zeros(n_vertices + 1, np.int64)
    for i in range(n):
        if role[i] >= DIRECTION and vertex_of[i] > 0:
            starts[vertex_of[i] + 1] += 1
    starts = np.cumsum(starts)
    out = np.empty(starts[-1], np.int64)
    fill = starts[:-1].copy()
    for i in range(n):
        if role[i] >= DIRECTION and vertex_of[i] > 0:
            out[fill[vertex_of[i]]] = i
            fill[vertex_of[i]] += 1
    return starts, out

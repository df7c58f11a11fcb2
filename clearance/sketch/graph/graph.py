"""From equations to the constraint graph: pseudo entities merged, then vertices, edges and their
lists.

Relations that are linear between directions, between offsets of parallel lines, or between radii
are merged beforehand by a weighted union-find (the paper's preprocessing: edges of valency 2 make
pseudo entities). The rest is a hypergraph: a vertex is a point (2 degrees of freedom), a class
of directions, of offsets or of radii (1 each), or the ground (vertex 0: a rigid body, 3); an edge
is one equation.
"""

from __future__ import annotations

from dataclasses import dataclass, replace
from typing import NamedTuple

import numpy as np
from scipy.sparse import coo_array
from scipy.sparse.csgraph import connected_components

from clearance.sketch.equations import CODES, Linear, Ratio, are, places

X, Y, DIRECTION, OFFSET, RADIUS = 0, 1, 2, 3, 4
"""Roles of variables."""
GROUND, POINT, TURN, SLIDE, SIZE = 0, 1, 2, 3, 4
"""Kinds of vertices: TURN is a class of directions, SLIDE of offsets, SIZE of radii."""
IN_GRAPH, MERGED, REPEATED, CONTRADICTED = 0, 1, 2, 3
"""The fate of an equation: an edge, used by a merge, implied by merges, or contrary to them."""

FREEDOMS = (3, 2, 1, 1, 1)
"""Degrees of freedom by kind of vertex."""


@dataclass(frozen=True, eq=False)
class ConstraintGraph:
    """Vertices and edges, and the edges of every vertex.

    Attributes:
        kind: by vertex: GROUND, POINT, TURN, SLIDE or SIZE.
        ends: by equation: its distinct vertices; none for one that is no edge.
        absolute: by equation: 1 where it refers to the ground by position.
        theta_of: by vertex: the class of directions that a class of offsets belongs to.
        rows: by vertex: its edges.
    """

    kind: list[int]
    ends: list[tuple[int, ...]]
    absolute: list[int]
    theta_of: list[int]
    rows: list[list[int]]


def graph_of(
    kind: np.ndarray, ends: np.ndarray, absolute: np.ndarray, theta_of: np.ndarray
) -> ConstraintGraph:
    """The constraint graph of vertices and edges (m, 5), -1 pads."""
    edges = [tuple(v for v in row if v >= 0) for row in ends.tolist()]
    rows: list[list[int]] = [[] for _ in range(kind.size)]
    for row, mine in enumerate(edges):
        for v in mine:
            rows[v].append(row)
    return ConstraintGraph(kind.tolist(), edges, absolute.tolist(), theta_of.tolist(), rows)


class Merged(NamedTuple):
    """Merged numbers: (n + 1,) each is `scale` times that of `parent`, plus `shift`; node n stands for a known
    number (scale 0). `fate` (m,) is what became of every equation."""

    parent: np.ndarray
    scale: np.ndarray
    shift: np.ndarray
    fate: np.ndarray


class _Forest:
    """A weighted union-find: x_i = scale_i x_parent + shift_i; node n stands for known numbers."""

    def __init__(self, n: int) -> None:
        self.n = n
        self.parent = list(range(n + 1))
        self.scale, self.shift = [1.0] * (n + 1), [0.0] * (n + 1)
        self.rank = [0] * (n + 1)

    def root(self, i: int) -> tuple[int, float, float]:
        """The root r of i and the pair (a, b) with x_i = a x_r + b."""
        a, b = 1.0, 0.0
        while self.parent[i] != i:
            b += a * self.shift[i]
            a *= self.scale[i]
            i = self.parent[i]
        return i, a, b

    def relate(self, i: int, j: int, c0: float, c1: float, value: float) -> float | None:
        """Adds c0 x_i + c1 x_j = value (c1 is 0 without j); its error where it was known already."""
        i, a, b = self.root(i)
        j, p, q = self.root(j) if c1 != 0.0 else (self.n, 0.0, 0.0)
        a, p = c0 * a, c1 * p  # a x_i + p x_j = value - c0 b - c1 q
        rest = value - c0 * b - c1 * q
        if i == j:
            a, p, j = a + p, 0.0, self.n
        if i == self.n:
            i, j, a, p = j, i, p, a
        if i == self.n or abs(a) <= 1e-12 * (abs(c0) + abs(c1)):
            return abs(rest)
        if j == self.n:
            p = 0.0
        elif self.rank[i] > self.rank[j] and p != 0.0:
            i, j, a, p = j, i, p, a
        self.parent[i] = j
        self.scale[i] = -p / a if j != self.n else 0.0
        self.shift[i] = rest / a
        self.rank[j] = max(self.rank[j], self.rank[i] + 1)
        return None

    def flattened(self) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
        """(parents, scales, shifts) with every number hung on its root."""
        for i in range(self.n):
            if self.parent[i] != i:
                r, a, b = self.root(i)
                self.parent[i], self.shift[i] = r, b
                self.scale[i] = 0.0 if r == self.n else a
        return np.array(self.parent), np.array(self.scale), np.array(self.shift)


def merge(code, var, coef, value, role, length_scale, tolerance: float) -> Merged:
    """The merged numbers of some equations: of every one that relates at most two directions, offsets or radii."""
    forest, fate = _Forest(role.size), np.zeros(code.size, np.int64)
    of = places(Linear, var)
    numbers = np.column_stack(of)
    named = numbers >= 0
    plain = (named & (role[numbers] < DIRECTION)).any(axis=1) if role.size else named.any(axis=1)
    linear = are(code, Linear, Ratio) & ~plain & (named.sum(axis=1) <= 2)
    for row in np.flatnonzero(linear).tolist():
        ratio = code[row] == CODES[Ratio]
        c0, c1 = ((1.0, -value[row]) if ratio else coef[row, :2]) * named[row, :2]
        wanted = 0.0 if ratio else value[row]
        error = forest.relate(int(of.a[row]), int(of.b[row]), float(c0), float(c1), wanted)
        known = (
            CONTRADICTED
            if error is not None and error * length_scale[row] > tolerance
            else REPEATED
        )
        fate[row] = MERGED if error is None else known
    return Merged(*forest.flattened(), fate)


def vertices(role, parent, used) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """(vertex of every variable, -1: a known radius or unused; kind and root of every vertex)."""
    n = role.size
    begins = used & (role != Y) & ((role == X) | (parent[:n] == np.arange(n)))
    root = np.flatnonzero(begins)
    vertex_of = np.full(n, -1)
    vertex_of[root] = np.arange(1, root.size + 1)
    points = root[role[root] == X]
    vertex_of[points + 1] = vertex_of[points]
    merged = np.flatnonzero(used & (role >= DIRECTION))
    known = parent[merged] == n
    vertex_of[merged[~known]] = vertex_of[parent[merged[~known]]]
    vertex_of[merged[known & (role[merged] != RADIUS)]] = 0
    kind = np.where(role[root] == X, POINT, role[root])
    return vertex_of, np.append(GROUND, kind), np.append(-1, root)


def edges(var, absolute, fate, vertex_of) -> np.ndarray:
    """The distinct vertices (m, 5) of every equation that is an edge; -1 pads."""
    out = np.full((var.shape[0], 5), -1)
    if not var.shape[0]:
        return out
    named = np.where(var >= 0, vertex_of[var], -1)
    named = np.column_stack([np.where(absolute > 0, 0, -1), named])
    for k in range(1, 9):
        again = (named[:, :k] == named[:, k : k + 1]).any(axis=1)
        named[again, k] = -1
    order = np.argsort(named < 0, axis=1, kind="stable")[:, :5]
    chosen = fate == IN_GRAPH
    out[chosen] = np.take_along_axis(named, order, axis=1)[chosen]
    return out


def members(vertex_of, role, n_vertices: int) -> tuple[np.ndarray, np.ndarray]:
    """The merged variables of every TURN, SLIDE and SIZE vertex as (starts (v + 1,), variables)."""
    mine = np.flatnonzero((role >= DIRECTION) & (vertex_of > 0))
    mine = mine[np.argsort(vertex_of[mine], kind="stable")]
    starts = np.searchsorted(vertex_of[mine], np.arange(n_vertices + 1))
    return starts, mine


class Components(NamedTuple):
    """The connected parts of a graph, and how each hangs on the ground.

    Attributes:
        part: (v,) the part of every vertex; the ground's is -1.
        n_parts: how many there are.
        fixing: (parts,) 0 not at all, 1 by directions only, 2 by position.
    """

    part: np.ndarray
    n_parts: int
    fixing: np.ndarray


def components(kind, ends, theta_of, absolute) -> Components:
    """The connected parts of a graph with edges (m, 5); see `Components`."""
    n, m = kind.size, ends.shape[0]
    row, slot = np.nonzero(ends > 0)
    slides = np.flatnonzero((kind == SLIDE) & (theta_of > 0))
    i = np.concatenate([n + row, slides])
    j = np.concatenate([ends[row, slot], theta_of[slides]])
    links = coo_array((np.ones(i.size), (i, j)), (n + m, n + m))
    labels = connected_components(links, directed=False)[1][1:n]
    seen, place = np.unique(labels, return_inverse=True)
    part = np.append(-1, place).astype(np.int64)  # labels follow the least vertex of a part
    fixing = np.zeros(seen.size, np.int64)
    grounded = (ends == 0).any(axis=1)[row]
    np.maximum.at(
        fixing, part[ends[row, slot]][grounded], np.where(absolute[row] == 1, 2, 1)[grounded]
    )
    np.maximum.at(fixing, part[np.flatnonzero((kind == SLIDE) & (theta_of == 0))], 1)
    return Components(part, seen.size, fixing)


PEELED, IN_BODY, IN_CORE = 0, 1, 2
"""The origin of a step: peeled off, inside a body, a cluster of the core."""


@dataclass(frozen=True)
class PlanStep:
    """Vertices that are placed at once, and the equations that place them.

    A closed step places one vertex, with a partner perhaps: a direction and its offset, a centre and its radius.
    A numeric one is a cluster, a body's members together.
    """

    vertices: tuple[int, ...]
    rows: tuple[int, ...]
    origin: int
    numeric: bool = False

    @property
    def vertex(self) -> int:
        """The first vertex."""
        return self.vertices[0]

    @property
    def partner(self) -> int:
        """The vertex that a closed step places with its own; -1 for none."""
        return -1 if self.numeric or len(self.vertices) == 1 else self.vertices[1]


@dataclass(frozen=True, eq=False)
class ConstructionPlan:
    """A construction plan: its steps in the order of placing, and what is known of the graph.

    Attributes:
        body_of: (v,) the body of every vertex, -1 outside bodies.
        fixed: (b,) marks the initial clusters.
        dependent: (k,) the edges that others imply.
        circuits: the edges of the circuit of each.
    """

    steps: tuple[PlanStep, ...]
    body_of: np.ndarray
    fixed: np.ndarray
    dependent: np.ndarray
    circuits: list[list[int]]

    def after(self, k: int) -> ConstructionPlan:
        """The plan of the steps that follow step k."""
        return replace(self, steps=self.steps[k + 1 :])

"""GJK on the Minkowski difference of two polytopes, keeping the simplex's points of both.

Support points come from hill climbing on the vertex graph. The point of least norm in a simplex of up to
four points is found over its 15 faces by solving for the coefficients and keeping the least valid one, which
knows no special case: a degenerate simplex only drops the faces that have no solution. Not for: m bodies.
"""

from __future__ import annotations

import math
from typing import NamedTuple

import numpy as np

from clearance.compile.declared import Floats, Floats2, Integers
from clearance.compile.decorators import inline, kernel

SEPARATED, COMMON, STALLED = 0, 1, 2
LIMIT = 128


class VertexGraph(NamedTuple):
    """The corners of a convex body (n, 3) [m], and its edges: the starts (n + 1,) of each corner's neighbours."""

    vertices: Floats2
    starts: Integers
    neighbours: Integers


@inline
def hill_climb(graph, v, x, y, z):
    """The vertex farthest in direction (x, y, z), from vertex `v` upwards over the edges.

    Source: Tereshchenko (2013), section 1; Ericson (2005), section 9.5.4.
    """
    vertices, starts, neighbours = graph.vertices, graph.starts, graph.neighbours
    best = vertices[v, 0] * x + vertices[v, 1] * y + vertices[v, 2] * z
    while True:
        here = v
        for i in range(starts[here], starts[here + 1]):
            w = neighbours[i]
            value = vertices[w, 0] * x + vertices[w, 1] * y + vertices[w, 2] * z
            if value > best:
                best = value
                v = w
        if v == here:
            return v


@inline
def face_coefficients(gram, members, n, shares):
    """True if the affine hull of the simplex's `members` has its least point inside; sets `shares`.

    Solves the normal equations of the differences from the first member by Cramer's rule.
    """
    if n == 1:
        shares[0] = 1.0
        return True
    o = members[0]
    a = np.empty((3, 3))
    b = np.empty(3)
    for i in range(n - 1):
        p = members[i + 1]
        b[i] = gram[o, o] - gram[p, o]
        for j in range(n - 1):
            q = members[j + 1]
            a[i, j] = gram[p, q] - gram[p, o] - gram[o, q] + gram[o, o]
    if n == 2:
        det = a[0, 0]
        shares[1] = b[0]
    elif n == 3:
        det = a[0, 0] * a[1, 1] - a[0, 1] * a[1, 0]
        shares[1] = b[0] * a[1, 1] - b[1] * a[0, 1]
        shares[2] = a[0, 0] * b[1] - a[1, 0] * b[0]
    else:
        return False
    if not det > 0.0:
        return False
    rest = 1.0
    for i in range(1, n):
        shares[i] /= det
        rest -= shares[i]
    shares[0] = rest
    for i in range(n):
        if not shares[i] >= 0.0:
            return False
    return True


@inline
def tetrahedron_coefficients(points, shares):
    """True if the origin is in the tetrahedron; `shares` solves the paper's 4 x 4 system.

    Source: Tereshchenko (2013), section 2.2: sum l_i T_i = 0, sum l_i = 1, by signed volumes.
    """
    total = 0.0
    for i in range(4):
        p = points[(i + 1) % 4]
        q = points[(i + 2) % 4]
        r = points[(i + 3) % 4]
        volume = (
            p[0] * (q[1] * r[2] - q[2] * r[1])
            + p[1] * (q[2] * r[0] - q[0] * r[2])
            + p[2] * (q[0] * r[1] - q[1] * r[0])
        )
        shares[i] = -volume if i % 2 else volume
        total += shares[i]
    if total == 0.0:
        return False
    for i in range(4):
        shares[i] /= total
        if not shares[i] >= 0.0:
            return False
    return True


@inline
def least_point(points, n, keep, shares, nearest):
    """Number of simplex points that carry the point of least norm; sets `keep`, `shares`, `nearest`."""
    trial = np.empty(4)
    if n == 4 and tetrahedron_coefficients(points, trial):
        for i in range(4):
            keep[i] = i
            shares[i] = trial[i]
        nearest[:] = 0.0
        return 4
    gram = np.empty((4, 4))
    for i in range(n):
        for j in range(n):
            gram[i, j] = (
                points[i, 0] * points[j, 0]
                + points[i, 1] * points[j, 1]
                + points[i, 2] * points[j, 2]
            )
    best_sq = math.inf
    n_best = 0
    members = np.empty(4, dtype=np.int64)
    for mask in range(1, 1 << n):
        n_members = 0
        for i in range(n):
            if mask >> i & 1:
                members[n_members] = i
                n_members += 1
        if n_members > 3 or not face_coefficients(gram, members, n_members, trial):
            continue
        x = 0.0
        y = 0.0
        z = 0.0
        for i in range(n_members):
            x += trial[i] * points[members[i], 0]
            y += trial[i] * points[members[i], 1]
            z += trial[i] * points[members[i], 2]
        if x * x + y * y + z * z < best_sq:
            best_sq = x * x + y * y + z * z
            n_best = n_members
            nearest[0] = x
            nearest[1] = y
            nearest[2] = z
            for i in range(n_members):
                keep[i] = members[i]
                shares[i] = trial[i]
    return n_best


@kernel
def gjk(
    a: VertexGraph, b: VertexGraph, ia: int, ib: int, tolerance: float
) -> tuple[int, int, int, Integers, Integers, Floats, Floats]:
    """GJK from vertices `ia`, `ib`: a common point with its simplex, or the nearest points of both.

    Args:
        a, b: `VertexGraph`.
        tolerance: [m] a distance at or below it is contact.

    Returns: (status, iterations, n, (4,) indices of A, (4,) of B, (4,) coefficients, (3,) least point of
        A - B [m]); n is the number of simplex points that carry it.
    """
    vertices_a, vertices_b = a.vertices, b.vertices
    index_a = np.zeros(4, dtype=np.int64)
    index_b = np.zeros(4, dtype=np.int64)
    points = np.zeros((4, 3))
    keep = np.zeros(4, dtype=np.int64)
    shares = np.zeros(4)
    nearest = vertices_a[ia] - vertices_b[ib]
    index_a[0] = ia
    index_b[0] = ib
    points[0] = nearest
    shares[0] = 1.0
    n = 1
    for iteration in range(1, LIMIT + 1):
        gap_sq = nearest[0] ** 2 + nearest[1] ** 2 + nearest[2] ** 2
        if gap_sq <= tolerance * tolerance:
            return COMMON, iteration, n, index_a, index_b, shares, nearest
        x, y, z = nearest[0], nearest[1], nearest[2]
        ia = hill_climb(a, ia, -x, -y, -z)
        ib = hill_climb(b, ib, x, y, z)
        along = 0.0
        for i in range(3):
            along += nearest[i] * (vertices_a[ia, i] - vertices_b[ib, i])
        if along > 0.0 and gap_sq - along <= 1e-14 * gap_sq:
            return SEPARATED, iteration, n, index_a, index_b, shares, nearest
        for i in range(n):
            if index_a[i] == ia and index_b[i] == ib:
                status = SEPARATED if along > 0.0 else STALLED
                return status, iteration, n, index_a, index_b, shares, nearest
        index_a[n] = ia
        index_b[n] = ib
        points[n] = vertices_a[ia] - vertices_b[ib]
        before_sq = gap_sq
        n = least_point(points, n + 1, keep, shares, nearest)
        for i in range(n):
            index_a[i] = index_a[keep[i]]
            index_b[i] = index_b[keep[i]]
            points[i] = points[keep[i]]
        gap_sq = nearest[0] ** 2 + nearest[1] ** 2 + nearest[2] ** 2
        if gap_sq >= before_sq:
            status = SEPARATED if along > 0.0 else STALLED
            return status, iteration, n, index_a, index_b, shares, nearest
    return STALLED, LIMIT, n, index_a, index_b, shares, nearest

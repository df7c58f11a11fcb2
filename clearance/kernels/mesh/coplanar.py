"""Compiled steps of merging coplanar triangles: planes, groups, and half-edges removed one by one.

All decisions are exact signs (`expansion`). The surface is rings of half-edges: `tail` is the vertex where a
half-edge starts, `ahead` and `behind` link it into its face, `twin` is the same edge in the neighbour or -1.
Not for: which faces are merged, and in which order (room `geometry`).
"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from clearance.compile.declared import Flags, Floats2, Integers, Integers2
from clearance.compile.decorators import inline, kernel
from clearance.kernels.arithmetic.expansion import N_TERMS, orient2d, orient3d
from clearance.kernels.arithmetic.union_find import find_root

DEGENERATE = -1


class HalfEdges(NamedTuple):
    """The surface as rings of half-edges, (n,) each, see above; `face` is the face of each."""

    tail: Integers
    ahead: Integers
    behind: Integers
    twin: Integers
    face: Integers


class FacePlanes(NamedTuple):
    """The plane of each face, (m,) each.

    Attributes:
        group: equal for faces of one plane, below 0 for faces that are not merged.
        axes, signs: of `triangle_axes`.
    """

    group: Integers
    axes: Integers
    signs: Integers


@inline
def turn(vertices, i, j, k, axis, terms):
    """The exact sign of the turn i, j, k, projected along coordinate `axis`."""
    x = (axis + 1) % 3
    y = (axis + 2) % 3
    a, b, c = vertices[i], vertices[j], vertices[k]
    return orient2d(a[x], a[y], b[x], b[y], c[x], c[y], terms)


@inline
def _widest_axes(a, b, c):
    """The three axes, the one with the greatest normal component of triangle a, b, c first."""
    ux, uy, uz = b[0] - a[0], b[1] - a[1], b[2] - a[2]
    vx, vy, vz = c[0] - a[0], c[1] - a[1], c[2] - a[2]
    x, y, z = abs(uy * vz - uz * vy), abs(uz * vx - ux * vz), abs(ux * vy - uy * vx)
    if x >= y and x >= z:
        return 0, 1, 2
    return (1, 2, 0) if y >= z else (2, 0, 1)


@kernel
def triangle_axes(vertices: Floats2, triangles: Integers2) -> tuple[Integers, Integers]:
    """For each triangle an axis along which it has area and the exact sign of that area.

    Returns:
        (m,) axis 0, 1, 2, or `DEGENERATE` where the area is exactly zero; (m,) sign 1, -1, or 0.
    """
    terms = np.empty(N_TERMS)
    axes = np.full(len(triangles), DEGENERATE)
    signs = np.zeros(len(triangles), dtype=np.int64)
    for t in range(len(triangles)):
        i, j, k = triangles[t]
        for axis in _widest_axes(vertices[i], vertices[j], vertices[k]):
            sign = turn(vertices, i, j, k, axis, terms)
            if sign != 0:
                axes[t] = axis
                signs[t] = sign
                break
    return axes, signs


@kernel
def coplanar_twins(
    vertices: Floats2, triangles: Integers2, axes: Integers, signs: Integers, twin: Integers
) -> Flags:
    """(3m,) True where half-edge 3t + s and its twin lie in one plane exactly, and face the same way."""
    terms = np.empty(N_TERMS)
    flags = np.zeros(len(twin), dtype=np.bool_)
    for h in range(len(twin)):
        g = twin[h]
        t, other = h // 3, g // 3
        if g < h or axes[t] == DEGENERATE or axes[other] == DEGENERATE:
            continue
        i, j, k = triangles[t]
        apex = triangles[other, (g + 2) % 3]
        if orient3d(vertices[i], vertices[j], vertices[k], vertices[apex], terms) != 0:
            continue
        p, q, r = triangles[other]
        if turn(vertices, p, q, r, axes[t], terms) == signs[t]:
            flags[h] = True
            flags[g] = True
    return flags


@inline
def _is_between(vertices, u, v, w):
    """True if v, which is on the line u, w, lies strictly between u and w."""
    a, b, c = vertices[u], vertices[v], vertices[w]
    axis = 0
    for x in range(1, 3):
        if abs(c[x] - a[x]) > abs(c[axis] - a[axis]):
            axis = x
    return (a[axis] < b[axis] < c[axis]) or (a[axis] > b[axis] > c[axis])


@kernel
def straight_corners(vertices: Floats2, before: Integers, at: Integers, after: Integers) -> Flags:
    """(n,) True where `at` lies exactly on the straight line between `before` and `after`, strictly inside."""
    terms = np.empty(N_TERMS)
    flags = np.zeros(len(at), dtype=np.bool_)
    for i in range(len(at)):
        u, v, w = before[i], at[i], after[i]
        flags[i] = (
            turn(vertices, u, v, w, 0, terms) == 0
            and turn(vertices, u, v, w, 1, terms) == 0
            and turn(vertices, u, v, w, 2, terms) == 0
            and _is_between(vertices, u, v, w)
        )
    return flags


@inline
def _unlink(h, g, ahead, behind):
    """Removes the half-edges h and g = twin of h, so that their two rings become one."""
    ahead[behind[h]] = ahead[g]
    behind[ahead[g]] = behind[h]
    ahead[behind[g]] = ahead[h]
    behind[ahead[h]] = behind[g]


@inline
def _stays_convex(vertices, u, v, w, axis, sign, terms):
    """True if the corner u, v, w, whose angle is a sum of two of at most pi, is at most pi."""
    bend = turn(vertices, u, v, w, axis, terms) * sign
    return bend > 0 or (bend == 0 and _is_between(vertices, u, v, w))


@kernel
def absorb_needles(vertices: Floats2, half_edges: HalfEdges, axes: Integers, parents: Integers):
    """Gives the corner of each zero-area triangle to the proper face across its longest edge.

    Changes `ahead`, `behind`, `parents` (face joined into face) and `twin` (-2 for a removed edge) in
    place. The face keeps its points: the corner lies exactly on its edge.
    """
    tail, twin, face = half_edges.tail, half_edges.twin, half_edges.face
    ahead, behind = half_edges.ahead, half_edges.behind
    changed = True
    while changed:
        changed = False
        for h in range(len(tail)):
            g = twin[h]
            if g < 0 or axes[face[h]] != DEGENERATE or find_root(parents, face[h]) != face[h]:
                continue
            host = find_root(parents, face[g])
            u, w, v = tail[h], tail[ahead[h]], tail[behind[h]]
            if axes[host] == DEGENERATE or not _is_between(vertices, u, v, w):
                continue
            _unlink(h, g, ahead, behind)
            twin[h] = -2
            twin[g] = -2
            parents[face[h]] = host
            changed = True


@kernel
def merge_rings(
    vertices: Floats2, order: Integers, half_edges: HalfEdges, planes: FacePlanes, parents: Integers
):
    """Removes, in `order`, each edge between two faces of one plane whose union is convex.

    Args:
        order: (k,) half-edges, one of each pair. planes: `FacePlanes`.
        parents: (m,) union-find over faces, changed in place as are `ahead`, `behind` and `twin`.

    Source: Hertel and Mehlhorn, Fast triangulation of simple polygons, 1983 (their test at each end).
    """
    tail, twin, face = half_edges.tail, half_edges.twin, half_edges.face
    ahead, behind = half_edges.ahead, half_edges.behind
    group, axes, signs = planes.group, planes.axes, planes.signs
    terms = np.empty(N_TERMS)
    for h in order:
        g = twin[h]
        if g < 0 or group[face[h]] != group[face[g]] or group[face[h]] < 0:
            continue
        a = find_root(parents, face[h])
        b = find_root(parents, face[g])
        if a == b:
            continue
        axis, sign = axes[a], signs[a]
        u, v, w = tail[behind[h]], tail[h], tail[ahead[ahead[g]]]
        if not _stays_convex(vertices, u, v, w, axis, sign, terms):
            continue
        u, v, w = tail[behind[g]], tail[g], tail[ahead[ahead[h]]]
        if not _stays_convex(vertices, u, v, w, axis, sign, terms):
            continue
        _unlink(h, g, ahead, behind)
        twin[h] = -2
        twin[g] = -2
        parents[max(a, b)] = min(a, b)


@kernel
def rings(
    half_edges: HalfEdges, parents: Integers, n_faces: int
) -> tuple[Integers, Integers, Integers]:
    """The remaining faces, as (starts, flat vertices, index of the first face merged into each)."""
    tail, ahead, twin, face = half_edges.tail, half_edges.ahead, half_edges.twin, half_edges.face
    starts = np.zeros(n_faces + 1, dtype=np.int64)
    flat = np.empty(len(tail), dtype=np.int64)
    label = np.empty(n_faces, dtype=np.int64)
    seen = np.zeros(len(tail), dtype=np.bool_)
    n_rings = 0
    n_flat = 0
    for first in range(len(tail)):
        if seen[first] or twin[first] == -2:
            continue
        h = first
        while not seen[h]:
            seen[h] = True
            flat[n_flat] = tail[h]
            n_flat += 1
            h = ahead[h]
        label[n_rings] = find_root(parents, face[first])
        n_rings += 1
        starts[n_rings] = n_flat
    return starts[: n_rings + 1], flat[:n_flat], label[:n_rings]

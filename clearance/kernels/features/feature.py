"""Names of feature pairs of two faces, and their corners: a few integers that a search can store."""

from typing import NamedTuple

from clearance.compile.decorators import inline
from clearance.kernels.arithmetic.vec3 import cross, dot, move, move_back, row, sub
from clearance.kernels.features.face_pair import (
    CORNER_EDGE,
    CORNER_FACE,
    EDGE_CORNER,
    EDGES,
    FACE_CORNER,
)
from clearance.kernels.features.wide_features import Simplex


class Feature(NamedTuple):
    """A corner, a segment or a triangle of the fan of each of two faces.

    Attributes:
        n_a, n_b: their numbers of corners.
        i, j: the vertex, the number of the segment (see `segment`), or the middle corner of the triangle as
            an index into `face_vertices`.
    """

    n_a: int
    i: int
    n_b: int
    j: int


@inline
def n_segments(surface, face):
    """Edges that a face owns, and the diagonals of its fan if it is bent."""
    return surface.edge_starts[face + 1] - surface.edge_starts[face]


@inline
def segment(surface, face, s):
    """The two vertices of segment `s` of a face: owned edges, then diagonals."""
    at = surface.edge_starts[face] + s
    return surface.owned_edges[at, 0], surface.owned_edges[at, 1]


@inline
def simplex(surface, face, n, i):
    """The corners of a feature of a face."""
    u = v = w = i
    if n == 2:
        u, v = segment(surface, face, i)
        w = v
    elif n == 3:
        u = surface.face_vertices[surface.face_starts[face]]
        v, w = surface.face_vertices[i], surface.face_vertices[i + 1]
    return Simplex(n, row(surface.exact, u), row(surface.exact, v), row(surface.exact, w))


@inline
def _middle_under(surface, face, y):
    """The middle corner of the fan's triangle in which the foot of `y` (body frame) lies, for rounding."""
    start, end = surface.face_starts[face], surface.face_starts[face + 1]
    n = row(surface.normals, face)
    first = row(surface.vertices, surface.face_vertices[start])
    to_y = sub(y, first)
    k = start + 1
    while k + 2 < end:
        diagonal = sub(row(surface.vertices, surface.face_vertices[k + 1]), first)
        if not dot(cross(diagonal, to_y), n) > 0.0:
            break
        k += 1
    return k


@inline
def nearest_feature(a, face_a, b, face_b, m, seen):
    """The feature pair that the search in doubles found the nearest."""
    n_a, i, n_b, j = 1, seen.i, 1, seen.j
    if seen.kind == CORNER_FACE:
        n_b, j = 3, b.face_starts[face_b] + 1
        if b.face_starts[face_b + 1] > j + 2:
            j = _middle_under(b, face_b, move_back(m, row(a.vertices, i)))
    elif seen.kind == FACE_CORNER:
        n_a, i = 3, a.face_starts[face_a] + 1
        if a.face_starts[face_a + 1] > i + 2:
            i = _middle_under(a, face_a, move(m, row(b.vertices, j)))
    if seen.kind in (CORNER_EDGE, EDGES):
        n_b, j = 2, j - b.edge_starts[face_b]
    if seen.kind in (EDGE_CORNER, EDGES):
        n_a, i = 2, i - a.edge_starts[face_a]
    return Feature(n_a, i, n_b, j)

"""The nearest features of two faces in doubles: a filter that passes everything that could be the minimum.

A vertex and a face, a vertex and an edge, or two edges attain the minimum of two polygons. Each of these is a
candidate here, over the features that the two faces own. Not for: the answer itself
(`refine`), contact (`predicates`), and which face pairs to measure (`descent`).
"""

import math
from typing import NamedTuple

import numpy as np

from clearance.compile.decorators import inline
from clearance.kernels.arithmetic.vec3 import Vec3, along, dot, gap_sq, move, move_back, row, sub
from clearance.kernels.features.bounds import lower_bound_faces_outward
from clearance.kernels.features.segments import LOOSE, common_perpendicular, foot_inside
from clearance.kernels.mesh.surface import ANYTHING, LISTED

ROUGH = 2.0**-44
"""Relative error of a height over a face whose corners are all blunt; it grows as 1 / angle^2: the normal is
off by 16 u / angle, and a foot next to a corner by that over the angle."""

LEANING = 2.0**-6
"""Difference of two unit vectors, within which a face pair is known to be nearest at features of others."""

OWN_DIRECTION = 0.5 * LEANING * LEANING
"""The bound of a face pair may be low by this share of the least distance for that."""

CLEARLY = 1.0 + 2.0**-26
"""If rounding makes a distance more uncertain than that, all faces are measured: other features may be as near,
and `error_bound` would depend on whether they were seen."""


class Hit(NamedTuple):
    """A pair of points, both in the frame of body a; in an answer in the world.

    Attributes:
        gap_sq: [m^2] an upper bound on the squared distance, apart from the margin of rounding; in an
            answer the square of the distance.
    """

    gap_sq: float
    face_a: int
    face_b: int
    p: Vec3
    q: Vec3


@inline
def nothing_yet(limit_sq):
    """The hit that any pair of points within the limit beats."""
    nowhere = Vec3(0.0, 0.0, 0.0)
    return Hit(limit_sq, 2**62, 2**62, nowhere, nowhere)


@inline
def write_points(hit, points):
    """Fills `points` (2, 3) with those of a hit."""
    for axis in range(3):
        points[0, axis], points[1, axis] = hit.p[axis], hit.q[axis]


CORNERS, CORNER_FACE, FACE_CORNER, CORNER_EDGE, EDGE_CORNER, EDGES, UNSEEN = range(7)
"""Kinds of feature pairs, the feature of a first; the last one: none was seen."""


class FeatureCandidate(NamedTuple):
    """The nearest features seen of a face pair that could be the minimum.

    Attributes:
        near_sq: [m^2] their squared distance.
        kind, i, j: the kind, and indices of vertices or of owned edges; not used for a face.
    """

    near_sq: float
    kind: int
    i: int
    j: int


NOTHING_SEEN = FeatureCandidate(math.inf, UNSEEN, 0, 0)


class FacePairState(NamedTuple):
    """The best pair so far, and the nearest features of the current face pair."""

    best: Hit
    seen: FeatureCandidate


@inline(force=True)
def limit_of(a, face_a, b, face_b, best_gap, margin):
    """[m] the greatest distance in doubles that a feature pair of two faces may have and still win."""
    blunt_a, blunt_b = a.blunt[face_a], b.blunt[face_b]
    rough = ROUGH * (blunt_a * blunt_a + blunt_b * blunt_b)
    return (
        best_gap * (1.0 + rough)
        + margin * (2.0 + blunt_a + blunt_b)
        + 2.0 * (a.width[face_a] + b.width[face_b])
    )


@inline(force=True)
def with_candidate(near, hit, candidate):
    """`near` with one more pair of points and of features, which are within the limit."""
    best, seen = near.best, near.seen
    if hit.gap_sq < best.gap_sq:
        best = hit
    if candidate.near_sq < seen.near_sq:
        seen = candidate
    return FacePairState(best, seen)


@inline(force=True)
def with_candidate_within(near, limit_sq, hit, kind, i, j):
    """`near` with one more pair of points, of features `i` and `j`, if it is within the limit."""
    if hit.gap_sq <= limit_sq:
        near = with_candidate(near, hit, FeatureCandidate(hit.gap_sq, kind, i, j))
    return near


@inline(force=True)
def is_over(surface, face, x):
    """True if the foot of `x` on the plane of `face` lies in the face (body frame)."""
    for c in range(surface.face_starts[face], surface.face_starts[face + 1]):
        outward = row(surface.corner_normals, c)
        if dot(outward, sub(x, row(surface.vertices, surface.face_vertices[c]))) > 0.0:
            return False
    return True


@inline(force=True)
def may_be_over(surface, face, x, margin):
    """True unless the foot of `x` is outside the face by more than rounding."""
    tolerance = margin * surface.blunt[face] + surface.width[face]
    for c in range(surface.face_starts[face], surface.face_starts[face + 1]):
        outward = row(surface.corner_normals, c)
        d = sub(x, row(surface.vertices, surface.face_vertices[c]))
        if dot(outward, d) > LOOSE * (abs(d.x) + abs(d.y) + abs(d.z)) + tolerance:
            return False
    return True


@inline(force=True)
def height(surface, face, x):
    """The signed height of `x` over the plane of `face` (body frame)."""
    first = row(surface.vertices, surface.face_vertices[surface.face_starts[face]])
    return dot(row(surface.normals, face), sub(x, first))


@inline(force=True)
def has_plane(surface, face):
    """True if the face has a normal that is more than rounding."""
    n = row(surface.normals, face)
    return n.x != 0.0 or n.y != 0.0 or n.z != 0.0


@inline(force=True)
def _upper_sq(surface, face, h, margin):
    """An upper bound on the squared distance of a point at height `h` over the face."""
    blunt = surface.blunt[face]
    upper = abs(h) * (1.0 + ROUGH * blunt * blunt) + margin * blunt + surface.width[face]
    return upper * upper


@inline
def vertices_to_face(a, face_a, b, face_b, m, limit_sq, margin, near):
    """`near` with the vertices owned by `face_a` against the inside of `face_b`."""
    if has_plane(b, face_b):
        for k in range(a.vertex_starts[face_a], a.vertex_starts[face_a + 1]):
            i = a.owned_vertices[k]
            p = row(a.vertices, i)
            x = move_back(m, p)
            h = height(b, face_b, x)
            if h * h <= limit_sq and is_over(b, face_b, x):
                q = move(m, along(x, -h, row(b.normals, face_b)))
                upper_sq = _upper_sq(b, face_b, h, margin)
                hit = Hit(upper_sq, face_a, face_b, p, q)
                near = with_candidate(near, hit, FeatureCandidate(h * h, CORNER_FACE, i, 0))
    return near


@inline
def face_to_vertices(a, face_a, b, face_b, m, limit_sq, margin, near):
    """`near` with the inside and the owned edges of `face_a` against vertices owned by `face_b`."""
    flat = has_plane(a, face_a)
    for k in range(b.vertex_starts[face_b], b.vertex_starts[face_b + 1]):
        j = b.owned_vertices[k]
        q = move(m, row(b.vertices, j))
        if flat:
            h = height(a, face_a, q)
            if h * h <= limit_sq and is_over(a, face_a, q):
                p = along(q, -h, row(a.normals, face_a))
                upper_sq = _upper_sq(a, face_a, h, margin)
                hit = Hit(upper_sq, face_a, face_b, p, q)
                near = with_candidate(near, hit, FeatureCandidate(h * h, FACE_CORNER, 0, j))
        for e in range(a.edge_starts[face_a], a.edge_starts[face_a + 1]):
            p0 = row(a.vertices, a.owned_edges[e, 0])
            p1 = row(a.vertices, a.owned_edges[e, 1])
            inside, p = foot_inside(q, p0, p1)
            if inside:
                hit = Hit(gap_sq(p, q), face_a, face_b, p, q)
                near = with_candidate_within(near, limit_sq, hit, EDGE_CORNER, e, j)
    return near


@inline
def edges_to_edges(a, face_a, b, face_b, m, limit_sq, margin, near):
    """`near` with the owned vertices and edges of `face_a` against owned edges of `face_b`.

    Edges that the direction `d` of the best points so far separates are not measured; on faces with many corners
    these are most. Without such points `d` is zero and separates nothing.
    """
    d = sub(near.best.q, near.best.p)
    reach = (math.sqrt(min(limit_sq, near.seen.near_sq)) + margin) * math.sqrt(dot(d, d))
    top = -math.inf
    for c in range(a.face_starts[face_a], a.face_starts[face_a + 1]):
        top = max(top, dot(d, row(a.vertices, a.face_vertices[c])))
    for e in range(b.edge_starts[face_b], b.edge_starts[face_b + 1]):
        q0 = move(m, row(b.vertices, b.owned_edges[e, 0]))
        q1 = move(m, row(b.vertices, b.owned_edges[e, 1]))
        near_end = min(dot(d, q0), dot(d, q1)) - reach
        if near_end > top:
            continue
        for k in range(a.vertex_starts[face_a], a.vertex_starts[face_a + 1]):
            i = a.owned_vertices[k]
            p = row(a.vertices, i)
            inside, q = foot_inside(p, q0, q1)
            if inside:
                hit = Hit(gap_sq(p, q), face_a, face_b, p, q)
                near = with_candidate_within(near, limit_sq, hit, CORNER_EDGE, i, e)
        for i in range(a.edge_starts[face_a], a.edge_starts[face_a + 1]):
            p0 = row(a.vertices, a.owned_edges[i, 0])
            p1 = row(a.vertices, a.owned_edges[i, 1])
            if near_end > max(dot(d, p0), dot(d, p1)):
                continue
            inside, p, q = common_perpendicular(p0, p1, q0, q1, margin)
            if inside:
                hit = Hit(gap_sq(p, q), face_a, face_b, p, q)
                near = with_candidate_within(near, limit_sq, hit, EDGES, i, e)
    return near


@inline
def vertices_to_vertices(a, face_a, b, face_b, m, limit_sq, near):
    """`near` with owned vertices against owned vertices."""
    for n in range(b.vertex_starts[face_b], b.vertex_starts[face_b + 1]):
        j = b.owned_vertices[n]
        q = move(m, row(b.vertices, j))
        for k in range(a.vertex_starts[face_a], a.vertex_starts[face_a + 1]):
            i = a.owned_vertices[k]
            p = row(a.vertices, i)
            hit = Hit(gap_sq(p, q), face_a, face_b, p, q)
            near = with_candidate_within(near, limit_sq, hit, CORNERS, i, j)
    return near


@inline(force=True)
def nearest_of_faces(a, face_a, b, face_b, m, margin, best):
    """The best pair of points, and the nearest that two faces come if it could be the minimum, else infinity.

    Args:
        m: `a_from_b`.
        margin: [m] rounding of a distance between two points of the bodies.
    """
    limit = limit_of(a, face_a, b, face_b, math.sqrt(best.gap_sq), margin)
    limit_sq = limit * limit
    near = FacePairState(best, NOTHING_SEEN)
    near = vertices_to_vertices(a, face_a, b, face_b, m, limit_sq, near)
    near = vertices_to_face(a, face_a, b, face_b, m, limit_sq, margin, near)
    near = face_to_vertices(a, face_a, b, face_b, m, limit_sq, margin, near)
    return edges_to_edges(a, face_a, b, face_b, m, limit_sq, margin, near)


@inline(force=True)
def _may_own_farthest(surface, face, u, depth):
    """False if a face owns none of its farthest features along any direction within `LEANING` of `u`.

    A corner, an edge or the whole face is farthest. Its corners are as high as the highest one, within the leaning
    and `depth` [m] of rounding.
    """
    owns = np.int64(surface.owns[face])
    if owns == ANYTHING:
        return True
    first, end = surface.face_starts[face], surface.face_starts[face + 1]
    height_of_top = -math.inf
    top = u
    for c in range(first, end):
        x = row(surface.vertices, surface.face_vertices[c])
        h = dot(u, x)
        if h > height_of_top:
            top, height_of_top = x, h
    high = 0
    for c in range(first, end):
        below = sub(top, row(surface.vertices, surface.face_vertices[c]))
        if dot(u, below) <= LEANING * (abs(below.x) + abs(below.y) + abs(below.z)) + depth:
            high |= 1 << (c - first)
    edges = high & (high >> 1 | high << (end - first - 1))
    if (owns & high) | (owns >> LISTED & edges):
        return True
    but_one = high & (high - 1)
    return but_one != 0 and (edges == 0 or but_one & (but_one - 1) != 0)


@inline(force=True)
def may_own_nearest(a, face_a, b, face_b, direction, along_direction, best_gap, margin):
    """False if two faces, should they be the nearest of all, are nearest at features that other faces own.

    Args:
        along_direction: [m] the bound of the faces along `direction`. Where it is within `OWN_DIRECTION` of the
            least distance, the nearest points lie within `LEANING` of that direction.
    """
    limit = limit_of(a, face_a, b, face_b, best_gap, margin)
    if along_direction < (1.0 - OWN_DIRECTION) * limit or limit > CLEARLY * best_gap:
        return True
    v = direction.v
    return _may_own_farthest(a, face_a, direction.u, limit - along_direction) and _may_own_farthest(
        b, face_b, Vec3(-v.x, -v.y, -v.z), limit - along_direction
    )


@inline(force=True)
def may_meet(a, face_a, b, face_b, m, margin):
    """False only if two faces are clearly separate along `direction_outward`."""
    return lower_bound_faces_outward(a, face_a, b, face_b, m) <= margin

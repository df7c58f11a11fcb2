"""The exact distance of two convex faces over the features they own, and whether they cross.

The minimum of two polygons is attained by a vertex and a face, a vertex and an edge, or two edges inside
both; each is a candidate here, none is left out, and each candidate is a pair of points of the two faces,
so that no answer is below the truth by more than rounding. Not for: which face pairs to ask (`descent`).
"""

from typing import NamedTuple

from clearance.jit import inlined
from clearance.kernels.segments import common_perpendicular, nearest_on_segment
from clearance.kernels.vec3 import Vec3, along, dot, gap_sq, move, move_back, row, sub


class Hit(NamedTuple):
    """The best pair of points so far, both in the frame of body a."""

    gap_sq: float
    face_a: int
    face_b: int
    p: Vec3
    q: Vec3


@inlined
def is_better(found_sq, face_a, face_b, best):
    """True if a candidate beats `best`: by distance, then by least face indices."""
    if found_sq != best.gap_sq:
        return found_sq < best.gap_sq
    return face_a < best.face_a or (face_a == best.face_a and face_b < best.face_b)


@inlined
def is_over(surface, face, x):
    """True if the foot of `x` on the plane of `face` lies in the face (body frame)."""
    for c in range(surface.face_starts[face], surface.face_starts[face + 1]):
        outward = row(surface.corner_normals, c)
        if dot(outward, sub(x, row(surface.vertices, surface.face_vertices[c]))) > 0.0:
            return False
    return True


@inlined
def height(surface, face, x):
    """The signed height of `x` over the plane of `face` (body frame)."""
    first = row(surface.vertices, surface.face_vertices[surface.face_starts[face]])
    return dot(row(surface.normals, face), sub(x, first))


@inlined
def has_area(surface, face):
    """True if the face has a normal."""
    n = row(surface.normals, face)
    return n.x != 0.0 or n.y != 0.0 or n.z != 0.0


@inlined
def crossing(surface, face, x0, x1):
    """(crosses, point): where the segment x0 x1 meets the face (body frame)."""
    h0 = height(surface, face, x0)
    h1 = height(surface, face, x1)
    if (h0 > 0.0 and h1 > 0.0) or (h0 < 0.0 and h1 < 0.0) or h0 == h1:
        return False, x0
    x = along(x0, h0 / (h0 - h1), sub(x1, x0))
    return is_over(surface, face, x), x


@inlined
def faces_cross(a, face_a, b, face_b, m, best):
    """`best`, or a hit of distance 0 where an edge owned by one face meets the other face."""
    if has_area(b, face_b):
        for e in range(a.edge_starts[face_a], a.edge_starts[face_a + 1]):
            x0 = move_back(m, row(a.vertices, a.owned_edges[e, 0]))
            x1 = move_back(m, row(a.vertices, a.owned_edges[e, 1]))
            crosses, x = crossing(b, face_b, x0, x1)
            if crosses:
                common = move(m, x)
                return Hit(0.0, face_a, face_b, common, common)
    if has_area(a, face_a):
        for e in range(b.edge_starts[face_b], b.edge_starts[face_b + 1]):
            x0 = move(m, row(b.vertices, b.owned_edges[e, 0]))
            x1 = move(m, row(b.vertices, b.owned_edges[e, 1]))
            crosses, x = crossing(a, face_a, x0, x1)
            if crosses:
                return Hit(0.0, face_a, face_b, x, x)
    return best


@inlined
def vertices_to_face(a, face_a, b, face_b, m, best):
    """`best`, or better: vertices owned by `face_a` against the inside of `face_b`."""
    if has_area(b, face_b):
        for i in range(a.vertex_starts[face_a], a.vertex_starts[face_a + 1]):
            p = row(a.vertices, a.owned_vertices[i])
            x = move_back(m, p)
            h = height(b, face_b, x)
            if is_better(h * h, face_a, face_b, best) and is_over(b, face_b, x):
                q = move(m, along(x, -h, row(b.normals, face_b)))
                best = Hit(h * h, face_a, face_b, p, q)
    return best


@inlined
def face_to_vertices(a, face_a, b, face_b, m, best):
    """`best`, or better: the inside and the owned edges of `face_a` against vertices owned by `face_b`."""
    flat = has_area(a, face_a)
    for i in range(b.vertex_starts[face_b], b.vertex_starts[face_b + 1]):
        q = move(m, row(b.vertices, b.owned_vertices[i]))
        if flat:
            h = height(a, face_a, q)
            if is_better(h * h, face_a, face_b, best) and is_over(a, face_a, q):
                best = Hit(h * h, face_a, face_b, along(q, -h, row(a.normals, face_a)), q)
        for e in range(a.edge_starts[face_a], a.edge_starts[face_a + 1]):
            p0 = row(a.vertices, a.owned_edges[e, 0])
            p1 = row(a.vertices, a.owned_edges[e, 1])
            p = nearest_on_segment(q, p0, p1)
            found_sq = gap_sq(p, q)
            if is_better(found_sq, face_a, face_b, best):
                best = Hit(found_sq, face_a, face_b, p, q)
    return best


@inlined
def edges_to_edges(a, face_a, b, face_b, m, best):
    """`best`, or better: owned vertices and edges of `face_a` against owned edges of `face_b`."""
    for k in range(b.edge_starts[face_b], b.edge_starts[face_b + 1]):
        q0 = move(m, row(b.vertices, b.owned_edges[k, 0]))
        q1 = move(m, row(b.vertices, b.owned_edges[k, 1]))
        for i in range(a.vertex_starts[face_a], a.vertex_starts[face_a + 1]):
            p = row(a.vertices, a.owned_vertices[i])
            q = nearest_on_segment(p, q0, q1)
            found_sq = gap_sq(p, q)
            if is_better(found_sq, face_a, face_b, best):
                best = Hit(found_sq, face_a, face_b, p, q)
        for e in range(a.edge_starts[face_a], a.edge_starts[face_a + 1]):
            p0 = row(a.vertices, a.owned_edges[e, 0])
            p1 = row(a.vertices, a.owned_edges[e, 1])
            inside, p, q = common_perpendicular(p0, p1, q0, q1)
            if inside:
                found_sq = gap_sq(p, q)
                if is_better(found_sq, face_a, face_b, best):
                    best = Hit(found_sq, face_a, face_b, p, q)
    return best


@inlined
def nearest_of_faces(a, face_a, b, face_b, m, may_cross, best):
    """`best`, or the pair of points of the two faces that beats it.

    Args:
        m: `a_from_b`.
        may_cross: False where a positive lower bound on the distance is already known.
    """
    if may_cross:
        best = faces_cross(a, face_a, b, face_b, m, best)
        if best.gap_sq == 0.0:
            return best
    best = vertices_to_face(a, face_a, b, face_b, m, best)
    best = face_to_vertices(a, face_a, b, face_b, m, best)
    return edges_to_edges(a, face_a, b, face_b, m, best)

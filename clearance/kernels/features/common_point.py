"""Where two faces that have a point in common come nearest to coinciding in double-double: witness points.

Not for: whether they meet (`predicates`).
"""

from typing import NamedTuple

from clearance.compile.decorators import inline, kernel
from clearance.kernels.arithmetic.double_double import (
    Wide3,
    along3,
    cross3,
    dot3,
    less,
    minus,
    minus3,
    over,
    point_of_a,
    point_of_b,
)
from clearance.kernels.arithmetic.vec3 import row
from clearance.kernels.features.meeting import Meeting
from clearance.kernels.features.posed_pair import PosedPair
from clearance.kernels.features.wide_features import point_and_triangle, two_segments


class CommonPointPair(NamedTuple):
    """A point of each of two faces, in the orientation of the world, from the origin of a."""

    p: Wide3
    q: Wide3


@inline
def _of_edge_and_triangle(p, q, x, y, z):
    """The points of an edge p q and a triangle x y z nearest to coinciding."""
    n = cross3(minus3(y, x), minus3(z, x))
    h = dot3(n, minus3(p, x))
    drop = minus(h, dot3(n, minus3(q, x)))
    t = p
    if drop.hi != 0.0:
        s = over(h, drop)
        if 0.0 < s.hi <= 1.0:
            t = along3(p, s, minus3(q, p))
    best = point_and_triangle(t, x, y, z)
    for _ in range(3):
        found = two_segments(p, q, x, y)
        if less(found.gap_sq, best.gap_sq):
            best = found
        x, y, z = y, z, x
    return CommonPointPair(best.p, best.q)


@kernel
def common_point(faces: PosedPair, found: Meeting) -> CommonPointPair:
    """The points of two faces nearest to coinciding, where an edge was found to meet a triangle."""
    a, b = faces.surface_a, faces.surface_b
    frames = faces.frames
    if found.edge_of_a:
        p = point_of_a(frames, row(a.exact, a.face_vertices[found.p]))
        q = point_of_a(frames, row(a.exact, a.face_vertices[found.q]))
        x = point_of_b(frames, row(b.exact, b.face_vertices[b.face_starts[faces.b]]))
        y = point_of_b(frames, row(b.exact, b.face_vertices[found.k]))
        z = point_of_b(frames, row(b.exact, b.face_vertices[found.k + 1]))
        return _of_edge_and_triangle(p, q, x, y, z)
    p = point_of_b(frames, row(b.exact, b.face_vertices[found.p]))
    q = point_of_b(frames, row(b.exact, b.face_vertices[found.q]))
    x = point_of_a(frames, row(a.exact, a.face_vertices[a.face_starts[faces.a]]))
    y = point_of_a(frames, row(a.exact, a.face_vertices[found.k]))
    z = point_of_a(frames, row(a.exact, a.face_vertices[found.k + 1]))
    common = _of_edge_and_triangle(p, q, x, y, z)
    return CommonPointPair(common.q, common.p)

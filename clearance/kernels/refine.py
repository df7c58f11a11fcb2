"""The answer of a query: the features that could be the minimum, measured again in wide numbers.

Vertices and poses are taken exactly as given. The search (`descent`) names the face pairs; here each of
their features within the limit is measured to some 30 digits, the least wins, ties go to the least faces,
and a lower bound along the connecting line tells how far the answer can be above the truth.
"""

import math
from typing import NamedTuple

from clearance.jit import kernel, merged
from clearance.kernels.double_double import (
    NOISE,
    Wide,
    Wide3,
    along3,
    dot3,
    less,
    minus,
    minus3,
    over,
    plus,
    point_of_a,
    point_of_b,
    root,
    rounded,
    size,
    wide,
)
from clearance.kernels.face_pair import has_plane, height, limit_of, may_be_over
from clearance.kernels.segments import may_be_inside, may_be_inside_both, nearest_on_segment
from clearance.kernels.vec3 import dot, gap_sq, move, move_back, row, sub, turn
from clearance.kernels.wide_features import (
    across,
    across_both,
    toward,
    wide_between_segments,
    wide_gap_sq,
    wide_normal,
    wide_on_segment,
    wide_on_triangle,
    wide_over_triangle,
)

CLOSE = 64.0 * 2.0**-53
"""Rounding of a plain share, relative to the sizes of direction and corner: 12 operations, with room."""


class Refined(NamedTuple):
    """The best pair of points so far, in the orientation of the world, from the origin of a.

    Attributes:
        w: the direction from p to q, of any length, right to the last digits also where p and q nearly meet.
        floor: [m] a lower bound on the distance of all face pairs refined so far.
    """

    gap_sq: Wide
    face_a: int
    face_b: int
    p: Wide3
    q: Wide3
    w: Wide3
    floor: Wide


class Ask(NamedTuple):
    """What features have to be measured.

    Attributes:
        limit, margin: [m] as in `face_pair`.
    """

    limit: float
    margin: float


@merged
def nothing_refined():
    """What any pair of points beats."""
    zero = wide(0.0)
    nowhere = Wide3(zero, zero, zero)
    return Refined(wide(math.inf), 2**62, 2**62, nowhere, nowhere, nowhere, wide(math.inf))


@merged
def _wins(found_sq, face_a, face_b, best):
    """True where a new pair is nearer, or as near with lesser faces."""
    if less(best.gap_sq, found_sq):
        return False
    if less(found_sq, best.gap_sq):
        return True
    return face_a < best.face_a or (face_a == best.face_a and face_b < best.face_b)


@merged
def _n_segments(surface, face):
    """Edges that a face owns, and the diagonals of its fan if it is bent."""
    owned = surface.edge_starts[face + 1] - surface.edge_starts[face]
    if surface.bent[face]:
        return owned + surface.face_starts[face + 1] - surface.face_starts[face] - 3
    return owned


@merged
def _segment(surface, face, k):
    """The two vertices of segment `k` of a face."""
    first = surface.edge_starts[face]
    if first + k < surface.edge_starts[face + 1]:
        return surface.owned_edges[first + k, 0], surface.owned_edges[first + k, 1]
    start = surface.face_starts[face]
    corner = start + 2 + k - (surface.edge_starts[face + 1] - first)
    return surface.face_vertices[start], surface.face_vertices[corner]


@merged
def _vertex_pairs(a, face_a, b, face_b, frames, ask, best):
    for k in range(b.vertex_starts[face_b], b.vertex_starts[face_b + 1]):
        j = b.owned_vertices[k]
        y = move(frames.m, row(b.vertices, j))
        for i in range(a.vertex_starts[face_a], a.vertex_starts[face_a + 1]):
            at = a.owned_vertices[i]
            if gap_sq(row(a.vertices, at), y) <= ask.limit * ask.limit:
                p = point_of_a(frames, row(a.exact, at))
                q = point_of_b(frames, row(b.exact, j))
                found_sq = wide_gap_sq(p, q)
                if _wins(found_sq, face_a, face_b, best):
                    best = Refined(found_sq, face_a, face_b, p, q, minus3(q, p), best.floor)
    return best


@merged
def _placed(frames, v, is_a):
    return point_of_a(frames, v) if is_a else point_of_b(frames, v)


@merged
def _swapped(is_first, x, y):
    """(x, y) or (y, x)."""
    return (x, y) if is_first else (y, x)


@merged
def _vertices_over(one, face_one, two, face_two, frames, is_a, ask, face_a, face_b, best):
    """`best` with the vertices owned by one face against the triangles of the other's fan."""
    first = two.face_starts[face_two]
    flat = has_plane(two, face_two)
    for i in range(one.vertex_starts[face_one], one.vertex_starts[face_one + 1]):
        at = one.owned_vertices[i]
        v = row(one.vertices, at)
        if flat:
            y = move_back(frames.m, v) if is_a else move(frames.m, v)
            if abs(height(two, face_two, y)) > ask.limit:
                continue
            if not may_be_over(two, face_two, y, ask.margin):
                continue
        x = _placed(frames, row(one.exact, at), is_a)
        u = _placed(frames, row(two.exact, two.face_vertices[first]), not is_a)
        for c in range(first + 1, two.face_starts[face_two + 1] - 1):
            v = _placed(frames, row(two.exact, two.face_vertices[c]), not is_a)
            w = _placed(frames, row(two.exact, two.face_vertices[c + 1]), not is_a)
            n = wide_normal(u, v, w)
            inside, foot = wide_over_triangle(x, u, v, w, n)
            if inside:
                found_sq = wide_gap_sq(x, foot)
                if _wins(found_sq, face_a, face_b, best):
                    p, q = _swapped(is_a, x, foot)
                    n = toward(n, minus3(q, p))
                    best = Refined(found_sq, face_a, face_b, p, q, n, best.floor)
    return best


@merged
def _vertices_and_segments(one, face_one, two, face_two, frames, is_a, ask, face_a, face_b, best):
    """`best` with the vertices owned by one face against the segments of the other."""
    for i in range(one.vertex_starts[face_one], one.vertex_starts[face_one + 1]):
        at = one.owned_vertices[i]
        y = row(one.vertices, at)
        y = move_back(frames.m, y) if is_a else move(frames.m, y)
        for k in range(_n_segments(two, face_two)):
            s, e = _segment(two, face_two, k)
            start, end = row(two.vertices, s), row(two.vertices, e)
            if not may_be_inside(y, start, end, ask.margin):
                continue
            if gap_sq(y, nearest_on_segment(y, start, end)) > ask.limit * ask.limit:
                continue
            x = _placed(frames, row(one.exact, at), is_a)
            u = _placed(frames, row(two.exact, s), not is_a)
            v = _placed(frames, row(two.exact, e), not is_a)
            foot = wide_on_segment(x, u, v)
            found_sq = wide_gap_sq(x, foot)
            if _wins(found_sq, face_a, face_b, best):
                p, q = _swapped(is_a, x, foot)
                w = across(minus3(q, p), u, v)
                best = Refined(found_sq, face_a, face_b, p, q, w, best.floor)
    return best


@merged
def _far_apart(p0, p1, q0, q1, limit):
    """True if two segments are clearly farther apart than a limit, by the plane between their middles."""
    u, v = sub(p1, p0), sub(q1, q0)
    x = 0.5 * ((q0.x + q1.x) - (p0.x + p1.x))
    y = 0.5 * ((q0.y + q1.y) - (p0.y + p1.y))
    z = 0.5 * ((q0.z + q1.z) - (p0.z + p1.z))
    length_sq = x * x + y * y + z * z
    reach = abs(x * u.x + y * u.y + z * u.z) + abs(x * v.x + y * v.y + z * v.z)
    spare = length_sq - 0.5 * reach
    return spare > 0.0 and spare * spare > limit * limit * length_sq * (1.0 + 1e-9)


@merged
def _segment_pairs(a, face_a, b, face_b, frames, ask, best):
    """`best` with the insides of the segments of both faces."""
    for k in range(_n_segments(b, face_b)):
        j0, j1 = _segment(b, face_b, k)
        q0 = move(frames.m, row(b.vertices, j0))
        q1 = move(frames.m, row(b.vertices, j1))
        for i in range(_n_segments(a, face_a)):
            i0, i1 = _segment(a, face_a, i)
            p0, p1 = row(a.vertices, i0), row(a.vertices, i1)
            if _far_apart(p0, p1, q0, q1, ask.limit):
                continue
            if may_be_inside_both(p0, p1, q0, q1, ask.margin):
                u0 = point_of_a(frames, row(a.exact, i0))
                u1 = point_of_a(frames, row(a.exact, i1))
                v0 = point_of_b(frames, row(b.exact, j0))
                v1 = point_of_b(frames, row(b.exact, j1))
                p, q = wide_between_segments(u0, u1, v0, v1)
                found_sq = wide_gap_sq(p, q)
                if _wins(found_sq, face_a, face_b, best):
                    w = across_both(minus3(q, p), u0, u1, v0, v1)
                    best = Refined(found_sq, face_a, face_b, p, q, w, best.floor)
    return best


@merged
def _plain_share(surface, corner, pose, w):
    """How far a corner reaches along `w`, rounded, without the shift of its body."""
    return dot(w, turn(pose, row(surface.exact, surface.face_vertices[corner])))


@merged
def _greatest_share(surface, face, frames, is_a, sign, found):
    """(share, reach): the greatest sign * w . (x - p) over the corners, and the greatest coordinate sum.

    Only corners that are greatest within rounding are measured in wide numbers.
    """
    start, end = surface.face_starts[face], surface.face_starts[face + 1]
    pose = frames.a if is_a else frames.b
    w = rounded(found.w)
    most = -math.inf
    reach = 0.0
    for c in range(start, end):
        most = max(most, sign * _plain_share(surface, c, pose, w))
        reach = max(reach, size(row(surface.exact, surface.face_vertices[c])))
    room = CLOSE * size(w) * reach
    share = wide(-math.inf)
    for c in range(start, end):
        if sign * _plain_share(surface, c, pose, w) < most - room:
            continue
        x = _placed(frames, row(surface.exact, surface.face_vertices[c]), is_a)
        here = dot3(found.w, minus3(x, found.p))
        here = Wide(sign * here.hi, sign * here.lo)
        if less(share, here):
            share = here
    return share, reach


@merged
def _floor_along(a, face_a, b, face_b, frames, found):
    """[m] a lower bound on the distance of two faces: their gap along the direction found."""
    length = root(dot3(found.w, found.w))
    if not length.hi > 0.0:
        return wide(0.0)
    far_of_a, reach_a = _greatest_share(a, face_a, frames, True, 1.0, found)
    near_of_b, reach_b = _greatest_share(b, face_b, frames, False, -1.0, found)
    apart = plus(far_of_a, near_of_b)
    noise = NOISE * (2.0 * (reach_a + reach_b) + size(rounded(frames.shift)))
    return minus(over(Wide(-apart.hi, -apart.lo), length), wide(noise))


@kernel
def refine_faces(a, face_a, b, face_b, frames, ask, best):
    """`best`, or better: the features of two faces within the limit, in wide numbers."""
    here = nothing_refined()
    here = _vertex_pairs(a, face_a, b, face_b, frames, ask, here)
    here = _vertices_over(a, face_a, b, face_b, frames, True, ask, face_a, face_b, here)
    here = _vertices_over(b, face_b, a, face_a, frames, False, ask, face_a, face_b, here)
    here = _vertices_and_segments(a, face_a, b, face_b, frames, True, ask, face_a, face_b, here)
    here = _vertices_and_segments(b, face_b, a, face_a, frames, False, ask, face_a, face_b, here)
    here = _segment_pairs(a, face_a, b, face_b, frames, ask, here)
    if here.face_a == 2**62:
        return best
    floor = _floor_along(a, face_a, b, face_b, frames, here)
    if less(best.floor, floor):
        floor = best.floor
    if _wins(here.gap_sq, face_a, face_b, best):
        best = here
    return Refined(best.gap_sq, best.face_a, best.face_b, best.p, best.q, best.w, floor)


@merged
def _nearer(x, y, is_a, best):
    """`best`, or the points x of one face and y of the other if they are nearer."""
    found_sq = wide_gap_sq(x, y)
    if less(found_sq, best.gap_sq):
        p, q = _swapped(is_a, x, y)
        return Refined(found_sq, best.face_a, best.face_b, p, q, best.w, best.floor)
    return best


@merged
def _pierced(one, face_one, two, face_two, frames, is_a, best):
    """`best`, or nearer: where the edges of one face meet the edges and triangles of the other's fan."""
    start, end = one.face_starts[face_one], one.face_starts[face_one + 1]
    first = two.face_starts[face_two]
    x = _placed(frames, row(two.exact, two.face_vertices[first]), not is_a)
    for k in range(start, end):
        after = k + 1 if k + 1 < end else start
        p = _placed(frames, row(one.exact, one.face_vertices[k]), is_a)
        q = _placed(frames, row(one.exact, one.face_vertices[after]), is_a)
        for c in range(first + 1, two.face_starts[face_two + 1] - 1):
            y = _placed(frames, row(two.exact, two.face_vertices[c]), not is_a)
            z = _placed(frames, row(two.exact, two.face_vertices[c + 1]), not is_a)
            n = wide_normal(x, y, z)
            h = dot3(n, minus3(p, x))
            way = minus(h, dot3(n, minus3(q, x)))
            t = p
            if way.hi != 0.0:
                s = over(h, way)
                if 0.0 < s.hi <= 1.0:
                    t = along3(p, s, minus3(q, p))
            best = _nearer(t, wide_on_triangle(t, x, y, z, n), is_a, best)
            u, v = wide_between_segments(p, q, x, y)
            best = _nearer(u, v, is_a, best)
            u, v = wide_between_segments(p, q, y, z)
            best = _nearer(u, v, is_a, best)
            u, v = wide_between_segments(p, q, z, x)
            best = _nearer(u, v, is_a, best)
    return best


@kernel
def common_points(a, face_a, b, face_b, frames):
    """The points of two faces that meet which are nearest to coinciding."""
    nothing = nothing_refined()
    best = _pierced(a, face_a, b, face_b, frames, True, nothing)
    return _pierced(b, face_b, a, face_a, frames, False, best)


@merged
def settle(a, b, frames, best_gap, margin, pairs, near_sq, n_pairs, best):
    """`best` after all waiting face pairs that can still win."""
    for i in range(n_pairs):
        limit = limit_of(a, pairs[i, 0], b, pairs[i, 1], best_gap, margin)
        if near_sq[i] <= limit * limit:
            ask = Ask(limit, margin)
            best = refine_faces(a, pairs[i, 0], b, pairs[i, 1], frames, ask, best)
    return best


@merged
def shed(a, b, best_gap, margin, pairs, near_sq, n_pairs):
    """Drops the waiting face pairs that cannot win any more; how many are left."""
    kept = 0
    for i in range(n_pairs):
        limit = limit_of(a, pairs[i, 0], b, pairs[i, 1], best_gap, margin)
        if near_sq[i] <= limit * limit:
            pairs[kept, 0], pairs[kept, 1] = pairs[i, 0], pairs[i, 1]
            near_sq[kept] = near_sq[i]
            kept += 1
    return kept


@merged
def error_of(refined, distance):
    """[m] a bound on |distance - true distance|, `distance` being the refined one rounded."""
    length = root(refined.gap_sq)
    short = minus(length, refined.floor)
    below = abs(distance - length.hi) + abs(length.lo)
    return (below + max(0.0, short.hi)) * (1.0 + 2.0**-50) + NOISE * distance

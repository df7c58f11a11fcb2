"""Whether two faces have a point in common, exactly, and which edge and triangle of theirs do.

A face is the union of the triangles of its fan from the first corner, so that a face bent by rounding is one
definite surface. Not for: where they meet (`common_point`).
"""

from typing import NamedTuple

from clearance.compile.decorators import inline, kernel
from clearance.kernels.arithmetic.double_double import size
from clearance.kernels.arithmetic.predicates import (
    ExactScratch,
    PosedVertex,
    segment_meets_triangle,
    set_poses,
)
from clearance.kernels.arithmetic.vec3 import dot, move, move_back, row, sub
from clearance.kernels.features.bounds import SLACK
from clearance.kernels.features.face_pair import ROUGH, has_plane, height
from clearance.kernels.features.posed_pair import PosedPair


@inline
def _posed(surface, corner, body):
    return PosedVertex(row(surface.exact, surface.face_vertices[corner]), body)


class Meeting(NamedTuple):
    """Where two faces have a point in common, if they do.

    Attributes:
        found: False if they have none.
        edge_of_a: True if the edge is a's and the triangle b's.
        p, q: corners that the edge joins. k: middle corner of the fan's triangle; indices into `face_vertices`.
    """

    found: bool
    edge_of_a: bool
    p: int
    q: int
    k: int


NO_MEETING = Meeting(False, True, 0, 0, 0)


@inline
def _crosses_beyond(surface, face, x, h_x, y, h_y, tolerance):
    """True if a segment x y (body frame) goes through the plane of a face clearly beyond one of its edges.

    The height h and the distance s beyond an edge are linear along the segment. Where it meets the face |h| is at
    most the tolerance t and s at most 0. It misses if |h_y| s_x + |h_x| s_y > t |s_x - s_y|. With errors of up to
    t in each of the four, and t below both |h|, 3 t times the sum of their magnitudes is enough.
    """
    if h_x * h_y >= 0.0 or min(abs(h_x), abs(h_y)) <= tolerance:
        return False
    start, end = surface.face_starts[face], surface.face_starts[face + 1]
    for c in range(start, end):
        outward = row(surface.corner_normals, c)
        corner = row(surface.vertices, surface.face_vertices[c])
        s_x, s_y = dot(outward, sub(x, corner)), dot(outward, sub(y, corner))
        if s_x <= 0.0 and s_y <= 0.0:
            continue
        edge = 0.0
        for k in range(start, end):
            edge = max(
                edge, dot(outward, sub(row(surface.vertices, surface.face_vertices[k]), corner))
            )
        s_x -= edge
        s_y -= edge
        magnitudes = abs(h_x) + abs(h_y) + abs(s_x) + abs(s_y)
        if abs(h_y) * s_x + abs(h_x) * s_y > 3.0 * tolerance * magnitudes:
            return True
    return False


@inline
def _clearly_misses(surface, face, p, q, frames, is_a):
    """True if a segment p q of the other body clearly misses a face, decided in doubles.

    It lies on one side of the face's plane, or goes through it beyond an edge.

    Args:
        is_a: True if the other body is a.
    """
    if not has_plane(surface, face):
        return False
    m = frames.m
    x, y = (move_back(m, p), move_back(m, q)) if is_a else (move(m, p), move(m, q))
    h_x, h_y = height(surface, face, x), height(surface, face, y)
    first = row(surface.vertices, surface.face_vertices[surface.face_starts[face]])
    far = max(size(p), size(q)) + size(m.t) + size(first)
    blunt = surface.blunt[face]
    share = 4.0 * (SLACK + 8.0 * frames.defect) + ROUGH * blunt * blunt
    tolerance = 2.0 * surface.width[face] + share * far
    if min(h_x, h_y) > tolerance or max(h_x, h_y) < -tolerance:
        return True
    return _crosses_beyond(surface, face, x, h_x, y, h_y, tolerance)


@inline
def _edges_meet_face(one, face_one, two, face_two, edge_of_a, inner, frames, exact):
    """Where an edge of `face_one`, or if `inner` a diagonal of its fan, meets a triangle of `face_two`."""
    start, end = one.face_starts[face_one], one.face_starts[face_one + 1]
    other, last = two.face_starts[face_two], two.face_starts[face_two + 1]
    body_one, body_two = (0, 1) if edge_of_a else (1, 0)
    a = _posed(two, other, body_two)
    for n in range(end - start - 3 if inner else end - start):
        i = start if inner else start + n
        j = start + 2 + n if inner else start + (n + 1) % (end - start)
        v, w = row(one.vertices, one.face_vertices[i]), row(one.vertices, one.face_vertices[j])
        if _clearly_misses(two, face_two, v, w, frames, edge_of_a):
            continue
        p = _posed(one, i, body_one)
        q = _posed(one, j, body_one)
        for k in range(other + 1, last - 1):
            b = _posed(two, k, body_two)
            c = _posed(two, k + 1, body_two)
            if segment_meets_triangle(p, q, a, b, c, exact):
                return Meeting(True, edge_of_a, i, j, k)
    return Meeting(False, edge_of_a, start, start, other + 1)


@inline(force=True)
def _edges_clearly_miss(one, face_one, two, face_two, edge_of_a, frames):
    """True if every edge of `face_one` clearly misses `face_two`."""
    start, end = one.face_starts[face_one], one.face_starts[face_one + 1]
    for i in range(start, end):
        j = i + 1 if i + 1 < end else start
        v, w = row(one.vertices, one.face_vertices[i]), row(one.vertices, one.face_vertices[j])
        if not _clearly_misses(two, face_two, v, w, frames, edge_of_a):
            return False
    return True


@kernel
def meeting(faces: PosedPair, exact: ExactScratch) -> Meeting:
    """Where two faces have a point in common, exactly: the first edge and triangle found to meet.

    If two flat faces meet, an edge of one meets the other. If one is bent, its fan's diagonals are edges too.
    """
    a, b = faces.surface_a, faces.surface_b
    face_a, face_b, frames = faces.a, faces.b, faces.frames
    bent = a.bent[face_a] or b.bent[face_b]
    if (
        not bent
        and _edges_clearly_miss(a, face_a, b, face_b, True, frames)
        and _edges_clearly_miss(b, face_b, a, face_a, False, frames)
    ):
        return NO_MEETING
    set_poses(frames, exact)
    found = NO_MEETING
    one, face_one, two, face_two = a, face_a, b, face_b
    for turn in range(4):
        inner = turn > 1
        if not inner or bent:
            found = _edges_meet_face(
                one, face_one, two, face_two, turn % 2 == 0, inner, frames, exact
            )
        if found.found:
            break
        one, face_one, two, face_two = two, face_two, one, face_one
    return found

"""Whether two faces have a point in common, exactly, and which edge and triangle of theirs do.

A face is the union of the triangles of its fan from the first corner, so that a face bent by rounding is one
definite surface. Not for: where they meet (`common_point`).
"""

from typing import NamedTuple

from clearance.jit import inlined, spliced
from clearance.kernel_table import MEETING, Lent, apart, at_address, borrow
from clearance.kernels.bounds import SLACK
from clearance.kernels.double_double import FRAMES_AT_REST, size
from clearance.kernels.face_pair import ROUGH, has_plane, height
from clearance.kernels.predicates import Posed, room_for_exact, segment_meets_triangle, set_poses
from clearance.kernels.surface import surface_like
from clearance.kernels.vec3 import move, move_back, row


@inlined
def _posed(surface, corner, body):
    return Posed(row(surface.exact, surface.face_vertices[corner]), body)


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


@inlined
def _height(surface, face, v, m, is_a):
    """(height over a face's plane, magnitude of what it comes from) of a vertex of the other body.

    Args:
        is_a: True if the other body is a.
    """
    x = move_back(m, v) if is_a else move(m, v)
    far = size(v) + size(m.t) + size(row(surface.vertices, surface.face_vertices[surface.face_starts[face]]))
    return height(surface, face, x), far


@inlined
def _clearly_beside(surface, face, p, q, frames, is_a):
    """True if a segment p q of the other body lies clearly on one side of a face's plane, told in doubles."""
    if not has_plane(surface, face):
        return False
    h_p, far_p = _height(surface, face, p, frames.m, is_a)
    h_q, far_q = _height(surface, face, q, frames.m, is_a)
    blunt = surface.blunt[face]
    share = 4.0 * (SLACK + 8.0 * frames.defect) + ROUGH * blunt * blunt
    tolerance = 2.0 * surface.width[face] + share * max(far_p, far_q)
    return min(h_p, h_q) > tolerance or max(h_p, h_q) < -tolerance


@inlined
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
        if _clearly_beside(two, face_two, v, w, frames, edge_of_a):
            continue
        p = _posed(one, i, body_one)
        q = _posed(one, j, body_one)
        for k in range(other + 1, last - 1):
            b = _posed(two, k, body_two)
            c = _posed(two, k + 1, body_two)
            if segment_meets_triangle(p, q, a, b, c, exact):
                return Meeting(True, edge_of_a, i, j, k)
    return Meeting(False, edge_of_a, start, start, other + 1)


def _like():
    return Lent(surface_like()), 0, Lent(surface_like()), 0, FRAMES_AT_REST, room_for_exact()


@apart(MEETING, _like)
def meeting(lent_a, face_a, lent_b, face_b, frames, exact):
    """Where two faces have a point in common, exactly: the first edge and triangle found to meet.

    Of two flat faces that meet an edge of one meets the other. Where one is bent, its fan's diagonals are
    edges too.
    """
    a, b = borrow(lent_a), borrow(lent_b)
    set_poses(frames, exact)
    found = NO_MEETING
    one, face_one, two, face_two = a, face_a, b, face_b
    for turn in range(4):
        inner = turn > 1
        if not inner or a.bent[face_a] or b.bent[face_b]:
            found = _edges_meet_face(
                one, face_one, two, face_two, turn % 2 == 0, inner, frames, exact
            )
        if found.found:
            break
        one, face_one, two, face_two = two, face_two, one, face_one
    return found


@spliced
def meeting_of(table, lent_a, face_a, lent_b, face_b, frames, exact):
    """The same by address."""
    return at_address(table, MEETING, NO_MEETING, (lent_a, face_a, lent_b, face_b, frames, exact))

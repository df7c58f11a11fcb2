"""What errors leave of two faces, and what a search comes to by it.

A face pair is bounded along the direction of its own nearest points, and in pieces where that is far below what
occurs. Not for: which faces are looked at (`left`).
"""

import math
from typing import NamedTuple

from clearance.compile.decorators import inline
from clearance.kernels.arithmetic.lanes import WIDTH
from clearance.kernels.arithmetic.vec3 import Vec3, dot, move_back, row
from clearance.kernels.budget.errors import BodyRows
from clearance.kernels.budget.pieces import TrianglePairs, bound_of_pieces
from clearance.kernels.budget.reach import along_at_rest, reach_of_point
from clearance.kernels.budget.tilted import tilted
from clearance.kernels.budget.view import AlongRows, look_along, moved_of_point
from clearance.kernels.features.bounds import (
    direction_beside,
    direction_between,
    lower_bound_faces_along_direction,
    margin_of,
)
from clearance.kernels.features.face_pair import nearest_of_faces, nothing_yet
from clearance.kernels.mesh.corners import corners_at, greatest_in, least_in
from clearance.kernels.mesh.surface import box_of
from clearance.kernels.motion.certify_pair import STILL, allowed_gap
from clearance.kernels.search.node_pairs import Views, views_along
from clearance.kernels.search.scratch import Scratch

REFINED = 0.05
"""The share of what errors take at the nearest points that a bound at a step may stay below what occurs there."""

REFINED_OF_MANY = 0.1
"""The same where moments are many: those that decide are looked at once more."""

FINEST = 1e-9
"""[m] No face pair is cut for less."""


class Aim(NamedTuple):
    """What is to be proven of a pair.

    Attributes:
        target: [m] what stays above it needs no look. least: [m] the least that is known to occur.
        gap: [m] how far the bound over an interval may stay below what occurs, 0 at a step. fail: [m] the limit.
        is_step: True where all stands: then the bound is never given up.
        exact_looks: at a step, as many looks are made before what is `refined` below what occurs is enough.
        refined: that share of what errors take there.
    """

    target: float
    least: float
    gap: float
    fail: float
    is_step: bool
    exact_looks: int
    refined: float


class LeftScratch(NamedTuple):
    """What a search is made with: rows of errors, how they are seen along two directions, and scratch.

    Attributes:
        kept: the rows beside the tilted direction of the search. own: all rows, along that of two faces.
    """

    found: BodyRows
    kept: AlongRows
    own: AlongRows
    pieces: TrianglePairs
    scratch: Scratch


class SearchState(NamedTuple):
    """What a search has come to, of rigid bodies without balls and surfaces.

    Attributes:
        views: along the direction of the nearest points, tilted by the errors. u: that direction (frame of a).
        nearest: [m] the distance of those points.
        lower_bound, target, least: [m] as in `PairRemainder` and `Aim`. enough: [m] at a step, what is
            a share of what errors take below what occurs.
    """

    views: Views
    u: Vec3
    nearest: float
    lower_bound: float
    target: float
    least: float
    enough: float


class FacePairRemainder(NamedTuple):
    """What a search has come to after two faces; True where it must be given up."""

    search: SearchState
    gives_up: bool


class _Faces(NamedTuple):
    """Two faces whole: [m] a bound on what is left, and their distance, along one direction."""

    bound: float
    apart: float


class FacesBeside(NamedTuple):
    """Two faces seen along a direction beside them: [m] a bound on what is left; True if they may be nearest."""

    bound: float
    is_nearest: bool


class _ErrorEffect(NamedTuple):
    """The nearest points of two faces: [m] what errors take there, and what motion takes beside them."""

    taken: float
    motion: float


@inline(force=True)
def _along(a, face_a, b, face_b, direction, seen, slack):
    """What is left of two faces along a direction, in which the errors are seen."""
    u, v = direction.u, direction.v
    far = beyond = -math.inf
    end = a.face_starts[face_a + 1]
    for c in range(a.face_starts[face_a], end, WIDTH):
        x = corners_at(a, c, end)
        height = dot(u, x)
        far = max(far, greatest_in(height + moved_of_point(x, 0, u, seen)))
        beyond = max(beyond, greatest_in(height))
    first = before = math.inf
    end = b.face_starts[face_b + 1]
    for c in range(b.face_starts[face_b], end, WIDTH):
        x = corners_at(b, c, end)
        height = dot(v, x)
        first = min(first, least_in(height - moved_of_point(x, 1, v, seen)))
        before = min(before, least_in(height))
    return _Faces(
        first + direction.offset - far - slack, before + direction.offset - beyond - slack
    )


@inline
def _reach_of_face(surface, face, found, body):
    """[m] how far the errors can move any point of a face."""
    reach = 0.0
    for c in range(surface.face_starts[face], surface.face_starts[face + 1]):
        x = row(surface.vertices, surface.face_vertices[c])
        reach = max(reach, reach_of_point(found, body, x))
    return reach


@inline
def _reach_of_both(lent, faces):
    """[m] how far the errors can move two faces at most, added up."""
    scene, bodies = lent, faces.bodies
    found = scene.state.work.found
    reach = _reach_of_face(scene.surface, faces.a, found, bodies.a)
    return reach + _reach_of_face(scene.surface, faces.b, found, bodies.b)


@inline
def look_at_both(lent, direction, bodies):
    """Writes how the errors of both bodies are seen along a direction."""
    work = lent.state.work
    look_along(work.found, bodies.a, 0, direction.u, work.own)
    look_along(work.found, bodies.b, 1, direction.v, work.own)


@inline
def look_beside(lent, faces, back, slack, known, near):
    """What is seen of two faces whole along a direction in which they are probably apart.

    Args:
        back: `b_from_a`. known: [m] a bound on what is left of them. near: [m] they may be the nearest if they are
            nearer than that.
    """
    scene = lent
    surface = scene.surface
    direction = direction_beside(surface, faces.a, surface, faces.b, faces.m, back)
    apart = lower_bound_faces_along_direction(surface, faces.a, surface, faces.b, direction) - slack
    if apart <= known:  # errors only take of it
        return FacesBeside(known, apart < near)
    look_at_both(lent, direction, faces.bodies)
    own = scene.state.work.own
    seen = _along(surface, faces.a, surface, faces.b, direction, own, slack)
    return FacesBeside(max(known, seen.bound), apart < near)


@inline
def turn_to(lent, direction, m, bodies):
    """The views along a direction, tilted by the errors that were last looked at along it."""
    scene = lent
    work = scene.state.work
    box_a, box_b = box_of(scene.surface, bodies.root_a), box_of(scene.surface, bodies.root_b)
    return views_along(tilted(direction, box_a, box_b, work.own, work.kept), m)


@inline
def taken_at(lent, p, q, direction, m, bodies, aim):
    """What is taken at two points (frame of a), along the direction that was last looked at."""
    work = lent.state.work
    u, v, q = direction.u, direction.v, move_back(m, q)
    whole = moved_of_point(p, 0, u, work.own) + moved_of_point(q, 1, v, work.own)
    if aim.is_step:
        return _ErrorEffect(whole, 0.0)
    taken = along_at_rest(work.found, bodies.a, u, p) + along_at_rest(work.found, bodies.b, v, q)
    return _ErrorEffect(taken, max(0.0, whole - taken))


@inline(force=True)
def near_by(taken, aim):
    """[m] how far below what occurs a bound at a step may stay, where errors take so much."""
    return max(FINEST, aim.refined * taken)


@inline(force=True)
def with_value(search, value, taken, aim, thin):
    """A search that has seen what occurs [m], of which errors take so much; that moves the target."""
    target, least, enough = search.target, min(search.least, value), search.enough
    if aim.is_step:
        enough = min(enough, value - near_by(taken, aim))
    elif value < search.least:
        target = min(target, least - allowed_gap(least - thin, aim.gap, aim.fail))
    return SearchState(
        search.views, search.u, search.nearest, search.lower_bound, target, least, enough
    )


@inline(force=True)
def with_bound(search, bound, aim):
    """A search that has a bound [m]; of a step that moves the target."""
    target = min(search.target, bound) if aim.is_step else search.target
    return SearchState(
        search.views, search.u, search.nearest, min(search.lower_bound, bound), target,
        search.least, search.enough,
    )  # fmt: skip


@inline(force=True)
def along_nearest(search, views, u, nearest):
    """A search that sees along another direction."""
    return SearchState(
        views, u, nearest, search.lower_bound, search.target, search.least, search.enough
    )


@inline(force=True)
def target_of(search, aim, n_looks):
    """[m] what stays above it needs no look after so many looks."""
    if n_looks > aim.exact_looks:
        return min(search.target, search.enough)
    return search.target


@inline
def look_at_faces(lent, faces, bound, slack, search, aim, thin, tally):
    """What a search has come to after `TwoFaces`."""
    scene, m, bodies = lent, faces.m, faces.bodies
    surface, work = scene.surface, scene.state.work
    tally[3] += 1
    margin = margin_of(slack)
    near = nearest_of_faces(
        surface, faces.a, surface, faces.b, m, margin, nothing_yet(math.inf)
    ).best
    direction = direction_between(near.p, near.q, m)
    look_at_both(lent, direction, bodies)
    whole = _along(surface, faces.a, surface, faces.b, direction, work.own, slack)
    length = math.sqrt(near.gap_sq)
    if whole.apart <= 0.0:  # they may touch
        reach = _reach_of_both(lent, faces)
        search = with_value(search, -reach, reach, aim, thin)
        return FacePairRemainder(with_bound(search, max(bound, -reach), aim), False)
    bound = max(bound, whole.bound)
    point = taken_at(lent, near.p, near.q, direction, m, bodies, aim)
    value = length - point.taken
    if length < search.nearest:
        views = turn_to(lent, direction, m, bodies)
        search = along_nearest(search, views, direction.u, length)
    search = with_value(search, value, point.taken, aim, thin)
    if bound < search.target:
        bound = max(bound, whole.apart - _reach_of_both(lent, faces))
    wanted, allowed = search.target, near_by(point.taken, aim)
    if aim.is_step:
        wanted = min(wanted, search.enough)
    else:
        allowed = allowed_gap(search.least - thin, aim.gap, aim.fail)
    gives_up = False
    if bound < wanted:
        still = aim.is_step or point.motion < STILL * allowed
        if still or value - point.motion >= wanted:
            tally[4] += 1
            cut = bound_of_pieces(lent, faces, bound, slack, wanted, allowed)
            bound = max(bound, cut.lower_bound)
            search = with_value(search, cut.least, point.taken, aim, thin)
        gives_up = bound < search.target and not still
    return FacePairRemainder(with_bound(search, bound, aim), gives_up)

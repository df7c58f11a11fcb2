"""Separating planes of two bodies: a proof of their distance, where their convex hulls are as far from each other.

Along a unit vector u, no points of the bodies are nearer than the least height of b less the greatest of a. Each
is found in one tree by itself, not in pairs of nodes. If the planes are as far from each other as the nearest
points of the faces that touch them, nothing else is as near. The direction is that of the nearest points of the
hulls: GJK, from the points that were nearest before. Not for: bodies whose hulls are nearer (`descent`).

Faces that touch the planes are skipped only where they are turned away (`support`). Let d be the distance and f
that of the planes. The nearest points lie along w with u . w >= f / d, so |u - w|^2 <= 2 (d - f) / d. This is less
than `TILT`^2, since d - f is less than the tolerance, and the tolerance less than `TILTED` of d.

Source: Gilbert, Johnson, Keerthi, A fast procedure for computing the distance between complex objects, 1988.
"""

import math
from typing import NamedTuple

import numpy as np

from clearance.compile.decorators import inline, kernel
from clearance.kernels.arithmetic.vec3 import Vec3, cross, dot, move, row, sub
from clearance.kernels.features.bounds import direction_between, margin_of
from clearance.kernels.features.face_pair import Hit
from clearance.kernels.features.posed_pair import PosedPair
from clearance.kernels.features.segments import foot_inside
from clearance.kernels.search.scratch import Scratch
from clearance.kernels.search.support import TILT, SupportPoint, high_corner, top_of

TURNS = 24
"""Most directions to try."""

TOUCHING, TOUCHING_PAIRS = 24, 144
"""Most faces of each body that touch the planes, and most pairs of them; with more a descent is quicker."""

LESS = 0.5
"""Share of the distance of the points that were nearest. Hulls nearer than that are most likely nearer than the
bodies."""

CLOSE = 2.0**-30
"""Faces behind the planes by up to this share of the distance still count as touching."""

TILTED = 0.25 * TILT * TILT
"""Greatest tolerance behind the planes, as a share of the distance."""


class SeparatingPlanes(NamedTuple):
    """The result of seeking planes.

    Attributes:
        lower_bound: [m] proven for the bodies; -inf if no planes were found.
        beyond: [m] proven for all faces that do not wait.
        n_waiting: pairs of leaves that wait. n_nodes: nodes bounded.
        face_a, face_b: faces that touch the planes.
    """

    lower_bound: float
    beyond: float
    n_waiting: int
    n_nodes: int
    face_a: int
    face_b: int


NOT_SEPARATED = SeparatingPlanes(-math.inf, -math.inf, 0, 0, -1, -1)


@inline(force=True)
def _nearest_on_edge(p, q):
    """(the point of an edge nearest to the origin, True for each end that supports it)."""
    inside, x = foot_inside(Vec3(0.0, 0.0, 0.0), p, q)
    if inside:
        return x, True, True
    if dot(q, q) < dot(p, p):
        return q, False, True
    return p, True, False


@inline(force=True)
def _nearest_on_triangle(a, b, c):
    """(the point of a triangle nearest to the origin, True for each supporting corner): Ericson 2005, 5.1.5."""
    ab, ac = sub(b, a), sub(c, a)
    n = cross(ab, ac)
    size = dot(n, n)
    # shares of the corners, times the square of twice the area
    u = dot(n, cross(b, c))
    v = dot(n, cross(c, a))
    w = dot(n, cross(a, b))
    if size > 0.0 and u > 0.0 and v > 0.0 and w > 0.0:
        h = dot(n, a) / size
        return Vec3(h * n.x, h * n.y, h * n.z), True, True, True
    best, of_a, of_b = _nearest_on_edge(a, b)
    of_c = False
    x, first, second = _nearest_on_edge(a, c)
    if dot(x, x) < dot(best, best):
        best, of_a, of_b, of_c = x, first, False, second
    x, first, second = _nearest_on_edge(b, c)
    if dot(x, x) < dot(best, best):
        best, of_a, of_b, of_c = x, False, first, second
    return best, of_a, of_b, of_c


@inline(force=True)
def _remaining(p, q, r, of_p, of_q, of_r):
    """The supporting ones of three points first: (how many, three points)."""
    if not of_q:
        q = r
    if not of_p:
        p, q = q, r
    return int(of_p) + int(of_q) + int(of_r), p, q, r


@inline(force=True)
def _nearest_with(n, p, q, r, w):
    """The point nearest to the origin of a simplex of `n` points, 1 to 3, and a new one, with its supporting
    points.

    With four points the nearest of the three triangles at the new one. Returns (it, how many, three points).
    """
    if n == 1:
        q = p
    near, of_p, of_q, of_w = _nearest_on_triangle(p, q, w)
    first, second = p, q
    if n == 3:
        other, of_0, of_1, of_2 = _nearest_on_triangle(p, r, w)
        if dot(other, other) < dot(near, near):
            near, of_p, of_q, of_w, first, second = other, of_0, of_1, of_2, p, r
        other, of_0, of_1, of_2 = _nearest_on_triangle(q, r, w)
        if dot(other, other) < dot(near, near):
            near, of_p, of_q, of_w, first, second = other, of_0, of_1, of_2, q, r
    n, p, q, r = _remaining(first, second, w, of_p, of_q, of_w)
    return near, n, p, q, r


@inline(force=True)
def _let_wait(n_a, n_b, lower_bound, scratch):
    """Queues all pairs of the leaves in both columns of `scratch.entries`; how many they are."""
    n_waiting = 0
    for i in range(n_a):
        for k in range(n_b):
            scratch.nodes[n_waiting, 0], scratch.nodes[n_waiting, 1] = (
                ~np.int64(scratch.entries[i, 0]),
                np.int64(scratch.entries[k, 1]),
            )
            scratch.bounds[n_waiting] = lower_bound
            n_waiting += 1
    return n_waiting


class HullSimplex(NamedTuple):
    """Points of a less points of b, one to three, whose hull comes nearest to the origin.

    Attributes:
        n: how many. near: the nearest point to the origin of their hull.
    """

    n: int
    near: Vec3
    p: Vec3
    q: Vec3
    r: Vec3


class Extremes(NamedTuple):
    """The extremes of both bodies along a direction, towards one another.

    Attributes:
        top_a, top_b: the highest corners. n_a, n_b: leaves that are as high within the tolerance, if asked for.
        n_nodes: nodes bounded.
    """

    top_a: SupportPoint
    top_b: SupportPoint
    n_a: int
    n_b: int
    n_nodes: int


@inline(force=True)
def _extremes(a, b, roots, direction, face_a, face_b, tolerance, scratch):
    """The extremes of two bodies; in `scratch.entries` the leaves within a tolerance [m] of 0 or more."""
    v = Vec3(-direction.v.x, -direction.v.y, -direction.v.z)
    n_a, n_b = 0, 0
    if tolerance >= 0.0:
        top_a, n_a, nodes_a = top_of(
            a, roots.a, direction.u, face_a, tolerance, TOUCHING, 0, scratch
        )
        top_b, n_b, nodes_b = top_of(b, roots.b, v, face_b, tolerance, TOUCHING, 1, scratch)
    else:
        top_a, nodes_a = high_corner(a, roots.a, direction.u, face_a)
        top_b, nodes_b = high_corner(b, roots.b, v, face_b)
    return Extremes(top_a, top_b, n_a, n_b, nodes_a + nodes_b)


@inline(force=True)
def _with_corners(simplex, a, b, corner_a, corner_b, m):
    """The simplex with the difference of two corners added, reduced to its supporting points."""
    x = row(a.vertices, a.face_vertices[corner_a])
    w = sub(x, move(m, row(b.vertices, b.face_vertices[corner_b])))
    if simplex.n == 0:
        return HullSimplex(1, w, w, simplex.q, simplex.r)
    near, n, p, q, r = _nearest_with(simplex.n, simplex.p, simplex.q, simplex.r, w)
    return HullSimplex(n, near, p, q, r)


@kernel
def separate(
    roots: PosedPair, best: Hit, limit: float, slack: float, scratch: Scratch
) -> SeparatingPlanes:
    """Seeks planes that separate the bodies by the distance of their nearest points, or by more than a limit [m].

    Pairs of leaves that touch the planes wait, like those of a front.

    Args:
        roots: of the bodies' trees.
        best: a hit; the first direction is along its points.
        slack: [m] of `rounding_slack`.
    """
    a, b = roots.surface_a, roots.surface_b
    m, margin = roots.frames.m, margin_of(slack)
    origin, near = Vec3(0.0, 0.0, 0.0), sub(best.p, best.q)
    simplex = HullSimplex(0, near, near, near, near)
    face_a, face_b, n_nodes, expected = np.int64(-1), np.int64(-1), 0, 0.0
    if best.face_a < 2**62:
        face_a, face_b = np.int64(best.face_a), np.int64(best.face_b)
        simplex = HullSimplex(1, near, near, near, near)
        expected = min(limit, math.sqrt(best.gap_sq))
    is_proof = simplex.n > 0
    for _ in range(TURNS):
        length = math.sqrt(dot(simplex.near, simplex.near))
        tolerance = 16.0 * margin + CLOSE * length
        if not tolerance < TILTED * length or length < LESS * expected:
            break
        direction = direction_between(simplex.near, origin, m)
        seen = _extremes(
            a, b, roots, direction, face_a, face_b, tolerance if is_proof else -1.0, scratch
        )
        n_nodes += seen.n_nodes
        face_a, face_b = seen.top_a.face, seen.top_b.face
        if face_a < 0 or face_b < 0:
            break
        lower_bound = direction.offset - seen.top_b.height - seen.top_a.height - slack
        is_as_far = (
            simplex.n > 0 and lower_bound > 0.0 and lower_bound + tolerance > length + 2.0 * margin
        )
        if not is_proof and (lower_bound > limit or is_as_far):
            is_proof = True
            continue
        if lower_bound > limit:
            return SeparatingPlanes(lower_bound, lower_bound, 0, n_nodes, face_a, face_b)
        if is_as_far:
            if max(seen.n_a, seen.n_b) > TOUCHING or seen.n_a * seen.n_b > TOUCHING_PAIRS:
                break
            n_waiting = _let_wait(seen.n_a, seen.n_b, lower_bound, scratch)
            return SeparatingPlanes(
                lower_bound, lower_bound + tolerance, n_waiting, n_nodes, face_a, face_b
            )
        nearer = _with_corners(simplex, a, b, seen.top_a.corner, seen.top_b.corner, m)
        if simplex.n == 0:
            simplex = nearer
        elif dot(nearer.near, nearer.near) < dot(simplex.near, simplex.near):
            simplex = nearer
            is_proof = False
        elif is_proof:
            break
        else:
            is_proof = True
    return SeparatingPlanes(-math.inf, -math.inf, 0, n_nodes, face_a, face_b)

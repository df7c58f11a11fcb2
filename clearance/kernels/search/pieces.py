"""Two faces cut into smaller and smaller pieces, so that all points of a piece move nearly alike.

A small turn moves the far corner of a large face, as of a table, by much, though nothing is near it. Pieces are
triangles. Each pair is bounded along the direction of its own nearest points, and by the bound on the whole faces.
Not for: which faces (`proof`).
"""

import math
from typing import NamedTuple

import numpy as np

from clearance.compile.declared import Floats, Floats2
from clearance.compile.decorators import inline
from clearance.kernels.arithmetic.vec3 import Vec3, along, dot, gap_sq, move, row, sub, turn_back
from clearance.kernels.features.bounds import direction_between
from clearance.kernels.search.displacement import (
    errors_of_point_along,
    movement_of_point_along,
    prepare_along,
)

MOST_PIECES = 600
"""Most pairs of pieces to visit for two faces; the remaining ones keep their bounds."""

MOST_WAITING = 1200

MOST_FANS = 400
"""Most pairs of triangles to begin with; faces with more are not cut."""

TRIED = 6
"""Alternating projections to find near points of two triangles; any direction is sound."""


class TrianglePairs(NamedTuple):
    """Waiting pairs of triangles: (n, 18) corners, of a in its frame, then of b in its own [m]; bounds (n,)."""

    corners: Floats2
    bounds: Floats


class PieceBound(NamedTuple):
    """The result for all pieces: [m] a lower bound, and the least distance that occurs at the points seen."""

    lower_bound: float
    least: float


class _Triangle(NamedTuple):
    a: Vec3
    b: Vec3
    c: Vec3


@inline
def new_pieces():
    """Memory for pieces."""
    return TrianglePairs(np.empty((MOST_WAITING, 18)), np.empty(MOST_WAITING))


@inline
def _read(numbers, first):
    n = numbers
    return _Triangle(
        Vec3(n[first], n[first + 1], n[first + 2]),
        Vec3(n[first + 3], n[first + 4], n[first + 5]),
        Vec3(n[first + 6], n[first + 7], n[first + 8]),
    )


@inline
def _write(triangle, numbers, first):
    n = numbers
    n[first], n[first + 1], n[first + 2] = triangle.a.x, triangle.a.y, triangle.a.z
    n[first + 3], n[first + 4], n[first + 5] = triangle.b.x, triangle.b.y, triangle.b.z
    n[first + 6], n[first + 7], n[first + 8] = triangle.c.x, triangle.c.y, triangle.c.z


@inline
def _in_other(triangle, m):
    return _Triangle(move(m, triangle.a), move(m, triangle.b), move(m, triangle.c))


@inline
def _nearest_in(triangle, x):
    """The point of a triangle nearest to x, to rounding; by regions (Ericson 2005, section 5.1.5)."""
    a, b, c = triangle.a, triangle.b, triangle.c
    ab, ac, ap = sub(b, a), sub(c, a), sub(x, a)
    d1, d2 = dot(ab, ap), dot(ac, ap)
    if d1 <= 0.0 and d2 <= 0.0:
        return a
    bp = sub(x, b)
    d3, d4 = dot(ab, bp), dot(ac, bp)
    if d3 >= 0.0 and d4 <= d3:
        return b
    vc = d1 * d4 - d3 * d2
    if vc <= 0.0 and d1 >= 0.0 and d3 <= 0.0 and d1 - d3 > 0.0:
        return along(a, d1 / (d1 - d3), ab)
    cp = sub(x, c)
    d5, d6 = dot(ab, cp), dot(ac, cp)
    if d6 >= 0.0 and d5 <= d6:
        return c
    vb = d5 * d2 - d1 * d6
    if vb <= 0.0 and d2 >= 0.0 and d6 <= 0.0 and d2 - d6 > 0.0:
        return along(a, d2 / (d2 - d6), ac)
    va = d3 * d6 - d5 * d4
    if va <= 0.0 and d4 - d3 >= 0.0 and d5 - d6 >= 0.0 and (d4 - d3) + (d5 - d6) > 0.0:
        return along(b, (d4 - d3) / ((d4 - d3) + (d5 - d6)), sub(c, b))
    total = va + vb + vc
    if total > 0.0:
        return along(along(a, vb / total, ab), vc / total, ac)
    return a


@inline
def _near_points(p, q):
    """Points of two triangles in one frame, near each other."""
    x = _nearest_in(
        p,
        Vec3(
            (q.a.x + q.b.x + q.c.x) / 3.0,
            (q.a.y + q.b.y + q.c.y) / 3.0,
            (q.a.z + q.b.z + q.c.z) / 3.0,
        ),
    )
    y = _nearest_in(q, x)
    for _ in range(TRIED):
        x = _nearest_in(p, y)
        y = _nearest_in(q, x)
    return x, y


@inline
def _longest_sq(t):
    return max(gap_sq(t.a, t.b), max(gap_sq(t.b, t.c), gap_sq(t.c, t.a)))


@inline
def _halves(t):
    """A triangle cut in the middle of its longest edge."""
    ab, bc, ca = gap_sq(t.a, t.b), gap_sq(t.b, t.c), gap_sq(t.c, t.a)
    if ab >= bc and ab >= ca:
        x = _middle(t.a, t.b)
        return _Triangle(t.a, x, t.c), _Triangle(x, t.b, t.c)
    if bc >= ca:
        x = _middle(t.b, t.c)
        return _Triangle(t.b, x, t.a), _Triangle(x, t.c, t.a)
    x = _middle(t.c, t.a)
    return _Triangle(t.c, x, t.b), _Triangle(x, t.a, t.b)


@inline
def _middle(a, b):
    return Vec3(0.5 * (a.x + b.x), 0.5 * (a.y + b.y), 0.5 * (a.z + b.z))


class _PieceBounds(NamedTuple):
    """A pair of pieces: [m] a lower bound, the distance at near points, and how much the motion of each varies."""

    bound: float
    value: float
    unlike_a: float
    unlike_b: float


@inline
def _bounded(p, q, m, displacement):
    """A bound on two pieces along their own direction, `q` in the frame of b."""
    x, y = _near_points(p, _in_other(q, m))
    direction = direction_between(x, y, m)
    u, v = direction.u, direction.v
    if not dot(u, u) > 0.0:
        return _PieceBounds(
            -math.inf, -math.inf, math.sqrt(_longest_sq(p)), math.sqrt(_longest_sq(q))
        )
    prepare_along(displacement, direction)
    far, most, fewest = -math.inf, -math.inf, math.inf
    for corner in p:
        moved = movement_of_point_along(displacement, corner, 0, u)
        far = max(far, dot(u, corner) + moved)
        most, fewest = max(most, moved), min(fewest, moved)
    unlike_a = most - fewest
    near, most, fewest = math.inf, -math.inf, math.inf
    for corner in q:
        moved = movement_of_point_along(displacement, corner, 1, v)
        near = min(near, dot(v, corner) - moved)
        most, fewest = max(most, moved), min(fewest, moved)
    bound = near + direction.offset - far - displacement.slack
    at_rest = errors_of_point_along(displacement, x, 0, u)
    at_rest += errors_of_point_along(displacement, turn_back(m, sub(y, m.t)), 1, v)
    d = sub(y, x)
    return _PieceBounds(bound, math.sqrt(dot(d, d)) - at_rest, unlike_a, most - fewest)


@inline
def _begin(faces, pieces):
    """All pairs of triangles of two fans; how many, or 0 where they are too many."""
    a, b = faces.surface_a, faces.surface_b
    first_a, end_a = a.face_starts[faces.a], a.face_starts[faces.a + 1]
    first_b, end_b = b.face_starts[faces.b], b.face_starts[faces.b + 1]
    n_a, n_b = max(1, end_a - first_a - 2), max(1, end_b - first_b - 2)
    if n_a * n_b > MOST_FANS:
        return 0
    n = 0
    for i in range(n_a):
        p = _fan(a, first_a, end_a, i)
        for k in range(n_b):
            _write(p, pieces.corners[n], 0)
            _write(_fan(b, first_b, end_b, k), pieces.corners[n], 9)
            pieces.bounds[n] = -math.inf
            n += 1
    return n


@inline
def _fan(surface, first, end, i):
    """A triangle of the fan of a face; a point three times, or the ends of a segment."""
    last = end - 1
    return _Triangle(
        row(surface.vertices, surface.face_vertices[first]),
        row(surface.vertices, surface.face_vertices[min(last, first + i + 1)]),
        row(surface.vertices, surface.face_vertices[min(last, first + i + 2)]),
    )


@inline
def bound_of_pieces(faces, displacement, whole, target, near, pieces):
    """A bound on two faces by pieces, cut until each piece stays above the target.

    Args:
        faces: a `PosedPair` of faces. whole: [m] a bound on both. pieces: `TrianglePairs`, overwritten.
        target: [m] pieces above it are not cut. It falls to `near` [m] below the least distance seen.
    """
    n = _begin(faces, pieces)
    least = math.inf
    if n == 0:
        return PieceBound(whole, least)
    lower_bound = math.inf
    n_visited = 0
    while n > 0:
        n -= 1
        p, q = _read(pieces.corners[n], 0), _read(pieces.corners[n], 9)
        seen = _bounded(p, q, faces.frames.m, displacement)
        n_visited += 1
        least = min(least, seen.value)
        target = min(target, least - near)
        bound = max(whole, max(pieces.bounds[n], seen.bound))
        if bound >= target or n_visited + n >= MOST_PIECES or n + 2 > MOST_WAITING:
            lower_bound = min(lower_bound, bound)
            continue
        size_a, size_b = _longest_sq(p), _longest_sq(q)
        cut_a = seen.unlike_a > seen.unlike_b
        if max(seen.unlike_a, seen.unlike_b) < 0.25 * near:
            cut_a = size_a > size_b
        if (size_a if cut_a else size_b) <= 0.0:
            cut_a = not cut_a
        if (size_a if cut_a else size_b) <= 0.0:
            lower_bound = min(lower_bound, bound)
            continue
        one, other = _halves(p if cut_a else q)
        pieces.bounds[n] = pieces.bounds[n + 1] = bound
        if cut_a:
            _write(one, pieces.corners[n], 0)
            _write(other, pieces.corners[n + 1], 0)
            _write(q, pieces.corners[n + 1], 9)
        else:
            _write(one, pieces.corners[n], 9)
            _write(p, pieces.corners[n + 1], 0)
            _write(other, pieces.corners[n + 1], 9)
        n += 2
    return PieceBound(lower_bound, least)

"""Distances of single pairs of polygons, in batches, without trees."""

import math
from typing import NamedTuple

import numpy as np

from clearance.compile.declared import Flags, Floats, Floats3
from clearance.compile.decorators import inline, kernel
from clearance.compile.lending import lend
from clearance.kernels.arithmetic.double_double import FRAMES_AT_REST, minus3, rounded
from clearance.kernels.arithmetic.predicates import new_exact_scratch
from clearance.kernels.arithmetic.vec3 import Vec3, cross, dot, row, sub
from clearance.kernels.features.bounds import (
    SLACK,
    direction_between,
    lower_bound_faces_along_direction,
)
from clearance.kernels.features.common_point import common_point
from clearance.kernels.features.every_feature import FeatureCutoff
from clearance.kernels.features.face_pair import limit_of, may_meet, nearest_of_faces, nothing_yet
from clearance.kernels.features.meeting import meeting
from clearance.kernels.features.posed_pair import PosedPair
from clearance.kernels.features.refine import NOTHING_REFINED, error_of, refine
from clearance.kernels.mesh.face_planes import plane_of, unit
from clearance.kernels.mesh.surface import ANYTHING, Surface

UNDERFLOWN = 2.0**-400
"""Distance in scaled coordinates below which squares underflow: 10^-180 of the polygons' size."""

LEAST = 2.0**-1074
"""[m] The least double: half of it is lost when a tiny answer is scaled back."""


class PolygonPairAnswers(NamedTuple):
    """One row a polygon pair.

    Attributes:
        distance, error: (k,) [m]. points: (k, 2, 3) witness points [m].
        contact: (k,) bool. exact: (k,) True where the decision took exact arithmetic.
    """

    distance: Floats
    error: Floats
    points: Floats3
    contact: Flags
    exact: Flags


@inline
def _empty_surface(n):
    """Arrays for one polygon of n vertices that owns all its features."""
    nodes, singles = np.empty((0, 3)), np.empty((0, 4), dtype=np.float32)
    none = np.empty(0, dtype=np.int64)
    ends = np.array([0, n])
    around = np.arange(n)
    n_edges = n + max(0, n - 3)
    edges = np.empty((n_edges, 2), dtype=np.int64)
    for i in range(n):
        edges[i, 0] = i
        edges[i, 1] = (i + 1) % n
    for i in range(n, n_edges):  # diagonals
        edges[i, 0] = 0
        edges[i, 1] = i - n + 2
    return Surface(
        np.empty((n, 3)), np.empty((n, 3)), ends, around, np.empty((1, 3)), np.empty(1), np.empty(1),
        np.empty(1, dtype=np.bool_), np.empty((n, 3)), ends, around, np.array([0, n_edges]), edges,
        np.full(1, ANYTHING, dtype=np.uint16),
        nodes, singles, singles, np.empty((0, 2), dtype=np.int32),
        none, none, none, np.empty(0, dtype=np.int32), none, nodes, np.empty(0),
    )  # fmt: skip


@inline
def _order(p, i, q, j):
    """-1, 0 or 1: the order of two points by their coordinates."""
    for axis in range(3):
        if p[i, axis] != q[j, axis]:
            return -1 if p[i, axis] < q[j, axis] else 1
    return 0


@inline
def _first_corner(points):
    """The corner from which the polygon, read round, is least: the same one however it is rotated."""
    n = points.shape[0]
    best = 0
    for i in range(1, n):
        for k in range(n):
            order = _order(points, (i + k) % n, points, (best + k) % n)
            if order < 0:
                best = i
            if order != 0:
                break
    return best


@inline
def _comes_first(p, first_p, q, first_q):
    """True if p is the first of the two, whichever way they are given."""
    n, m = p.shape[0], q.shape[0]
    if n != m:
        return n < m
    for k in range(n):
        order = _order(p, (first_p + k) % n, q, (first_q + k) % m)
        if order != 0:
            return order < 0
    return True


@inline
def _scale_of(ps, qs, origin):
    """The power of two that makes the greatest coordinate difference about 2^200.

    Then products of four lengths stay finite, and products with the least doubles keep their digits.
    """
    most = 0.0
    for axis in range(3):
        for i in range(ps.shape[0]):
            most = max(most, abs(ps[i, axis] - origin[axis]))
        for i in range(qs.shape[0]):
            most = max(most, abs(qs[i, axis] - origin[axis]))
    if not most > 0.0:
        return 1.0, 1.0
    k = max(-500, min(1000, 200 - math.frexp(most)[1]))
    return math.ldexp(1.0, k), math.ldexp(1.0, -k)


@inline
def _fill(surface, points, first, origin, scale):
    """Puts one polygon, read from its first corner, and its plane data into `surface`; its greatest reach."""
    n = points.shape[0]
    reach = 0.0
    for i in range(n):
        total = 0.0
        for axis in range(3):
            x = points[(first + i) % n, axis]
            surface.exact[i, axis] = x * scale
            surface.vertices[i, axis] = (x - origin[axis]) * scale
            total += abs(surface.vertices[i, axis])
        reach = max(reach, total)
    normal, blunt, width = plane_of(surface.vertices, surface.face_vertices, 0, n)
    surface.blunt[0], surface.width[0] = blunt, width
    surface.bent[0] = n > 3
    for i in range(n):
        along_edge = sub(row(surface.vertices, (i + 1) % n), row(surface.vertices, i))
        outward = unit(cross(along_edge, normal))
        for axis in range(3):
            surface.corner_normals[i, axis] = outward[axis]
    for axis in range(3):
        surface.normals[0, axis] = normal[axis]
    return reach


@inline
def _measure(faces, margin, exact):
    """(distance, error, p, q, contact) of the two polygons that are filled in."""
    a, b = faces.surface_a, faces.surface_b
    frames = faces.frames
    near = nearest_of_faces(a, 0, b, 0, frames.m, margin, nothing_yet(np.inf))
    direction = direction_between(near.best.p, near.best.q, frames.m)
    if lower_bound_faces_along_direction(a, 0, b, 0, direction) <= margin and may_meet(
        a, 0, b, 0, frames.m, margin
    ):
        found = meeting(faces, exact)
        if found.found:
            common = common_point(faces, found)
            return 0.0, 0.0, rounded(common.p), rounded(common.q), True
    limit = limit_of(a, 0, b, 0, np.sqrt(near.best.gap_sq), margin)
    cutoff = FeatureCutoff(limit, margin)
    refined = refine(faces, near.seen, cutoff, NOTHING_REFINED)
    distance = refined.length.hi
    error = error_of(refined, distance)
    if distance < UNDERFLOWN:  # its square is not a number any more
        d = rounded(minus3(refined.q, refined.p))
        most = max(abs(d.x), max(abs(d.y), abs(d.z)))
        distance = 0.0
        if most > 0.0:
            d = Vec3(d.x / most, d.y / most, d.z / most)
            distance = most * np.sqrt(dot(d, d))
        error = 2.0 * distance
    return distance, error, rounded(refined.p), rounded(refined.q), False


@inline
def nearest_each(ps, qs, lent_p, lent_q, exact, answers):
    """Fills `answers`, with arrays for one polygon of each side."""
    a_p, b_q = lent_p, lent_q
    for k in range(ps.shape[0]):
        first_p, first_q = _first_corner(ps[k]), _first_corner(qs[k])
        in_order = _comes_first(ps[k], first_p, qs[k], first_q)
        origin = ps[k, first_p] if in_order else qs[k, first_q]
        scale, unscale = _scale_of(ps[k], qs[k], origin)
        reach = _fill(a_p, ps[k], first_p, origin, scale)
        reach += _fill(b_q, qs[k], first_q, origin, scale)
        margin = 4.0 * SLACK * reach
        before = exact.count[0]
        a, b = lent_p, lent_q
        if not in_order:
            a, b = lent_q, lent_p
        faces = PosedPair(a, 0, b, 0, FRAMES_AT_REST)
        distance, error, p, q, contact = _measure(faces, margin, exact)
        if not in_order:
            p, q = q, p
        answers.distance[k] = distance * unscale
        error *= unscale
        answers.error[k] = error if error > 0.0 or contact else LEAST
        answers.contact[k] = contact
        answers.exact[k] = exact.count[0] > before
        for axis in range(3):
            answers.points[k, 0, axis] = p[axis] * unscale
            answers.points[k, 1, axis] = q[axis] * unscale
    return 0


@kernel
def nearest_polygons(ps: Floats3, qs: Floats3, answers: PolygonPairAnswers):
    """Fills `answers` for each pair `ps[k]`, `qs[k]`; all arrays contiguous and writable."""
    a_p, b_q = _empty_surface(ps.shape[1]), _empty_surface(qs.shape[1])
    nearest_each(ps, qs, lend(a_p), lend(b_q), new_exact_scratch(), answers)
    a_p.blunt[0] = b_q.blunt[0] = 0.0  # so both surfaces exist until here

"""All feature pairs of two faces that could be the nearest, in double-double, if the first is not proven.

Doubles exclude pairs that are farther than a limit or whose feet are clearly outside; the others are measured. Not
for: the usual case, in which one feature pair and its lower bound suffice (`refine`).
"""

import math
from typing import NamedTuple

from clearance.compile.decorators import inline
from clearance.kernels.arithmetic.double_double import Wide, less, lesser, minus, wide
from clearance.kernels.arithmetic.vec3 import Vec3, dot, gap_sq, move, move_back, row, sub
from clearance.kernels.features.face_pair import has_plane, height, may_be_over
from clearance.kernels.features.feature import Feature, n_segments, segment, simplex
from clearance.kernels.features.segments import (
    may_be_inside,
    may_be_inside_both,
    nearest_on_segment,
)
from clearance.kernels.features.wide_features import Simplex, size_features


class FeatureCutoff(NamedTuple):
    """Which features must be measured.

    Attributes:
        limit, margin: [m] as in `face_pair`.
    """

    limit: float
    margin: float


class NearestFeatures(NamedTuple):
    """The nearest feature pair so far, its squared distance [m^2], and a lower bound on all measured ones [m]."""

    gap_sq: Wide
    feature: Feature
    sure: Wide


class PosedCorner(NamedTuple):
    """A vertex `at` of one body, its point in the frame of the other [m], and True if it is of body a."""

    at: int
    y: Vec3
    simplex: Simplex
    is_a: bool


@inline
def _with_feature(frames, one, two, feature, best):
    """`best`, or a feature pair that is nearer."""
    sized = size_features(frames, one, two)
    found_sq = sized.pair.gap_sq
    if found_sq.hi == math.inf:
        return best
    sure = lesser(best.sure, minus(sized.length, sized.off))
    if less(found_sq, best.gap_sq):
        return NearestFeatures(found_sq, feature, sure)
    return NearestFeatures(best.gap_sq, best.feature, sure)


@inline
def _corner_of(one, at, frames, is_a):
    """The vertex `at` of one body, seen from the other."""
    v, x = row(one.vertices, at), row(one.exact, at)
    y = move_back(frames.m, v) if is_a else move(frames.m, v)
    return PosedCorner(at, y, Simplex(1, x, x, x), is_a)


@inline
def _with_corner(frames, corner, other, n_corners, k, best):
    """`best`, or a vertex against feature `k` of the other body, of so many corners, where that is nearer."""
    if corner.is_a:
        feature = Feature(1, corner.at, n_corners, k)
        return _with_feature(frames, corner.simplex, other, feature, best)
    feature = Feature(n_corners, k, 1, corner.at)
    return _with_feature(frames, other, corner.simplex, feature, best)


@inline
def _corner_to_face(corner, two, face, frames, cutoff, best):
    """`best` with a vertex of one body against the triangles of the fan of a face of the other."""
    y = corner.y
    if has_plane(two, face):
        if abs(height(two, face, y)) > cutoff.limit or not may_be_over(two, face, y, cutoff.margin):
            return best
    for k in range(two.face_starts[face] + 1, two.face_starts[face + 1] - 1):
        best = _with_corner(frames, corner, simplex(two, face, 3, k), 3, k, best)
    return best


@inline
def _corner_to_segments(corner, two, face, frames, cutoff, best):
    """`best` with a vertex of one body against the segments of a face of the other."""
    y = corner.y
    for s in range(n_segments(two, face)):
        i0, i1 = segment(two, face, s)
        start, end = row(two.vertices, i0), row(two.vertices, i1)
        if not may_be_inside(y, start, end, cutoff.margin):
            continue
        if gap_sq(y, nearest_on_segment(y, start, end)) > cutoff.limit * cutoff.limit:
            continue
        best = _with_corner(frames, corner, simplex(two, face, 2, s), 2, s, best)
    return best


@inline
def _are_far(p0, p1, q0, q1, limit):
    """True if the distance of two segments clearly exceeds a limit, by the plane between their middles."""
    u, v = sub(p1, p0), sub(q1, q0)
    w = Vec3(
        0.5 * ((q0.x + q1.x) - (p0.x + p1.x)),
        0.5 * ((q0.y + q1.y) - (p0.y + p1.y)),
        0.5 * ((q0.z + q1.z) - (p0.z + p1.z)),
    )
    length_sq = dot(w, w)
    spare = length_sq - 0.5 * (abs(dot(w, u)) + abs(dot(w, v)))
    return spare > 0.0 and spare * spare > limit * limit * length_sq * (1.0 + 1e-9)


@inline
def _between_corners(a, face_a, b, face_b, frames, cutoff, best):
    """`best` with corners against corners."""
    for n in range(b.vertex_starts[face_b], b.vertex_starts[face_b + 1]):
        j = b.owned_vertices[n]
        y = move(frames.m, row(b.vertices, j))
        for o in range(a.vertex_starts[face_a], a.vertex_starts[face_a + 1]):
            i = a.owned_vertices[o]
            if gap_sq(row(a.vertices, i), y) <= cutoff.limit * cutoff.limit:
                one, two = simplex(a, face_a, 1, i), simplex(b, face_b, 1, j)
                best = _with_feature(frames, one, two, Feature(1, i, 1, j), best)
    return best


@inline
def _between_segments(a, face_a, b, face_b, frames, cutoff, best):
    """`best` with the insides of the segments of both faces."""
    for j in range(n_segments(b, face_b)):
        j0, j1 = segment(b, face_b, j)
        q0, q1 = move(frames.m, row(b.vertices, j0)), move(frames.m, row(b.vertices, j1))
        for i in range(n_segments(a, face_a)):
            i0, i1 = segment(a, face_a, i)
            p0, p1 = row(a.vertices, i0), row(a.vertices, i1)
            if _are_far(p0, p1, q0, q1, cutoff.limit):
                continue
            if may_be_inside_both(p0, p1, q0, q1, cutoff.margin):
                one, two = simplex(a, face_a, 2, i), simplex(b, face_b, 2, j)
                best = _with_feature(frames, one, two, Feature(2, i, 2, j), best)
    return best


@inline
def nearest_of_every(a, face_a, b, face_b, frames, cutoff):
    """The nearest feature pair of two faces among those within the limit; infinitely far if there is none."""
    best = NearestFeatures(wide(math.inf), Feature(1, 0, 1, 0), wide(math.inf))
    one, face_one, two, face_two = a, face_a, b, face_b
    for side in range(2):
        is_a = side == 0
        for n in range(one.vertex_starts[face_one], one.vertex_starts[face_one + 1]):
            corner = _corner_of(one, one.owned_vertices[n], frames, is_a)
            best = _corner_to_face(corner, two, face_two, frames, cutoff, best)
            best = _corner_to_segments(corner, two, face_two, frames, cutoff, best)
        one, face_one, two, face_two = b, face_b, a, face_a
    best = _between_corners(a, face_a, b, face_b, frames, cutoff, best)
    return _between_segments(a, face_a, b, face_b, frames, cutoff, best)

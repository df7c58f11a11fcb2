"""Lower bounds on the distance of two faces along a direction: they prove that a pair of points is the nearest.

Weak duality: for any w, the distance of two convex sets is at least (min w . y - max w . x) / |w|. A face that
rounding has bent is not convex, only the triangles of its fan are; so its parts are bounded one by one.
Not for: which points are the nearest (`wide_features`).
"""

import math
from typing import NamedTuple

import numpy as np

from clearance.compile.decorators import inline
from clearance.kernels.arithmetic.double_double import (
    NOISE,
    Wide,
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
from clearance.kernels.arithmetic.vec3 import Vec3, along, cross, dot, row, sub, turn, turn_back

CLOSE = 64.0 * 2.0**-53
"""Rounding of a share in doubles, relative to the sizes of direction and corner: 12 operations, with a margin."""

TILT = 2.0**-20
"""The tilt of a direction away from the triangle under a corner, to bound the others of a bent fan."""

SURE = 2.0**-60
"""Points are proven the nearest if their lower bound is low by at most this share of their distance."""

UNSURE = 2.0**-48
"""And by at most this share of the rounding in doubles: twice the rounding of double-double."""


class CornerRange(NamedTuple):
    """The first corner of a face and the corners from `low` to before `high`, indices into `face_vertices`."""

    low: int
    high: int


class FaceCorners(NamedTuple):
    """Corners of a face, the part of a `Surface` that a bound needs.

    Attributes:
        points: (v, 3) [m] in the frame of the body. flat: (c,) indices into `points`.
        first, low, high: the corners are flat[first] and flat[low:high].
    """

    points: np.ndarray
    flat: np.ndarray
    first: int
    low: int
    high: int


@inline
def whole(surface, face):
    """All corners."""
    return CornerRange(surface.face_starts[face] + 1, surface.face_starts[face + 1])


@inline
def corners_of(surface, face, part):
    """Part of a face."""
    start = surface.face_starts[face]
    return FaceCorners(surface.exact, surface.face_vertices, start, part.low, part.high)


@inline
def _greatest_share(corners, frames, is_a, pair):
    """(share, reach): the greatest of w . (x - o), for b of w . (o - x), and the size that its rounding scales
    with.

    Only corners that are greatest within rounding are measured in double-double.
    """
    pose = frames.a if is_a else frames.b
    w = turn_back(pose, rounded(pair.w))
    if not is_a:
        w = Vec3(-w.x, -w.y, -w.z)
    most, reach = -math.inf, 0.0
    for i in range(corners.low - 1, corners.high):
        v = row(corners.points, corners.flat[i if i >= corners.low else corners.first])
        most = max(most, dot(w, v))
        reach = max(reach, size(v))
    least = most - CLOSE * size(w) * reach
    share, spread = wide(-math.inf), 0.0
    for i in range(corners.low - 1, corners.high):
        v = row(corners.points, corners.flat[i if i >= corners.low else corners.first])
        if dot(w, v) < least:
            continue
        x = point_of_a(frames, v) if is_a else point_of_b(frames, v)
        x = minus3(x, pair.o) if is_a else minus3(pair.o, x)
        spread = max(spread, size(rounded(x)))
        here = dot3(pair.w, x)
        if less(share, here):
            share = here
    return share, spread if frames.still_a and frames.still_b else spread + reach


@inline
def lower_bound_along(frames, a, b, pair):
    """[m] a lower bound on the distance of the hulls of corners of a and b: their gap along a pair's direction."""
    if not pair.w_sq.hi > 0.0:
        return wide(0.0)
    far, reach = wide(0.0), 0.0
    for side in range(2):
        share, most = _greatest_share(a if side == 0 else b, frames, side == 0, pair)
        far = plus(far, share)
        reach += most
    moved = 0.0 if frames.still_a and frames.still_b else size(rounded(frames.shift))
    noise = NOISE * (2.0 * reach + moved)
    return minus(over(Wide(-far.hi, -far.lo), root(pair.w_sq)), wide(noise))


@inline
def _plain_lower_bound(a, face_a, part_a, b, face_b, part_b, m, w):
    """[m] the same in doubles, along a direction in the frame of a."""
    far_of_a = dot(w, row(a.vertices, a.face_vertices[a.face_starts[face_a]]))
    for c in range(part_a.low, part_a.high):
        far_of_a = max(far_of_a, dot(w, row(a.vertices, a.face_vertices[c])))
    v, offset = turn_back(m, w), dot(w, m.t)
    near_of_b = dot(v, row(b.vertices, b.face_vertices[b.face_starts[face_b]]))
    for c in range(part_b.low, part_b.high):
        near_of_b = min(near_of_b, dot(v, row(b.vertices, b.face_vertices[c])))
    return (near_of_b + offset - far_of_a) / math.sqrt(dot(w, w))


@inline
def _beyond(surface, face, corner, third, w):
    """`w` (frame of the face's body), tilted towards the side of the diagonal to a corner opposite `third`."""
    flat = surface.face_vertices
    first = row(surface.vertices, flat[surface.face_starts[face]])
    aside = cross(sub(row(surface.vertices, flat[corner]), first), w)
    length = math.sqrt(dot(aside, aside))
    if not length > 0.0:
        return w
    tilt = TILT / length
    if dot(aside, sub(row(surface.vertices, flat[third]), first)) > 0.0:
        tilt = -tilt
    return along(w, tilt, aside)


@inline
def _others_are_farther(a, face_a, b, face_b, frames, k, on_a, pair, least):
    """True if all of a bent fan but the triangle with middle corner `k` is farther than `least` for certain.

    Many arguments: it is inlined into its one caller, whose locals they are.
    """
    n = rounded(pair.w)
    length = math.sqrt(dot(n, n))
    w = turn_back(frames.a, Vec3(n.x / length, n.y / length, n.z / length))
    all_a, all_b = whole(a, face_a), whole(b, face_b)
    for after in range(2):
        corner, third = (k + 1, k) if after == 1 else (k, k + 1)
        if on_a:
            part = CornerRange(k + 1, all_a.high) if after == 1 else CornerRange(all_a.low, k + 1)
            if part.high - part.low < 2:
                continue
            away = _beyond(a, face_a, corner, third, Vec3(-w.x, -w.y, -w.z))
            away = Vec3(-away.x, -away.y, -away.z)
            lower_bound = _plain_lower_bound(a, face_a, part, b, face_b, all_b, frames.m, away)
        else:
            part = CornerRange(k + 1, all_b.high) if after == 1 else CornerRange(all_b.low, k + 1)
            if part.high - part.low < 2:
                continue
            away = turn(frames.m, _beyond(b, face_b, corner, third, turn_back(frames.m, w)))
            lower_bound = _plain_lower_bound(a, face_a, all_a, b, face_b, part, frames.m, away)
        if not lower_bound > least:
            return False
    return True


@inline
def lower_bound_of(a, face_a, b, face_b, frames, feature, pair, margin):
    """[m] a lower bound on the distance of two faces, tight where `pair` is the nearest."""
    part_a, part_b = whole(a, face_a), whole(b, face_b)
    bent_a = feature.n_a == 3 and a.bent[face_a]
    if bent_a or (feature.n_b == 3 and b.bent[face_b]):
        least = math.sqrt(pair.gap_sq.hi) * (1.0 + 2.0**-40) + 2.0 * margin
        k = feature.i if bent_a else feature.j
        if _others_are_farther(a, face_a, b, face_b, frames, k, bent_a, pair, least):
            if bent_a:
                part_a = CornerRange(k, k + 2)
            else:
                part_b = CornerRange(k, k + 2)
    return lower_bound_along(
        frames, corners_of(a, face_a, part_a), corners_of(b, face_b, part_b), pair
    )

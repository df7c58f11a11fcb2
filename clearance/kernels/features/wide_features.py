"""Nearest points of two features in double-double: the parts of the answer.

A feature is a `Simplex`: a corner, an edge or a triangle of a face. Not for: which features to measure
(`face_pair`, `every_feature`) and whether the answer is the minimum (`refine`).
"""

import math
from typing import NamedTuple

from clearance.compile.decorators import inline, kernel
from clearance.kernels.arithmetic.double_double import (
    Frames,
    Wide,
    Wide3,
    along3,
    cross3,
    dot3,
    inverse,
    is_medium,
    minus,
    minus3,
    negative3,
    over,
    plus,
    point_of_a,
    point_of_b,
    root,
    rounded,
    scaled3,
    times,
    wide,
)
from clearance.kernels.arithmetic.vec3 import Vec3, dot, sub

NOT_PARALLEL = 2.0**-40
"""Squared sine of the angle above which the vector product of two edges keeps 80 bits."""

LONG = 2.0**-20
"""Squared length of a connecting line, in those of the edge, above which it keeps 90 bits of direction."""


SLENDER = 2.0**6
"""The reciprocal sine of an angle up to which the noise in every lower bound covers the rounding of its normal."""


class Simplex(NamedTuple):
    """One to three corners [m] in the frame of their body; the others repeat the last."""

    n: int
    u: Vec3
    v: Vec3
    w: Vec3


class PointPair(NamedTuple):
    """A point of each of two features, in the orientation of the world, from the origin of a.

    Attributes:
        gap_sq: [m^2] squared distance; infinite where a corner's foot is not in the triangle.
        w: the direction from p to q, of any length, right to the last digits also where p and q nearly meet.
        w_sq: its squared length.
        o: a corner of a feature, from which to measure others: differences of corners are exact.
    """

    gap_sq: Wide
    p: Wide3
    q: Wide3
    w: Wide3
    w_sq: Wide
    o: Wide3


@inline
def _share(part, whole):
    """part / whole between 0 and 1; 0 where `whole` is."""
    if not part.hi > 0.0 or not whole.hi > 0.0:
        return wide(0.0)
    return over(part, whole) if minus(whole, part).hi > 0.0 else wide(1.0)


@inline
def _across(w, d, d_sq):
    """`w` without its part along `d`: perpendicular to it to the last digits, however short `w` is."""
    if not d_sq.hi > 0.0:
        return w
    return minus3(w, scaled3(over(dot3(w, d), d_sq), d))


@inline
def _point_and_segment(x, start, end):
    """The pair of a point and its nearest point of a segment."""
    r, d = minus3(start, x), minus3(end, start)
    d_sq = dot3(d, d)
    share = _share(dot3(negative3(r), d), d_sq)
    w = along3(r, share, d)
    w_sq = gap_sq = dot3(w, w)
    if 0.0 < share.hi < 1.0 and gap_sq.hi < LONG * d_sq.hi:
        w = _across(w, d, d_sq)
        w_sq = dot3(w, w)
    return PointPair(gap_sq, x, along3(start, share, d), w, w_sq, x)


@inline
def point_and_triangle(x, a, b, c):
    """The pair of a point and its foot on a triangle's plane; infinitely far where it is not inside.

    With the foot at a + beta u + gamma v: beta |n|^2 = (r x v) . n and gamma |n|^2 = (u x r) . n.
    """
    u, v, r = minus3(b, a), minus3(c, a), minus3(x, a)
    n = cross3(u, v)
    n_sq = dot3(n, n)
    t = cross3(n, r)
    beta, minus_gamma = dot3(v, t), dot3(u, t)
    alpha = plus(minus(n_sq, beta), minus_gamma)
    if not (n_sq.hi > 0.0 and beta.hi >= 0.0 and minus_gamma.hi <= 0.0 and alpha.hi >= 0.0):
        return PointPair(wide(math.inf), x, x, n, n_sq, x)
    h = dot3(r, n)
    share = over(h, n_sq)
    foot = minus3(x, scaled3(share, n))
    return PointPair(times(h, share), x, foot, negative3(n) if h.hi > 0.0 else n, n_sq, x)


@inline
def two_segments(p0, p1, q0, q1):
    """The pair of the feet of the common perpendicular, clamped to the segments.

    Near parallelism the second foot is that of the first and then the first that of the second, so that
    their error is along the segments and not across them.
    """
    u, v, r = minus3(p1, p0), minus3(q1, q0), minus3(q0, p0)
    n = cross3(u, v)
    n_sq = dot3(n, n)
    t = cross3(n, r)
    at_p, at_q = dot3(v, t), dot3(u, t)
    inside = at_p.hi >= 0.0 and minus(n_sq, at_p).hi >= 0.0 and at_q.hi >= 0.0
    flat = NOT_PARALLEL * dot(rounded(u), rounded(u)) * dot(rounded(v), rounded(v))
    if inside and minus(n_sq, at_q).hi >= 0.0 and n_sq.hi > flat:
        h = dot3(r, n)
        if is_medium(n_sq):
            part = inverse(n_sq)
            on_p, on_q, share = times(at_p, part), times(at_q, part), times(h, part)
        else:
            on_p, on_q, share = over(at_p, n_sq), over(at_q, n_sq), over(h, n_sq)
        p, q = along3(p0, on_p, u), along3(q0, on_q, v)
        return PointPair(times(h, share), p, q, negative3(n) if h.hi < 0.0 else n, n_sq, p0)
    uv, u_sq, v_sq = dot3(u, v), dot3(u, u), dot3(v, v)
    on_p = _share(at_p, n_sq)
    on_q = _share(minus(times(on_p, uv), dot3(r, v)), v_sq)
    on_p = _share(plus(times(on_q, uv), dot3(r, u)), u_sq)
    w = minus3(along3(r, on_q, v), scaled3(on_p, u))
    gap_sq = dot3(w, w)
    if 0.0 < on_p.hi < 1.0:
        w = _across(w, u, u_sq)
    if 0.0 < on_q.hi < 1.0:
        w = _across(w, v, v_sq)
    if 0.0 < on_p.hi < 1.0:
        w = _across(w, u, u_sq)
    return PointPair(gap_sq, along3(p0, on_p, u), along3(q0, on_q, v), w, dot3(w, w), p0)


@inline
def wide_feature(frames, one, two):
    """The pair of a simplex of a and one of b, of which one is a corner or both are edges."""
    x = point_of_a(frames, one.u)
    y = point_of_b(frames, two.u)
    if one.n == 1 and two.n == 1:
        w = minus3(y, x)
        w_sq = dot3(w, w)
        return PointPair(w_sq, x, y, w, w_sq, x)
    if one.n == 2 and two.n == 2:
        return two_segments(x, point_of_a(frames, one.v), y, point_of_b(frames, two.v))
    swapped = one.n > 1
    if swapped:
        x, y = y, x
        n, v, w = one.n, point_of_a(frames, one.v), point_of_a(frames, one.w)
    else:
        n, v, w = two.n, point_of_b(frames, two.v), point_of_b(frames, two.w)
    found = _point_and_segment(x, y, v) if n == 2 else point_and_triangle(x, y, v, w)
    if swapped:
        return PointPair(found.gap_sq, found.q, found.p, negative3(found.w), found.w_sq, x)
    return found


@inline
def _unevenness(frames, corners, is_a, pair):
    """[m] the distance of a triangle's corners from the plane of its rounded normal, used for heights."""
    if corners.n < 3:
        return 0.0
    u, v = sub(corners.v, corners.u), sub(corners.w, corners.u)
    u_sq, v_sq = dot(u, u), dot(v, v)
    if u_sq * v_sq <= SLENDER * SLENDER * pair.w_sq.hi:
        return 0.0
    first = point_of_a(frames, corners.u) if is_a else point_of_b(frames, corners.u)
    second = point_of_a(frames, corners.v) if is_a else point_of_b(frames, corners.v)
    third = point_of_a(frames, corners.w) if is_a else point_of_b(frames, corners.w)
    off = abs(dot3(pair.w, minus3(second, first)).hi) + abs(dot3(pair.w, minus3(third, first)).hi)
    return 2.0 * off / math.sqrt(pair.w_sq.hi)


@inline
def too_far(frames, one, two, pair, length):
    """[m] the most by which a height along a rounded normal, of a triangle or two segments, may be too great."""
    if one.n == 2 and two.n == 2:
        u, v = sub(one.v, one.u), sub(two.v, two.u)
        if dot(u, u) * dot(v, v) <= SLENDER * SLENDER * pair.w_sq.hi:
            return wide(0.0)
        between = minus3(pair.q, pair.p)
        short = minus(root(dot3(between, between)), length)
        return short if short.hi > 0.0 else wide(0.0)
    return wide(_unevenness(frames, one, True, pair) + _unevenness(frames, two, False, pair))


class PointDistance(NamedTuple):
    """A pair of points of two features, their distance [m], and how much of it may be too much (`too_far`) [m]."""

    pair: PointPair
    length: Wide
    off: Wide


@kernel
def size_features(frames: Frames, one: Simplex, two: Simplex) -> PointDistance:
    """A feature pair in double-double; infinitely far where a corner's foot is not in the triangle."""
    pair = wide_feature(frames, one, two)
    if pair.gap_sq.hi == math.inf:
        return PointDistance(pair, pair.gap_sq, wide(0.0))
    length = root(pair.gap_sq)
    return PointDistance(pair, length, too_far(frames, one, two, pair, length))

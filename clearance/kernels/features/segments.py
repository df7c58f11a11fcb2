"""Nearest points of points and segments, and of two segments inside both, in doubles."""

import math

from clearance.compile.decorators import inline
from clearance.kernels.arithmetic.vec3 import along, cross, dot, sub


@inline(force=True)
def nearest_on_segment(x, start, end):
    """The point of the segment nearest to `x`; an end point where the foot lies beyond it."""
    d = sub(end, start)
    length_sq = dot(d, d)
    if not length_sq > 0.0:
        return start
    s = dot(sub(x, start), d) / length_sq
    if s <= 0.0:
        return start
    if s >= 1.0:
        return end
    if s > 0.5:  # step from the nearer end: less rounding
        return along(end, dot(sub(x, end), d) / length_sq, d)
    return along(start, s, d)


@inline(force=True)
def foot_inside(x, start, end):
    """(inside, foot): the foot of `x` on the line, if strictly between the ends."""
    d = sub(end, start)
    length_sq = dot(d, d)
    along_d = dot(sub(x, start), d)
    if not 0.0 < along_d < length_sq:
        return False, start
    if along_d > 0.5 * length_sq:  # step from the nearer end: less rounding
        return True, along(end, dot(sub(x, end), d) / length_sq, d)
    return True, along(start, along_d / length_sq, d)


@inline(force=True)
def _may_still_be_inside(over, u, v, r, n_sq, margin):
    """True if feet beyond the ends by `over` / |n|^2 may be inside, given the rounding of the ends.

    False if the segments are parallel within rounding: then they are no nearer inside than at the ends.
    """
    u_sq, v_sq = dot(u, u), dot(v, v)
    rounding = margin * math.sqrt(u_sq * v_sq) * math.sqrt(u_sq + v_sq + dot(r, r))
    return over <= rounding and n_sq > margin * margin * (u_sq + v_sq)


@inline(force=True)
def common_perpendicular(p0, p1, q0, q1, margin):
    """(inside, p, q): the feet of the common perpendicular of two segments, if inside both.

    Near parallelism rounding moves the feet far: feet just beyond an end are put at the end. Parallel segments
    have none: their minimum is at an end point, which other candidates cover. The second foot is the foot of the
    first one. Rounded independently near parallelism, their distance would be off by the root of the rounding
    instead of the rounding itself.
    Source: cross-product form of Eberly 2015; measured the most accurate of four near parallelism.
    """
    u = sub(p1, p0)
    v = sub(q1, q0)
    r = sub(q0, p0)
    n = cross(u, v)
    n_sq = dot(n, n)
    s = dot(cross(r, v), n)
    t = dot(cross(r, u), n)
    is_inside = 0.0 < s < n_sq and 0.0 < t < n_sq
    if not is_inside:
        over = max(max(-s, s - n_sq), max(-t, t - n_sq))
        if not _may_still_be_inside(over, u, v, r, n_sq, margin):
            return False, p0, q0
    p = along(p0, s / n_sq, u)
    if not is_inside:
        p = nearest_on_segment(p, p0, p1)
    return True, p, nearest_on_segment(p, q0, q1)


@inline(force=True)
def may_be_inside(x, start, end, margin):
    """True unless the foot of `x` on the line is beyond the ends by more than rounding."""
    d = sub(end, start)
    length_sq = dot(d, d)
    s = dot(sub(x, start), d)
    tolerance = LOOSE * length_sq + margin * (abs(d.x) + abs(d.y) + abs(d.z))
    return -tolerance <= s <= length_sq + tolerance


@inline(force=True)
def may_be_inside_both(p0, p1, q0, q1, margin):
    """True unless the common perpendicular misses one of the segments by more than rounding."""
    u = sub(p1, p0)
    v = sub(q1, q0)
    r = sub(q0, p0)
    n = cross(u, v)
    n_sq = dot(n, n)
    u_sq, v_sq = dot(u, u), dot(v, v)
    if n_sq <= NEARLY_PARALLEL * u_sq * v_sq:
        return u_sq > 0.0 and v_sq > 0.0
    s = dot(cross(r, v), n) / n_sq
    t = dot(cross(r, u), n) / n_sq
    far = margin * STEEPEST
    tolerance_s = LOOSE + far / max(abs(u.x), max(abs(u.y), abs(u.z)))
    tolerance_t = LOOSE + far / max(abs(v.x), max(abs(v.y), abs(v.z)))
    return -tolerance_s <= s <= 1.0 + tolerance_s and -tolerance_t <= t <= 1.0 + tolerance_t


LOOSE = 2.0**-10
"""Share of a segment's length beyond its ends that still counts as inside in a filter."""

NEARLY_PARALLEL = 2.0**-30
"""Squared sine of the angle below which a common perpendicular is not judged in doubles."""

STEEPEST = 2.0**15
"""The reciprocal of that sine: how much it magnifies rounding."""

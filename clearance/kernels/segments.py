"""Nearest points of points and segments, and of two segments inside both."""

from clearance.jit import inlined
from clearance.kernels.vec3 import along, cross, dot, sub


@inlined
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


@inlined
def common_perpendicular(p0, p1, q0, q1):
    """(inside, p, q): the feet of the common perpendicular of two segments, if inside both.

    Parallel segments have none: their minimum is attained at an end point, which other candidates cover.
    Source: cross-product form of Eberly 2015; measured the most accurate of four near parallelism.
    """
    u = sub(p1, p0)
    v = sub(q1, q0)
    r = sub(q0, p0)
    n = cross(u, v)
    n_sq = dot(n, n)
    s = dot(cross(r, v), n)
    t = dot(cross(r, u), n)
    if not (0.0 < s < n_sq and 0.0 < t < n_sq):
        return False, p0, q0
    return True, along(p0, s / n_sq, u), along(q0, t / n_sq, v)

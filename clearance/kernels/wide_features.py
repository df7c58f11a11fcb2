"""Nearest points of segments and triangles in wide numbers: what the answer is made of."""

from clearance.jit import inlined
from clearance.kernels.double_double import (
    Wide,
    Wide3,
    along3,
    cross3,
    dot3,
    less,
    minus,
    minus3,
    over,
    wide,
)


@inlined
def wide_gap_sq(p, q):
    """The squared distance of two points."""
    d = minus3(p, q)
    return dot3(d, d)


@inlined
def wide_on_segment(x, start, end):
    """The point of a segment nearest to `x`, an end exactly where the foot is not inside."""
    d = minus3(end, start)
    length_sq = dot3(d, d)
    s = dot3(minus3(x, start), d)
    if not s.hi > 0.0 or not length_sq.hi > 0.0:
        return start
    from_end = minus(length_sq, s)
    if not from_end.hi > 0.0:
        return end
    if less(from_end, s):
        back = over(from_end, length_sq)
        return along3(end, wide(0.0), d) if back.hi == 0.0 else minus3(end, _scaled(back, d))
    return along3(start, over(s, length_sq), d)


@inlined
def _scaled(s, d):
    zero = minus3(d, d)
    return along3(zero, s, d)


@inlined
def wide_between_segments(p0, p1, q0, q1):
    """(p, q): points of two segments next to their common perpendicular.

    They are on the segments whatever the angle; the second is the foot of the first and then the first
    that of the second, so that near parallelism costs nothing across them.
    """
    u = minus3(p1, p0)
    v = minus3(q1, q0)
    n = cross3(u, v)
    n_sq = dot3(n, n)
    if not n_sq.hi > 0.0:
        return p0, wide_on_segment(p0, q0, q1)
    s = over(dot3(cross3(minus3(q0, p0), v), n), n_sq)
    p = along3(p0, s, u)
    if not s.hi > 0.0:
        p = p0
    elif s.hi >= 1.0:
        p = p1
    q = wide_on_segment(p, q0, q1)
    return wide_on_segment(q, p0, p1), q


@inlined
def _is_left(normal, start, end, x):
    return dot3(normal, cross3(minus3(end, start), minus3(x, start))).hi >= 0.0


@inlined
def wide_normal(a, b, c):
    """The normal of a triangle, as long as twice its area."""
    return cross3(minus3(b, a), minus3(c, a))


@inlined
def wide_over_triangle(x, a, b, c, n):
    """(over, foot): the foot of `x` on the plane of a triangle with normal `n`, if in the triangle."""
    n_sq = dot3(n, n)
    if not n_sq.hi > 0.0:
        return False, x
    if not (_is_left(n, a, b, x) and _is_left(n, b, c, x) and _is_left(n, c, a, x)):
        return False, x
    share = over(dot3(minus3(x, a), n), n_sq)
    return True, minus3(x, _scaled(share, n))


@inlined
def wide_on_triangle(x, a, b, c, n):
    """The point of a triangle with normal `n` that is nearest to `x`."""
    inside, best = wide_over_triangle(x, a, b, c, n)
    if inside:
        return best
    best = wide_on_segment(x, a, b)
    other = wide_on_segment(x, b, c)
    if less(wide_gap_sq(x, other), wide_gap_sq(x, best)):
        best = other
    other = wide_on_segment(x, c, a)
    if less(wide_gap_sq(x, other), wide_gap_sq(x, best)):
        best = other
    return best


@inlined
def across(w, start, end):
    """`w` without its part along a segment: perpendicular to it to the last digits, however short `w` is."""
    d = minus3(end, start)
    length_sq = dot3(d, d)
    if not length_sq.hi > 0.0:
        return w
    return minus3(w, _scaled(over(dot3(w, d), length_sq), d))


@inlined
def toward(n, w):
    """`n` or its opposite, whichever points along `w`."""
    if dot3(n, w).hi < 0.0:
        return Wide3(
            Wide(-n.x.hi, -n.x.lo), Wide(-n.y.hi, -n.y.lo), Wide(-n.z.hi, -n.z.lo)
        )
    return n


@inlined
def across_both(w, p0, p1, q0, q1):
    """The common perpendicular of two segments along `w`; near parallelism `w` made perpendicular to both."""
    u, v = minus3(p1, p0), minus3(q1, q0)
    n = cross3(u, v)
    if dot3(n, n).hi > WELL_APART * dot3(u, u).hi * dot3(v, v).hi:
        return toward(n, w)
    return across(across(across(w, p0, p1), q0, q1), p0, p1)


WELL_APART = 2.0**-40
"""Squared sine of the angle above which the vector product of two edges keeps 80 bits."""

"""Exact signs, and whether segments and triangles have a point in common, for float vertices under float poses.

A posed point is R v + t without rounding. A determinant is first computed in doubles with its error bound;
where that does not decide the sign, in expansions, which are exact. Not for: faces (`meeting`).

Source: Shewchuk 1997 for expansions; Guigue & Devillers 2003 for triangles by orientations.
"""

from typing import NamedTuple

import numpy as np

from clearance.compile.declared import Floats, Floats2, Floats3, Integers
from clearance.compile.decorators import inline
from clearance.kernels.arithmetic.double_double import size
from clearance.kernels.arithmetic.expansion import grow, grow_product, sign_of, two_sum
from clearance.kernels.arithmetic.vec3 import Vec3, dot, row, sub

CAPACITY = 512
"""Terms an expansion can grow to; compressed ones have at most 40 (2100 bits of 53 each)."""

FILTER = 32.0 * 2.0**-53
"""Error of a plain determinant and of its posed differences, relative to products of 1-norms: 14 and 9
roundings, with a margin."""


class ExactScratch(NamedTuple):
    """Scratch of exact arithmetic.

    Attributes:
        sides: (9, CAPACITY), lengths: (9,): three difference vectors as expansions.
        minor, total: (CAPACITY,).
        count: (1,) decisions that needed exact arithmetic.
        poses: (2, 3, 3) the rotations of a and b. shift: (2, 3) origin of b minus origin of a, hi and lo.
    """

    sides: Floats2
    lengths: Integers
    minor: Floats
    total: Floats
    count: Integers
    poses: Floats3
    shift: Floats2


class PosedVertex(NamedTuple):
    """A vertex of one of two bodies, which is 0 for a and 1 for b: the number of shifts to add."""

    v: Vec3
    body: int


@inline
def new_exact_scratch():
    """Scratch of one exact decision at a time."""
    return ExactScratch(
        np.empty((9, CAPACITY)),
        np.zeros(9, dtype=np.int64),
        np.empty(CAPACITY),
        np.empty(CAPACITY),
        np.zeros(1, dtype=np.int64),
        np.empty((2, 3, 3)),
        np.empty((2, 3)),
    )


@inline
def compress(terms, n):
    """The same number in as few terms as possible; their new number. Source: Shewchuk 1997, figure 15."""
    if n < 2:
        return n
    bottom = n - 1
    q = terms[bottom]
    for i in range(n - 2, -1, -1):
        s, e = two_sum(q, terms[i])
        q = s
        if e != 0.0:
            terms[bottom] = s
            bottom -= 1
            q = e
    terms[bottom] = q
    top = 0
    for i in range(bottom + 1, n):
        s, e = two_sum(terms[i], q)
        q = s
        if e != 0.0:
            terms[top] = e
            top += 1
    terms[top] = q
    return top + 1


@inline
def _add_products(out, n, e, n_e, f, n_f, sign):
    """Adds sign * e * f of two expansions to `out`."""
    for i in range(n_e):
        for j in range(n_f):
            if n + 2 > CAPACITY:
                raise AssertionError("no room for the product")
            n = grow_product(out, n, sign * e[i], f[j])
    return compress(out, n)


@inline
def _coordinate(exact, axis, p, q, out):
    """Writes the coordinate of p - q as an expansion; its number of terms."""
    turn_p, turn_q = exact.poses[p.body, axis], exact.poses[q.body, axis]
    n = grow_product(out, 0, turn_p[0], p.v.x)
    n = grow_product(out, n, turn_p[1], p.v.y)
    n = grow_product(out, n, turn_p[2], p.v.z)
    n = grow_product(out, n, -turn_q[0], q.v.x)
    n = grow_product(out, n, -turn_q[1], q.v.y)
    n = grow_product(out, n, -turn_q[2], q.v.z)
    for part in range(2):
        n = grow(out, n, (p.body - q.body) * exact.shift[part, axis])
    return compress(out, n)


@inline
def _difference(exact, i, p, q):
    """Writes the vector p - q into the sides 3 i, 3 i + 1, 3 i + 2."""
    for axis in range(3):
        exact.lengths[3 * i + axis] = _coordinate(exact, axis, p, q, exact.sides[3 * i + axis])


@inline
def _minor(exact, i, j):
    """Writes side[i] side[3 + j] - side[j] side[3 + i] of vectors given by their first sides; its length."""
    e, n = exact.sides, exact.lengths
    k = _add_products(exact.minor, 0, e[3 + i], n[3 + i], e[6 + j], n[6 + j], 1.0)
    return _add_products(exact.minor, k, e[3 + j], n[3 + j], e[6 + i], n[6 + i], -1.0)


@inline
def _turned(exact, p):
    """R v of a posed vertex, rounded."""
    m = exact.poses[p.body]
    return Vec3(dot(row(m, 0), p.v), dot(row(m, 1), p.v), dot(row(m, 2), p.v))


@inline
def approximate_difference(p, q, exact):
    """(p - q rounded, error of each coordinate)."""
    if p.body == q.body:
        d = sub(p.v, q.v)
        return _turned(exact, PosedVertex(d, p.body)), FILTER * size(d)
    f = p.body - q.body
    t = row(exact.shift, 0)
    d = sub(_turned(exact, p), _turned(exact, q))
    if size(t) == 0.0 and _are_still(exact):
        return d, FILTER * size(d)
    return Vec3(f * t.x + d.x, f * t.y + d.y, f * t.z + d.z), FILTER * (
        size(p.v) + size(q.v) + size(t)
    )


@inline
def _are_still(exact):
    """True if both rotations are the identity."""
    for body in range(2):
        for i in range(3):
            for j in range(3):
                if exact.poses[body, i, j] != (1.0 if i == j else 0.0):
                    return False
    return True


@inline
def orient_posed(a, b, c, d, exact):
    """The exact sign of det [a-d; b-d; c-d]; 0 where the four points are coplanar."""
    p, e_p = approximate_difference(a, d, exact)
    q, e_q = approximate_difference(b, d, exact)
    r, e_r = approximate_difference(c, d, exact)
    yz, zy, zx, xz = q.y * r.z, q.z * r.y, q.z * r.x, q.x * r.z
    xy, yx = q.x * r.y, q.y * r.x
    det = p.x * (yz - zy) + p.y * (zx - xz) + p.z * (xy - yx)
    s_p, s_q, s_r = size(p), size(q), size(r)
    permanent = (
        abs(p.x) * (abs(yz) + abs(zy))
        + abs(p.y) * (abs(zx) + abs(xz))
        + abs(p.z) * (abs(xy) + abs(yx))
    )
    error = FILTER * permanent + 2.0 * (
        e_p * (s_q + e_q) * (s_r + e_r) + s_p * (e_q * (s_r + e_r) + s_q * e_r)
    )
    if abs(det) > error:
        return 1 if det > 0.0 else -1
    if s_p + e_p == 0.0 or s_q + e_q == 0.0 or s_r + e_r == 0.0:
        return 0
    exact.count[0] += 1
    _difference(exact, 0, a, d)
    _difference(exact, 1, b, d)
    _difference(exact, 2, c, d)
    n = 0
    for k in range(3):
        n_minor = _minor(exact, (k + 1) % 3, (k + 2) % 3)
        n = _add_products(
            exact.total, n, exact.sides[k], exact.lengths[k], exact.minor, n_minor, 1.0
        )
    return sign_of(exact.total, n)


@inline
def turn_along(a, b, c, axis, exact):
    """The exact sign of (a - c) x (b - c) along a coordinate axis."""
    p, e_p = approximate_difference(a, c, exact)
    q, e_q = approximate_difference(b, c, exact)
    i = (axis + 1) % 3
    j = (axis + 2) % 3
    left, right = p[i] * q[j], p[j] * q[i]
    s_p, s_q = size(p), size(q)
    error = FILTER * (abs(left) + abs(right)) + 2.0 * (e_p * (s_q + e_q) + s_p * e_q)
    if abs(left - right) > error:
        return 1 if left > right else -1
    if s_p + e_p == 0.0 or s_q + e_q == 0.0:
        return 0
    exact.count[0] += 1
    _difference(exact, 1, a, c)
    _difference(exact, 2, b, c)
    return sign_of(exact.minor, _minor(exact, i, j))


@inline
def side_along(a, b, axis, exact):
    """The exact sign of the coordinate of a - b."""
    d, error = approximate_difference(a, b, exact)
    if abs(d[axis]) > error:
        return 1 if d[axis] > 0.0 else -1
    _difference(exact, 0, a, b)
    return sign_of(exact.sides[axis], exact.lengths[axis])


@inline
def _boxes_meet(a, b, c, d, axis, exact):
    """True if the intervals of the segments a b and c d on an axis meet."""
    ends, others = (a, b), (c, d)
    n_above, n_below = 0, 0
    for i in range(4):
        side = side_along(ends[i // 2], others[i % 2], axis, exact)
        n_above += side > 0
        n_below += side < 0
    return n_above < 4 and n_below < 4


@inline
def _segments_meet_along(a, b, c, d, axis, exact):
    """True if the segments a b and c d, seen along an axis, have a point in common."""
    for k in range(1, 3):
        if not _boxes_meet(a, b, c, d, (axis + k) % 3, exact):
            return False
    corners = (a, b, c, d)
    for i in range(2):
        j = 2 - 2 * i
        product = 1
        for k in range(2):
            product *= turn_along(corners[2 * i], corners[2 * i + 1], corners[j + k], axis, exact)
        if product > 0:
            return False
    return True


@inline
def segments_meet(a, b, c, d, exact):
    """True if two segments have a point in common.

    They do if they are coplanar and meet along every axis: along one of them their plane (or line) is seen
    without loss, and the others are necessary.
    """
    if orient_posed(a, b, c, d, exact) != 0:
        return False
    for axis in range(3):
        if not _segments_meet_along(a, b, c, d, axis, exact):
            return False
    return True


@inline
def _holds_in_plane(a, b, c, x, exact):
    """True if the triangle a b c has area and holds x, which is in its plane."""
    tails, heads, thirds = (a, a, b, c), (b, b, c, a), (c, x, x, x)
    for axis in range(3):
        n_left, n_right = 0, 0
        for i in range(4):
            turn = turn_along(tails[i], heads[i], thirds[i], axis, exact)
            if i == 0 and turn == 0:
                break  # seen along this axis the triangle has no area
            if i > 0:
                n_left += turn > 0
                n_right += turn < 0
        else:
            return n_left == 0 or n_right == 0
    return False


@inline
def segment_meets_triangle(p, q, a, b, c, exact):
    """True if the closed segment p q and the closed triangle a b c have a point in common.

    Loops instead of a call for each sign: the predicates are long, and each call may be merged.
    """
    ends, ring = (p, q), (a, b, c, a)
    n_left, n_right = 0, 0
    for i in range(3):
        turn = orient_posed(p, q, ring[i], ring[i + 1], exact)
        n_left += turn > 0
        n_right += turn < 0
        if n_left > 0 and n_right > 0:
            return False  # the line misses the triangle
    n_above, n_below = 0, 0
    for i in range(2):
        side = orient_posed(a, b, c, ends[i], exact)
        n_above += side > 0
        n_below += side < 0
    if n_above == 2 or n_below == 2:
        return False
    if n_above + n_below > 0:
        return True
    for i in range(3):
        if segments_meet(p, q, ring[i], ring[i + 1], exact):
            return True
    return _holds_in_plane(a, b, c, p, exact)


@inline
def set_poses(frames, exact):
    """Puts the poses of two bodies where the predicates look for them."""
    poses = exact.poses
    for body in range(2):
        m = frames.a if body == 0 else frames.b
        poses[body, 0, 0], poses[body, 0, 1], poses[body, 0, 2] = m.xx, m.xy, m.xz
        poses[body, 1, 0], poses[body, 1, 1], poses[body, 1, 2] = m.yx, m.yy, m.yz
        poses[body, 2, 0], poses[body, 2, 1], poses[body, 2, 2] = m.zx, m.zy, m.zz
    t = frames.shift
    exact.shift[0, 0], exact.shift[0, 1], exact.shift[0, 2] = t.x.hi, t.y.hi, t.z.hi
    exact.shift[1, 0], exact.shift[1, 1], exact.shift[1, 2] = t.x.lo, t.y.lo, t.z.lo

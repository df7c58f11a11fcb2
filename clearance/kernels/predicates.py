"""Whether two faces have a point in common, exactly, for float vertices under float poses.

A posed point is R v + t without rounding. A determinant is first computed in doubles with its error bound;
where that does not tell the sign, in expansions, which are exact. A face is the union of the triangles of
its fan from the first corner, so that a face bent by rounding is one definite surface.

Source: Shewchuk 1997 for expansions; Guigue & Devillers 2003 for triangles by orientations.
"""

from typing import NamedTuple

import numpy as np

from clearance.jit import inlined, kernel
from clearance.kernels.double_double import is_still, size
from clearance.kernels.expansion import grow, grow_product, sign_of, two_sum
from clearance.kernels.vec3 import Rigid, Vec3, row, sub, turn

ROOM = 512
"""Terms an expansion can grow to; compressed ones have at most 40 (2100 bits of 53 each)."""

FILTER = 32.0 * 2.0**-53
"""Error of a plain determinant and of its posed differences, relative to products of 1-norms: 14 and 9
roundings, with room."""


class Exact(NamedTuple):
    """Room for exact arithmetic.

    Attributes:
        sides: (9, ROOM), lengths: (9,): three difference vectors as expansions.
        minor, total: (ROOM,).
        count: (1,) decisions that needed exact arithmetic.
    """

    sides: np.ndarray
    lengths: np.ndarray
    minor: np.ndarray
    total: np.ndarray
    count: np.ndarray


class Posed(NamedTuple):
    """A vertex of one of two bodies: the rotation of its body, itself, and how many shifts to add (0 or 1)."""

    pose: Rigid
    v: Vec3
    shifts: float


@inlined
def room_for_exact():
    """Room for one exact decision at a time."""
    return Exact(
        np.empty((9, ROOM)),
        np.zeros(9, dtype=np.int64),
        np.empty(ROOM),
        np.empty(ROOM),
        np.zeros(1, dtype=np.int64),
    )


@inlined
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


@inlined
def _add_products(out, n, e, n_e, f, n_f, sign):
    """Adds sign * e * f of two expansions to `out`."""
    for i in range(n_e):
        for j in range(n_f):
            assert n + 2 <= ROOM
            n = grow_product(out, n, sign * e[i], f[j])
    return compress(out, n)


@inlined
def _coordinate(out, ax, ay, az, p, bx, by, bz, q, hi, lo):
    """Writes a . p - b . q + hi + lo as an expansion; its number of terms."""
    n = grow_product(out, 0, ax, p.x)
    n = grow_product(out, n, ay, p.y)
    n = grow_product(out, n, az, p.z)
    n = grow_product(out, n, -bx, q.x)
    n = grow_product(out, n, -by, q.y)
    n = grow_product(out, n, -bz, q.z)
    n = grow(out, n, hi)
    return compress(out, grow(out, n, lo))


@inlined
def _difference(exact, i, p, q, shift):
    """Writes the vector p - q into the sides 3 i, 3 i + 1, 3 i + 2."""
    a, b, f = p.pose, q.pose, p.shifts - q.shifts
    out, n = exact.sides, exact.lengths
    k = 3 * i
    n[k] = _coordinate(
        out[k], a.xx, a.xy, a.xz, p.v, b.xx, b.xy, b.xz, q.v, f * shift.x.hi, f * shift.x.lo
    )
    n[k + 1] = _coordinate(
        out[k + 1], a.yx, a.yy, a.yz, p.v, b.yx, b.yy, b.yz, q.v, f * shift.y.hi, f * shift.y.lo
    )
    n[k + 2] = _coordinate(
        out[k + 2], a.zx, a.zy, a.zz, p.v, b.zx, b.zy, b.zz, q.v, f * shift.z.hi, f * shift.z.lo
    )


@inlined
def _minor(exact, i, j):
    """Writes side[i] side[3 + j] - side[j] side[3 + i] of vectors given by their first sides; its length."""
    e, n = exact.sides, exact.lengths
    k = _add_products(exact.minor, 0, e[3 + i], n[3 + i], e[6 + j], n[6 + j], 1.0)
    return _add_products(exact.minor, k, e[3 + j], n[3 + j], e[6 + i], n[6 + i], -1.0)


@inlined
def approximate_difference(p, q, shift):
    """(p - q rounded, error of each coordinate)."""
    f = p.shifts - q.shifts
    if f == 0.0:
        d = sub(p.v, q.v)
        return turn(p.pose, d), FILTER * size(d)
    x = turn(p.pose, p.v)
    y = turn(q.pose, q.v)
    d = Vec3(
        f * shift.x.hi + (x.x - y.x), f * shift.y.hi + (x.y - y.y), f * shift.z.hi + (x.z - y.z)
    )
    shifted = abs(shift.x.hi) + abs(shift.y.hi) + abs(shift.z.hi)
    if shifted == 0.0 and is_still(p.pose) and is_still(q.pose):
        return d, FILTER * size(d)
    return d, FILTER * (size(p.v) + size(q.v) + shifted)


@inlined
def orient_posed(a, b, c, d, shift, exact):
    """The exact sign of det [a-d; b-d; c-d]; 0 where the four points are coplanar."""
    p, e_p = approximate_difference(a, d, shift)
    q, e_q = approximate_difference(b, d, shift)
    r, e_r = approximate_difference(c, d, shift)
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
    _difference(exact, 0, a, d, shift)
    _difference(exact, 1, b, d, shift)
    _difference(exact, 2, c, d, shift)
    n = 0
    for k in range(3):
        n_minor = _minor(exact, (k + 1) % 3, (k + 2) % 3)
        n = _add_products(
            exact.total, n, exact.sides[k], exact.lengths[k], exact.minor, n_minor, 1.0
        )
    return sign_of(exact.total, n)


@inlined
def _turn_along(a, b, c, axis, shift, exact):
    """The exact sign of (a - c) x (b - c) along a coordinate axis."""
    p, e_p = approximate_difference(a, c, shift)
    q, e_q = approximate_difference(b, c, shift)
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
    _difference(exact, 1, a, c, shift)
    _difference(exact, 2, b, c, shift)
    return sign_of(exact.minor, _minor(exact, i, j))


@inlined
def _side(a, b, axis, shift, exact):
    """The exact sign of the coordinate of a - b."""
    d, error = approximate_difference(a, b, shift)
    if abs(d[axis]) > error:
        return 1 if d[axis] > 0.0 else -1
    _difference(exact, 0, a, b, shift)
    return sign_of(exact.sides[axis], exact.lengths[axis])


@inlined
def _boxes_meet(a, b, c, d, axis, shift, exact):
    """True if the intervals of the segments a b and c d on an axis meet."""
    ac = _side(a, c, axis, shift, exact)
    ad = _side(a, d, axis, shift, exact)
    bc = _side(b, c, axis, shift, exact)
    bd = _side(b, d, axis, shift, exact)
    above = ac > 0 and ad > 0 and bc > 0 and bd > 0
    below = ac < 0 and ad < 0 and bc < 0 and bd < 0
    return not (above or below)


@inlined
def _segments_meet_along(a, b, c, d, axis, shift, exact):
    """True if the segments a b and c d, seen along an axis, have a point in common."""
    if not _boxes_meet(a, b, c, d, (axis + 1) % 3, shift, exact):
        return False
    if not _boxes_meet(a, b, c, d, (axis + 2) % 3, shift, exact):
        return False
    if (
        _turn_along(a, b, c, axis, shift, exact) * _turn_along(a, b, d, axis, shift, exact) > 0
    ):
        return False
    return _turn_along(c, d, a, axis, shift, exact) * _turn_along(c, d, b, axis, shift, exact) <= 0


@inlined
def segments_meet(a, b, c, d, shift, exact):
    """True if two segments have a point in common.

    They do if they are coplanar and meet along every axis: along one of them their plane (or line) is seen
    without loss, and the others are necessary.
    """
    if orient_posed(a, b, c, d, shift, exact) != 0:
        return False
    for axis in range(3):
        if not _segments_meet_along(a, b, c, d, axis, shift, exact):
            return False
    return True


@inlined
def _holds_in_plane(a, b, c, x, shift, exact):
    """True if the triangle a b c has area and holds x, which is in its plane."""
    for axis in range(3):
        if _turn_along(a, b, c, axis, shift, exact) != 0:
            i = _turn_along(a, b, x, axis, shift, exact)
            j = _turn_along(b, c, x, axis, shift, exact)
            k = _turn_along(c, a, x, axis, shift, exact)
            return (i >= 0 and j >= 0 and k >= 0) or (i <= 0 and j <= 0 and k <= 0)
    return False


@inlined
def segment_meets_triangle(p, q, a, b, c, shift, exact):
    """True if the closed segment p q and the closed triangle a b c have a point in common."""
    side_p = orient_posed(a, b, c, p, shift, exact)
    side_q = orient_posed(a, b, c, q, shift, exact)
    if side_p * side_q > 0:
        return False
    if side_p != 0 or side_q != 0:
        i = orient_posed(p, q, a, b, shift, exact)
        j = orient_posed(p, q, b, c, shift, exact)
        if i * j < 0:
            return False
        k = orient_posed(p, q, c, a, shift, exact)
        return i * k >= 0 and j * k >= 0
    return (
        segments_meet(p, q, a, b, shift, exact)
        or segments_meet(p, q, b, c, shift, exact)
        or segments_meet(p, q, c, a, shift, exact)
        or _holds_in_plane(a, b, c, p, shift, exact)
    )


@inlined
def _posed(surface, corner, pose, shifts):
    return Posed(pose, row(surface.exact, surface.face_vertices[corner]), shifts)


@inlined
def _edges_meet_face(one, face_one, pose_one, shifts_one, two, face_two, pose_two, shifts_two, shift, exact):
    """True if an edge of the fan of `face_one` meets a triangle of that of `face_two`."""
    start, end = one.face_starts[face_one], one.face_starts[face_one + 1]
    other, last = two.face_starts[face_two], two.face_starts[face_two + 1]
    a = _posed(two, other, pose_two, shifts_two)
    first = _posed(one, start, pose_one, shifts_one)
    for k in range(other + 1, last - 1):
        b = _posed(two, k, pose_two, shifts_two)
        c = _posed(two, k + 1, pose_two, shifts_two)
        for i in range(start + 1, end):
            p = _posed(one, i, pose_one, shifts_one)
            if segment_meets_triangle(first, p, a, b, c, shift, exact):
                return True
            if i + 1 < end:
                q = _posed(one, i + 1, pose_one, shifts_one)
                if segment_meets_triangle(p, q, a, b, c, shift, exact):
                    return True
    return False


@kernel
def faces_meet(a, face_a, b, face_b, frames, exact):
    """True if two faces have a point in common, exactly."""
    shift = frames.shift
    return _edges_meet_face(
        a, face_a, frames.a, 0.0, b, face_b, frames.b, 1.0, shift, exact
    ) or _edges_meet_face(b, face_b, frames.b, 1.0, a, face_a, frames.a, 0.0, shift, exact)

"""Exact arithmetic on float64: a number as a sum of doubles that do not overlap, and signs of small determinants.

Every function is exact as long as nothing overflows or falls below the least double: all coordinates zero or
between 2^-300 and 2^300 in magnitude is enough. Not for: deciding what a sign means.

Source: Shewchuk, Adaptive Precision Floating-Point Arithmetic, 1997, theorems 7, 10, 17, 18 and section 4.
"""

from __future__ import annotations

from clearance.compile.decorators import inline, when_compiling

N_TERMS = 128
"""Room for the longest expansion here: 24 products of three coordinates, four terms each, and one spare."""

SPLITTER = 134217729.0  # 2^27 + 1
_FILTER_3D = 7.771561172376103e-16  # (7 + 56 u) u with u = 2^-53, Shewchuk's o3derrboundA
_FILTER_2D = 3.3306690738754716e-16  # (3 + 16 u) u, Shewchuk's ccwerrboundA


@inline
def two_sum(a, b):
    """(s, e) with s = fl(a + b) and a + b = s + e exactly."""
    s = a + b
    b_part = s - a
    return s, (a - (s - b_part)) + (b - b_part)


def rest_by_splitting(a, b, p):
    """a b - p for p = fl(a b), in 16 operations. Source: Dekker 1971."""
    wide = SPLITTER * a
    a_high = wide - (wide - a)
    a_low = a - a_high
    wide = SPLITTER * b
    b_high = wide - (wide - b)
    b_low = b - b_high
    return a_low * b_low - (((p - a_high * b_high) - a_low * b_high) - a_high * b_low)


def _rest_fused():
    """The same by one fused multiply-subtract: half the time on processors that have it, equal bits."""
    from numba import types
    from numba.extending import intrinsic

    from clearance.compile.intrinsics import stands_for

    number = types.float64

    @intrinsic
    def fused(typing_context, a, b, p):
        def emit(context, builder, signature, values):
            x, y, product = values
            return builder.fma(x, y, builder.fneg(product))

        return number(number, number, number), emit

    stands_for(rest_by_splitting, fused)


when_compiling.append(_rest_fused)


@inline
def two_product(a, b):
    """(p, e) with p = fl(a b) and a b = p + e exactly."""
    p = a * b
    return p, rest_by_splitting(a, b, p)


@inline
def grow(terms, n_terms, value):
    """Adds `value` to the expansion in place and returns its new number of terms; zero terms are dropped."""
    n_used = 0
    total = value
    for i in range(n_terms):
        total, rest = two_sum(total, terms[i])
        if rest != 0.0:
            terms[n_used] = rest
            n_used += 1
    if total != 0.0:
        terms[n_used] = total
        n_used += 1
    return n_used


@inline
def grow_product(terms, n_terms, a, b):
    """Adds a b to the expansion."""
    p, e = two_product(a, b)
    return grow(terms, grow(terms, n_terms, e), p)


@inline
def grow_product3(terms, n_terms, a, b, c):
    """Adds a b c to the expansion."""
    p, e = two_product(a, b)
    return grow_product(terms, grow_product(terms, n_terms, e, c), p, c)


@inline
def sign_of(terms, n_terms):
    """-1, 0 or 1: the sign of an expansion, which is that of its last (greatest) term."""
    if n_terms == 0:
        return 0
    return 1 if terms[n_terms - 1] > 0.0 else -1


@inline
def orient2d(ax, ay, bx, by, cx, cy, terms):
    """The exact sign of (a - c) x (b - c): 1 where a, b, c turn left. `terms`: scratch of N_TERMS doubles."""
    left = (ax - cx) * (by - cy)
    right = (ay - cy) * (bx - cx)
    det = left - right
    if abs(det) > _FILTER_2D * (abs(left) + abs(right)):
        return 1 if det > 0.0 else -1
    n = grow_product(terms, 0, ax, by)
    n = grow_product(terms, n, -ay, bx)
    n = grow_product(terms, n, bx, cy)
    n = grow_product(terms, n, -by, cx)
    n = grow_product(terms, n, cx, ay)
    n = grow_product(terms, n, -cy, ax)
    return sign_of(terms, n)


@inline
def _determinant3(p, q, r, terms, n):
    """Adds det [p; q; r] to the expansion."""
    n = grow_product3(terms, n, p[0], q[1], r[2])
    n = grow_product3(terms, n, -p[0], q[2], r[1])
    n = grow_product3(terms, n, p[1], q[2], r[0])
    n = grow_product3(terms, n, -p[1], q[0], r[2])
    n = grow_product3(terms, n, p[2], q[0], r[1])
    return grow_product3(terms, n, -p[2], q[1], r[0])


@inline
def _difference(a, d):
    """(a - d rounded, True if it is exact)."""
    x, x_rest = two_sum(a[0], -d[0])
    y, y_rest = two_sum(a[1], -d[1])
    z, z_rest = two_sum(a[2], -d[2])
    return (x, y, z), x_rest == 0.0 and y_rest == 0.0 and z_rest == 0.0


@inline
def orient3d(a, b, c, d, terms):
    """The exact sign of det [a-d; b-d; c-d]; 0 where the four points are coplanar.

    Args:
        a, b, c, d: points, anything indexable by 0, 1, 2.
        terms: scratch of N_TERMS doubles.
    """
    p, p_exact = _difference(a, d)
    q, q_exact = _difference(b, d)
    r, r_exact = _difference(c, d)
    yz, zy, zx, xz = q[1] * r[2], q[2] * r[1], q[2] * r[0], q[0] * r[2]
    xy, yx = q[0] * r[1], q[1] * r[0]
    det = p[0] * (yz - zy) + p[1] * (zx - xz) + p[2] * (xy - yx)
    permanent = (
        abs(p[0]) * (abs(yz) + abs(zy))
        + abs(p[1]) * (abs(zx) + abs(xz))
        + abs(p[2]) * (abs(xy) + abs(yx))
    )
    if abs(det) > _FILTER_3D * permanent:
        return 1 if det > 0.0 else -1
    if p_exact and q_exact and r_exact:
        return sign_of(terms, _determinant3(p, q, r, terms, 0))
    minus_d = (-d[0], -d[1], -d[2])
    n = _determinant3(
        a, b, c, terms, 0
    )  # det [a-d; b-d; c-d] is the sum of these four, by linearity
    n = _determinant3(minus_d, b, c, terms, n)
    n = _determinant3(a, minus_d, c, terms, n)
    n = _determinant3(a, b, minus_d, terms, n)
    return sign_of(terms, n)

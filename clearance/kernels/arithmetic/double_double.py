"""Numbers of 106 bits as unevaluated sums of two doubles, vectors of them, and points under a rigid motion.

Every operation is right to a few 2^-104 of its operands' magnitudes as long as nothing overflows or falls
below the least double. Not for: decisions that must be exact (`predicates`).

Source: Dekker 1971; Joldes, Muller & Popescu, Tight and rigorous error bounds for basic building blocks of
double-word arithmetic, 2017 (algorithms 5, 11, 17).
"""

import math
from typing import NamedTuple

from clearance.compile.decorators import inline
from clearance.kernels.arithmetic.expansion import two_product, two_sum
from clearance.kernels.arithmetic.vec3 import RigidMotion, Vec3, relative

NOISE = 2.0**-96
"""Rounding of the points and products here, relative to the magnitudes of the coordinates: 50 operations
of 2^-103 each, doubled."""


class Wide(NamedTuple):
    """The number hi + lo with |lo| at most half an ulp of hi."""

    hi: float
    lo: float


class Wide3(NamedTuple):
    """A point or vector [m] of double-double numbers."""

    x: Wide
    y: Wide
    z: Wide


class Frames(NamedTuple):
    """Where two bodies are, in the orientation of the world and seen from the origin of a.

    Attributes:
        a, b: `world_from_body`; their origins are used only through `shift`.
        m: `a_from_b`, rounded.
        shift: origin of b minus origin of a, exact.
        defect: how far the rotations are from orthonormal.
        still_a, still_b: True for the identity rotation.
    """

    a: RigidMotion
    b: RigidMotion
    m: RigidMotion
    shift: Wide3
    defect: float
    still_a: bool
    still_b: bool


ZERO3 = Wide3(Wide(0.0, 0.0), Wide(0.0, 0.0), Wide(0.0, 0.0))
FAR = Wide(math.inf, 0.0)
"""The origin and a distance above all others, for what kernels begin with."""


def _frames_at_rest():
    still = RigidMotion(1.0, 0.0, 0.0, 0.0, 1.0, 0.0, 0.0, 0.0, 1.0, Vec3(0.0, 0.0, 0.0))
    return Frames(still, still, still, ZERO3, 0.0, True, True)


FRAMES_AT_REST = _frames_at_rest()
"""Two bodies that stand in one frame."""


@inline
def _renormal(hi, lo):
    s = hi + lo
    return Wide(s, lo - (s - hi))


@inline
def wide(x):
    """The double-double number equal to a double."""
    return Wide(x, 0.0)


@inline
def plus(a, b):
    """a + b, right to 2^-104 (|a| + |b|); exact for sums of two doubles."""
    s, e = two_sum(a.hi, b.hi)
    return _renormal(s, e + (a.lo + b.lo))


@inline
def minus(a, b):
    """a - b."""
    return plus(a, Wide(-b.hi, -b.lo))


@inline
def times(a, b):
    """a b."""
    p, e = two_product(a.hi, b.hi)
    return _renormal(p, e + (a.hi * b.lo + a.lo * b.hi))


@inline
def _by_long_division(a, b):
    first = a.hi / b.hi
    rest = minus(a, times(b, wide(first)))
    second = rest.hi / b.hi
    rest = minus(rest, times(b, wide(second)))
    quotient = _renormal(first, second)
    return plus(quotient, wide(rest.hi / b.hi))


@inline
def inverse(b):
    """1 / b by one division and a step of Newton's, right to 2^-103; of a `b` that `is_medium`."""
    first = 1.0 / b.hi
    p, e = two_product(b.hi, first)
    rest = ((1.0 - p) - e) - b.lo * first
    return _renormal(first, first * rest)


@inline
def is_medium(b):
    """True if neither `b` nor 1 / b comes near the least or the greatest double."""
    return 2.0**-900 < abs(b.hi) < 2.0**900


@inline
def over(a, b):
    """a / b for b other than 0."""
    if is_medium(b):
        return times(a, inverse(b))
    return _by_long_division(a, b)


@inline
def root(a):
    """The square root of a number that is not negative."""
    if not a.hi > 0.0:
        return wide(0.0)
    first = math.sqrt(a.hi)
    rest = minus(a, times(wide(first), wide(first)))
    return _renormal(first, rest.hi / (2.0 * first))


@inline
def less(a, b):
    """a < b."""
    return a.hi < b.hi or (a.hi == b.hi and a.lo < b.lo)


@inline
def lesser(a, b):
    """The lesser of two."""
    return a if less(a, b) else b


@inline
def plus3(a, b):
    """a + b."""
    return Wide3(plus(a.x, b.x), plus(a.y, b.y), plus(a.z, b.z))


@inline
def minus3(a, b):
    """a - b."""
    return Wide3(minus(a.x, b.x), minus(a.y, b.y), minus(a.z, b.z))


@inline
def scaled3(s, a):
    """s a."""
    return Wide3(times(s, a.x), times(s, a.y), times(s, a.z))


@inline
def negative3(a):
    """-a."""
    return Wide3(Wide(-a.x.hi, -a.x.lo), Wide(-a.y.hi, -a.y.lo), Wide(-a.z.hi, -a.z.lo))


@inline
def along3(a, s, d):
    """a + s d."""
    return Wide3(plus(a.x, times(s, d.x)), plus(a.y, times(s, d.y)), plus(a.z, times(s, d.z)))


@inline
def dot3(a, b):
    """The scalar product."""
    return plus(plus(times(a.x, b.x), times(a.y, b.y)), times(a.z, b.z))


@inline
def cross3(a, b):
    """The vector product."""
    return Wide3(
        minus(times(a.y, b.z), times(a.z, b.y)),
        minus(times(a.z, b.x), times(a.x, b.z)),
        minus(times(a.x, b.y), times(a.y, b.x)),
    )


@inline
def _product_sum(a, x, b, y, c, z):
    p, e = two_product(a, x)
    q, f = two_product(b, y)
    r, g = two_product(c, z)
    return plus(plus(Wide(p, e), Wide(q, f)), Wide(r, g))


@inline
def is_still(m):
    """True for the identity rotation."""
    off = abs(m.xy) + abs(m.xz) + abs(m.yx) + abs(m.yz) + abs(m.zx) + abs(m.zy)
    return off == 0.0 and m.xx == 1.0 and m.yy == 1.0 and m.zz == 1.0


@inline
def turned(m, v):
    """R v of a plain vector."""
    return Wide3(
        _product_sum(m.xx, v.x, m.xy, v.y, m.xz, v.z),
        _product_sum(m.yx, v.x, m.yy, v.y, m.yz, v.z),
        _product_sum(m.zx, v.x, m.zy, v.y, m.zz, v.z),
    )


@inline
def difference(a, b):
    """a - b of plain vectors, exact."""
    x, e = two_sum(a.x, -b.x)
    y, f = two_sum(a.y, -b.y)
    z, g = two_sum(a.z, -b.z)
    return Wide3(Wide(x, e), Wide(y, f), Wide(z, g))


@inline
def rounded(a):
    """The nearest plain vector."""
    return Vec3(a.x.hi, a.y.hi, a.z.hi)


@inline
def size(v):
    """The sum of the coordinates' magnitudes."""
    return abs(v.x) + abs(v.y) + abs(v.z)


@inline
def _row_defect(ax, ay, az, bx, by, bz, expected):
    return abs(ax * bx + ay * by + az * bz - expected)


@inline
def defect_of(m):
    """How far R^T R is from the identity: a bound on the norm of the difference."""
    far = _row_defect(m.xx, m.yx, m.zx, m.xx, m.yx, m.zx, 1.0)
    far += _row_defect(m.xy, m.yy, m.zy, m.xy, m.yy, m.zy, 1.0)
    far += _row_defect(m.xz, m.yz, m.zz, m.xz, m.yz, m.zz, 1.0)
    far += 2.0 * _row_defect(m.xx, m.yx, m.zx, m.xy, m.yy, m.zy, 0.0)
    far += 2.0 * _row_defect(m.xx, m.yx, m.zx, m.xz, m.yz, m.zz, 0.0)
    return far + 2.0 * _row_defect(m.xy, m.yy, m.zy, m.xz, m.yz, m.zz, 0.0)


@inline
def frames_of(world_from_a, world_from_b):
    """The frames of two bodies at given poses (`RigidMotion`)."""
    a, b = world_from_a, world_from_b
    shift = difference(b.t, a.t)
    return Frames(
        a, b, relative(a, b), shift, defect_of(a) + defect_of(b), is_still(a), is_still(b)
    )


@inline
def point_of_a(frames, v):
    """A point of a (body frame), seen from the origin of a in the orientation of the world."""
    if frames.still_a:
        return Wide3(wide(v.x), wide(v.y), wide(v.z))
    return turned(frames.a, v)


@inline
def point_of_b(frames, v):
    """A point of b (body frame), seen from the origin of a in the orientation of the world."""
    if frames.still_b:
        return plus3(Wide3(wide(v.x), wide(v.y), wide(v.z)), frames.shift)
    return plus3(turned(frames.b, v), frames.shift)

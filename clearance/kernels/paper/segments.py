"""Closest points of two segments by Lumelsky's algorithm, the building stone of the first paper.

Kept as published for `method="paper"` alone. Its divisor D1 D2 - R^2 loses digits between
near-parallel segments; the exact method has its own segments in `kernels.features.segments`.

Source: Lumelsky, V. J. (1985), On fast computation of distance between line segments, Information
Processing Letters 21, 55-61.
"""

from typing import NamedTuple

from clearance.compile.decorators import inline
from clearance.kernels.arithmetic.vec3 import Vec3, along, dot, sub


class ClosestPoints(NamedTuple):
    """The closest points p, q of two segments and their places t, u in [0, 1]; 0 and 1 are the
    ends."""

    p: Vec3
    q: Vec3
    t: float
    u: float


@inline
def clamped(x):
    """The nearest number in [0, 1]."""
    return 0.0 if x < 0.0 else (1.0 if x > 1.0 else x)


@inline
def lumelsky(a, b, c, d):
    """The closest points of the segments a b and c d; a point is a segment of length zero.

    Steps as numbered in the source: 1 degenerate segments, 2 the line of a b (t = 0 for parallel
    lines), 3 the foot u on the other line, 4 clamped with t corrected to it. Ties: for parallel
    segments the foot of `a`, where it is on c d.
    """
    d1, d2, d12 = sub(b, a), sub(d, c), sub(c, a)
    length_1, length_2, r = dot(d1, d1), dot(d2, d2), dot(d1, d2)
    s1, s2 = dot(d1, d12), dot(d2, d12)
    t, u = 0.0, 0.0
    if length_2 == 0.0:
        t = clamped(s1 / length_1) if length_1 > 0.0 else 0.0
    elif length_1 == 0.0:
        u = clamped(-s2 / length_2)
    else:
        divisor = length_1 * length_2 - r * r
        t = clamped((s1 * length_2 - s2 * r) / divisor) if divisor > 0.0 else 0.0
        foot = (t * r - s2) / length_2
        u = clamped(foot)
        if u != foot:
            t = clamped((u * r + s1) / length_1)
    p = b if t == 1.0 else along(a, t, d1)
    q = d if u == 1.0 else along(c, u, d2)
    return ClosestPoints(p, q, t, u)

"""Clouds: bodies of points, each the centre of a ball. The search measures the points; the radii are subtracted
last.

Other bodies have the radius 0, so one search serves all. Not for: the search (`descent`).
"""

import math
from typing import NamedTuple

from clearance.compile.decorators import inline
from clearance.kernels.arithmetic.double_double import minus, wide
from clearance.kernels.arithmetic.vec3 import along, dot, sub


class Radii(NamedTuple):
    """[m] of the balls of two bodies, and their sum, rounded up."""

    a: float
    b: float
    both: float


UP = 1.0 + 2.0**-52
"""Makes a sum of two radii no less than the true one."""


@inline
def radii_of(a, body_a, b, body_b):
    """The radii of the balls of two bodies, 0 where they are no clouds."""
    of_a, of_b = a.radii[body_a], b.radii[body_b]
    both = of_a + of_b
    if of_a > 0.0 and of_b > 0.0:
        both *= UP
    return Radii(of_a, of_b, both)


@inline
def less_balls(length, error, p, q, radii):
    """(distance, error, p, q) [m] of two balls. Their centres have a `Wide` distance, known to within an error.

    The difference is taken in 106 bits and rounded once. Balls that touch have distance 0 and one point. It lies
    on the other body where only one is a cloud.
    """
    remaining = minus(minus(length, wide(radii.a)), wide(radii.b))
    d = sub(q, p)
    far = math.sqrt(dot(d, d))
    if remaining.hi <= 0.0:
        share = min(radii.a, far) / far if far > 0.0 else 0.0
        p = along(p, share, d)
        return 0.0, max(0.0, error + remaining.hi), p, p
    of_a, of_b = radii.a / far, radii.b / far
    return remaining.hi, error + abs(remaining.lo), along(p, of_a, d), along(q, -of_b, d)

"""The depth of two convex bodies with integer corners, squared, as a fraction.

Every face of the Minkowski difference is normal to a face of a body, or to an edge of each. All planes through
three corners and all pairs of corner differences hold those, and a direction that is no face's only gives a
longer way out. Slow and obvious. Not for: more than about eight corners.
"""

from __future__ import annotations

import itertools
from fractions import Fraction

from tests.oracle.rationals import Point, cross, dot, minus


def squared_depth(a: list[Point], b: list[Point]) -> Fraction:
    """The square of the shortest translation that parts the hulls of `a` and `b`; 0 where they are apart."""
    least = None
    for n in _normals(a, b):
        out = max(dot(n, q) for q in b) - min(dot(n, p) for p in a)
        if out <= 0:
            return Fraction(0)
        square = Fraction(out * out, dot(n, n))
        least = square if least is None or square < least else least
    return least


def _normals(a: list[Point], b: list[Point]):
    for corners in (a, b):
        for p, q, r in itertools.combinations(corners, 3):
            yield from _both(cross(minus(q, p), minus(r, p)))
    edges = [[minus(q, p) for p, q in itertools.combinations(c, 2)] for c in (a, b)]
    for e, f in itertools.product(*edges):
        yield from _both(cross(e, f))


def _both(n: Point):
    if any(n):
        yield n
        yield (-n[0], -n[1], -n[2])

"""The region shared by convex bodies, exactly: half-space enumeration in integers.

Every three planes meet in at most one point; the corners of the region are those that satisfy all
half-spaces. Volumes are sums of exact tetrahedra over fans of the corners in each plane. Slow
(cubic in the number of planes) and obvious; shares no code with the package.
"""

from __future__ import annotations

import math
from collections.abc import Iterable
from fractions import Fraction
from itertools import combinations

from tests.oracle.rationals import Point, cross, dot, exact_points, minus, on_grid

Row = tuple[int, int, int, int]
"""n and d of n . x <= d, four integers without a common divisor: one for each half-space."""


def half_spaces(points: Iterable[Iterable[float]]) -> set[Row]:
    """n.x <= d of every face of the hull of few points, exactly, each plane once."""
    scale, (exact,) = on_grid(exact_points(points))
    found = set()
    for a, b, c in combinations(exact, 3):
        n = cross(minus(b, a), minus(c, a))
        sides = [dot(n, minus(p, a)) for p in exact]
        if not any(n) or (min(sides) < 0 < max(sides)):
            continue
        if max(sides) > 0:
            n = minus((0, 0, 0), n)
        found.add(_reduced((*(scale * x for x in n), dot(n, a))))
    return found


def _reduced(row: Row) -> Row:
    shared = math.gcd(*row)
    return tuple(x // shared for x in row)


def corners(rows: Iterable[Row]) -> list[tuple[Fraction, ...]]:
    """All points where three planes meet and every half-space holds."""
    rows = sorted(set(rows))
    found = set()
    for p, q, r in combinations(rows, 3):
        pq, qr, rp = cross(p, q), cross(q, r), cross(r, p)
        det = dot(p, qr)
        if det == 0:
            continue
        sign = 1 if det > 0 else -1
        x = tuple(sign * (p[3] * qr[i] + q[3] * rp[i] + r[3] * pq[i]) for i in range(3))
        if all(dot(row, x) <= row[3] * abs(det) for row in rows):
            found.add(tuple(Fraction(each, abs(det)) for each in x))
    return sorted(found)


def shared_volume(*bodies: Iterable[Iterable[float]]) -> Fraction:
    """The exact volume shared by the hulls of several sets of points; 0 where they only touch."""
    rows = set().union(*(half_spaces(body) for body in bodies))
    found = corners(rows)
    if len(found) < 4:
        return Fraction(0)
    scale, (grid,) = on_grid(found)
    six = sum(
        _cone(row, [p for p in grid if dot(row, p) == row[3] * scale], grid[0]) for row in rows
    )
    return Fraction(six, 6 * scale**3)


def _cone(row: Row, flat: list[Point], apex: Point) -> int:
    """Six times the volume of the pyramid from `apex` over the corners `flat` in the row's plane."""
    if len(flat) < 3:
        return 0
    edges = [
        (a, b)
        for a, b in combinations(flat, 2)
        if _one_side([dot(cross(row[:3], minus(b, a)), minus(p, a)) for p in flat])
    ]
    return sum(
        abs(dot(minus(flat[0], apex), cross(minus(a, apex), minus(b, apex)))) for a, b in edges
    )


def _one_side(sides: list[int]) -> bool:
    return min(sides) >= 0 or max(sides) <= 0

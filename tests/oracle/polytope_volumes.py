"""The region shared by convex bodies, exactly: half-space enumeration in fractions.

Every three planes meet in at most one point; the corners of the region are those that satisfy all
half-spaces. Volumes are sums of exact tetrahedra over fans of the corners in each plane. Slow
(cubic in the number of planes) and obvious; shares no code with the package.
"""

from __future__ import annotations

from collections.abc import Iterable
from fractions import Fraction
from itertools import combinations

Row = tuple[Fraction, Fraction, Fraction, Fraction]


def _minus(a, b):
    return tuple(x - y for x, y in zip(a, b, strict=True))


def _dot(a, b):
    return sum(x * y for x, y in zip(a, b, strict=True))


def _cross(a, b):
    return (a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0])


def half_spaces(points: Iterable[Iterable[float]]) -> set[Row]:
    """n.x <= d of every face of the hull of few points, exactly, each plane once."""
    exact = [tuple(Fraction(float(x)) for x in point) for point in points]
    found = {}
    for a, b, c in combinations(exact, 3):
        n = _cross(_minus(b, a), _minus(c, a))
        sides = [_dot(n, _minus(p, a)) for p in exact]
        if not any(n) or (min(sides) < 0 < max(sides)):
            continue
        if max(sides) > 0:
            n = tuple(-x for x in n)
        unit = sum(abs(x) for x in n)
        row = tuple(x / unit for x in n)
        found[row] = _dot(row, a)
    return {(*n, d) for n, d in found.items()}


def corners(rows: Iterable[Row]) -> list[tuple[Fraction, ...]]:
    """All points where three planes meet and every half-space holds."""
    rows = sorted(set(rows))
    found = set()
    for p, q, r in combinations(rows, 3):
        pq, qr, rp = _cross(p[:3], q[:3]), _cross(q[:3], r[:3]), _cross(r[:3], p[:3])
        det = _dot(p[:3], qr)
        if det == 0:
            continue
        x = tuple((p[3] * qr[i] + q[3] * rp[i] + r[3] * pq[i]) / det for i in range(3))
        if all(_dot(row[:3], x) <= row[3] for row in rows):
            found.add(x)
    return sorted(found)


def shared_volume(*bodies: Iterable[Iterable[float]]) -> Fraction:
    """The exact volume shared by the hulls of several sets of points; 0 where they only touch."""
    rows = set().union(*(half_spaces(body) for body in bodies))
    points = corners(rows)
    if len(points) < 4:
        return Fraction(0)
    middle = tuple(sum(x) / len(points) for x in zip(*points, strict=True))
    return sum((_cone(row, points, middle) for row in rows), Fraction(0))


def _cone(row: Row, points, apex) -> Fraction:
    """The volume of the pyramid from `apex` over the corners that lie in the row's plane."""
    flat = [p for p in points if _dot(row[:3], p) == row[3]]
    edges = [
        (a, b)
        for a, b in combinations(flat, 2)
        if _one_side([_dot(_cross(row[:3], _minus(b, a)), _minus(p, a)) for p in flat])
    ]
    if len(flat) < 3:
        return Fraction(0)
    six = (
        abs(_dot(_minus(flat[0], apex), _cross(_minus(a, apex), _minus(b, apex)))) for a, b in edges
    )
    return sum(six, Fraction(0)) / 6


def _one_side(sides) -> bool:
    return min(sides) >= 0 or max(sides) <= 0

"""The distance of two triangles in rational arithmetic: what settles who is right where two programs differ.

Slow and plain, and shares nothing with our own measuring nor with the peer. Floats are the numbers that they are.
"""

from __future__ import annotations

import itertools
from collections.abc import Sequence
from fractions import Fraction

import numpy as np

Point = tuple[Fraction, Fraction, Fraction]
Triangle = Sequence[Point]


def placed(corners: np.ndarray, world_from_body: np.ndarray) -> list[Point]:
    """Corners (n, 3) [m] at a pose (4, 4), without rounding."""
    first, second, third = ([Fraction(x) for x in row] for row in world_from_body[:3].tolist())
    return [
        (_on_axis(first, x, y, z), _on_axis(second, x, y, z), _on_axis(third, x, y, z))
        for x, y, z in ([Fraction(x) for x in corner] for corner in corners.tolist())
    ]


def _on_axis(row: Sequence[Fraction], x: Fraction, y: Fraction, z: Fraction) -> Fraction:
    """One coordinate of a point at a pose, by the row of the pose for it."""
    return row[3] + row[0] * x + row[1] * y + row[2] * z


def point_sq(x: Point, triangles: Sequence[Triangle]) -> Fraction:
    """The squared distance of a point from the nearest of some triangles."""
    return min(_to_triangle(x, triangle) for triangle in triangles)


def triangles_sq(a: Triangle, b: Triangle) -> Fraction:
    """The squared distance of two triangles; they may be without area.

    It is that of a corner and a triangle or of two edges, unless an edge passes through the other's inside.
    """
    if any(_passes(*edge, other) for one, other in ((a, b), (b, a)) for edge in _edges(one)):
        return Fraction(0)
    corners = [_to_triangle(x, other) for one, other in ((a, b), (b, a)) for x in one]
    return min(*corners, *(_between(p, q) for p, q in itertools.product(_edges(a), _edges(b))))


def _edges(triangle: Triangle) -> list[tuple[Point, Point]]:
    return [(triangle[k], triangle[(k + 1) % 3]) for k in range(3)]


def _minus(a: Point, b: Point) -> Point:
    return (a[0] - b[0], a[1] - b[1], a[2] - b[2])


def _dot(a: Point, b: Point) -> Fraction:
    return a[0] * b[0] + a[1] * b[1] + a[2] * b[2]


def _cross(a: Point, b: Point) -> Point:
    return (a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0])


def _normal(triangle: Triangle) -> Point:
    return _cross(_minus(triangle[1], triangle[0]), _minus(triangle[2], triangle[0]))


def _is_over(x: Point, triangle: Triangle, normal: Point) -> bool:
    """True if a point is over the triangle or its edges, seen along its normal."""
    return all(_dot(_cross(_minus(q, p), _minus(x, p)), normal) >= 0 for p, q in _edges(triangle))


def _passes(p: Point, q: Point, triangle: Triangle) -> bool:
    """True if a segment passes from one side of a triangle to the other within it."""
    normal = _normal(triangle)
    above, below = _dot(_minus(p, triangle[0]), normal), _dot(_minus(q, triangle[0]), normal)
    if above * below >= 0:
        return False
    share = above / (above - below)
    return _is_over(_along(p, q, share), triangle, normal)


def _along(p: Point, q: Point, share: Fraction) -> Point:
    return (
        p[0] + share * (q[0] - p[0]),
        p[1] + share * (q[1] - p[1]),
        p[2] + share * (q[2] - p[2]),
    )


def _to_triangle(x: Point, triangle: Triangle) -> Fraction:
    normal = _normal(triangle)
    if any(normal) and _is_over(x, triangle, normal):
        return _dot(_minus(x, triangle[0]), normal) ** 2 / _dot(normal, normal)
    return min(_to_segment(x, *edge) for edge in _edges(triangle))


def _to_segment(x: Point, p: Point, q: Point) -> Fraction:
    side = _minus(q, p)
    length_sq = _dot(side, side)
    share = _dot(_minus(x, p), side) / length_sq if length_sq else Fraction(0)
    away = _minus(x, _along(p, q, min(max(share, Fraction(0)), Fraction(1))))
    return _dot(away, away)


def _between(one: tuple[Point, Point], two: tuple[Point, Point]) -> Fraction:
    """The squared distance of two segments."""
    u, v, w = _minus(one[1], one[0]), _minus(two[1], two[0]), _minus(one[0], two[0])
    uu, uv, vv, uw, vw = _dot(u, u), _dot(u, v), _dot(v, v), _dot(u, w), _dot(v, w)
    determinant = uu * vv - uv * uv
    if determinant:
        s, t = (uv * vw - vv * uw) / determinant, (uu * vw - uv * uw) / determinant
        if 0 <= s <= 1 and 0 <= t <= 1:
            away = _minus(_along(*one, s), _along(*two, t))
            return _dot(away, away)
    ends = [_to_segment(x, *two) for x in one] + [_to_segment(x, *one) for x in two]
    return min(ends)

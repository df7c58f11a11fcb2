"""Points, segments and triangles against each other, on the integer grid.

Each distance is the least over the candidates that the minimum can be: where an inner point of a
segment or triangle takes part, the connecting line is perpendicular to it. Degenerate segments and
triangles need no case of their own: a candidate that divides by their size is left out, and the
others cover their points.
"""

from __future__ import annotations

import functools
from collections.abc import Iterable
from fractions import Fraction

from tests.oracle.rationals import Point, cross, dot, exact_points, minus, on_grid


def segment_distance_sq(p0: Iterable, p1: Iterable, q0: Iterable, q1: Iterable) -> Fraction:
    """The exact squared distance of the segments p0 p1 and q0 q1; a segment may be a point."""
    scale, (ends,) = on_grid(exact_points([p0, p1, q0, q1]))
    return segments_sq(*ends) / scale**2


once = functools.lru_cache(2**15)
"""Faces share corners and edges, so that most candidates come up several times."""


@once
def point_segment_sq(x: Point, a: Point, b: Point) -> Fraction:
    """Squared distance of the point x from the segment a b."""
    along, to_x = minus(b, a), minus(x, a)
    length_sq, foot = dot(along, along), dot(to_x, along)
    if foot <= 0:
        return Fraction(dot(to_x, to_x))
    if foot >= length_sq:
        from_b = minus(x, b)
        return Fraction(dot(from_b, from_b))
    return Fraction(dot(to_x, to_x) * length_sq - foot * foot, length_sq)


@once
def segments_sq(p0: Point, p1: Point, q0: Point, q1: Point) -> Fraction:
    """Squared distance of two segments: both feet inside, or one of the four ends takes part.

    Where both feet are inside, nothing on the two lines is nearer.
    """
    u, v, r = minus(p1, p0), minus(q1, q0), minus(q0, p0)
    uu, uv, vv, ur, vr = dot(u, u), dot(u, v), dot(v, v), dot(u, r), dot(v, r)
    det = uu * vv - uv * uv  # = |u x v|^2, zero for parallel lines and for points
    foot_p, foot_q = ur * vv - vr * uv, ur * uv - vr * uu  # both times 1 / det
    if det and 0 <= foot_p <= det and 0 <= foot_q <= det:
        return Fraction(dot(r, cross(u, v)) ** 2, det)
    return min(
        point_segment_sq(p0, q0, q1),
        point_segment_sq(p1, q0, q1),
        point_segment_sq(q0, p0, p1),
        point_segment_sq(q1, p0, p1),
    )


@once
def point_triangle_sq(x: Point, a: Point, b: Point, c: Point) -> Fraction:
    """Squared distance of the point x from the hull of a, b, c."""
    normal = cross(minus(b, a), minus(c, a))
    if any(normal) and _column_holds(x, a, b, c, normal):
        return Fraction(dot(minus(x, a), normal) ** 2, dot(normal, normal))
    return min(point_segment_sq(x, a, b), point_segment_sq(x, b, c), point_segment_sq(x, c, a))


def pierces(p: Point, q: Point, a: Point, b: Point, c: Point) -> bool:
    """True if p and q lie strictly on two sides of the triangle's plane and p q meets the triangle.

    Segments that touch the plane with an end or lie in it are left to the distance candidates,
    which are zero there.
    """
    side_p, side_q = volume(a, b, c, p), volume(a, b, c, q)
    if side_p == 0 or side_q == 0 or (side_p > 0) == (side_q > 0):
        return False
    turns = (volume(p, q, a, b), volume(p, q, b, c), volume(p, q, c, a))
    return all(turn >= 0 for turn in turns) or all(turn <= 0 for turn in turns)


def volume(a: Point, b: Point, c: Point, d: Point) -> int:
    """Six times the signed volume of a tetrahedron."""
    return dot(cross(minus(b, a), minus(c, a)), minus(d, a))


def _column_holds(x: Point, a: Point, b: Point, c: Point, normal: Point) -> bool:
    """True if the foot of x on the triangle's plane is in the triangle."""
    return all(
        dot(normal, cross(minus(end, start), minus(x, start))) >= 0
        for start, end in ((a, b), (b, c), (c, a))
    )

"""Faces in rational arithmetic: the truth that geometry tests compare with."""

from __future__ import annotations

import math
from collections import Counter
from fractions import Fraction

from clearance.geometry.polyhedron import Polyhedron
from tests.oracle.rationals import cross, dot, minus

Vector = tuple[Fraction, Fraction, Fraction]


def corners(shape: Polyhedron, i_face: int) -> list[Vector]:
    return [tuple(Fraction(float(x)) for x in row) for row in shape.face(i_face)]


def on_grid(points: list[Vector]) -> list[tuple[int, int, int]]:
    """The points times their least common denominator: integers, many times as quick as Fractions."""
    scale = math.lcm(*(x.denominator for point in points for x in point))
    return [tuple(x.numerator * (scale // x.denominator) for x in point) for point in points]


def area_vector(face: list[Vector]) -> Vector:
    """Twice the area vector."""
    total = (0, 0, 0)
    for a, b in zip(face[1:], face[2:], strict=False):
        total = tuple(
            t + c for t, c in zip(total, cross(minus(a, face[0]), minus(b, face[0])), strict=True)
        )
    return total


def is_flat_and_convex(face: list[Vector]) -> bool:
    """True if all corners are in one plane, no corner bends inward, and it runs round once."""
    face = on_grid(face)
    normal = area_vector(face)
    if any(dot(normal, minus(p, face[0])) for p in face):
        return False
    for start, end in zip(face, face[1:] + face[:1], strict=True):
        inward = cross(normal, minus(end, start))
        least = dot(inward, start)
        if any(dot(inward, p) < least for p in face):
            return False
    return True


def areas_by_plane(shape: Polyhedron) -> Counter:
    """Twice the exact area vectors, summed over the faces of each oriented plane."""
    sums: dict[tuple, Vector] = {}
    for i in range(shape.n_faces):
        face = corners(shape, i)
        area = area_vector(face)
        largest = max(abs(x) for x in area)
        if not largest:
            continue
        unit = tuple(x / largest for x in area)
        key = (unit, dot(unit, face[0]))
        before = sums.get(key, (Fraction(0),) * 3)
        sums[key] = tuple(x + y for x, y in zip(before, area, strict=True))
    return Counter(sums)


def six_volumes(shape: Polyhedron) -> Fraction:
    return sum(
        (dot(f[0], area_vector(f)) for f in (corners(shape, i) for i in range(shape.n_faces))),
        Fraction(0),
    )

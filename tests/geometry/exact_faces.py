"""Faces in rational arithmetic: the truth that geometry tests compare with."""

from __future__ import annotations

from collections import Counter
from fractions import Fraction

import numpy as np

from clearance.geometry.polyhedron import Polyhedron

Vector = tuple[Fraction, Fraction, Fraction]


def corners(shape: Polyhedron, i_face: int) -> list[Vector]:
    return [tuple(Fraction(float(x)) for x in row) for row in shape.face(i_face)]


def minus(a: Vector, b: Vector) -> Vector:
    return tuple(x - y for x, y in zip(a, b, strict=True))


def dot(a: Vector, b: Vector) -> Fraction:
    return sum((x * y for x, y in zip(a, b, strict=True)), Fraction(0))


def cross(a: Vector, b: Vector) -> Vector:
    return (a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0])


def area_vector(face: list[Vector]) -> Vector:
    """Twice the area vector."""
    total = (Fraction(0),) * 3
    for a, b in zip(face[1:], face[2:], strict=False):
        total = tuple(
            t + c for t, c in zip(total, cross(minus(a, face[0]), minus(b, face[0])), strict=True)
        )
    return total


def is_flat_and_convex(face: list[Vector]) -> bool:
    """True if all corners are in one plane, no corner bends inward, and it runs round once."""
    normal = area_vector(face)
    if any(dot(normal, minus(p, face[0])) for p in face):
        return False
    n = len(face)
    for i in range(n):
        edge = minus(face[(i + 1) % n], face[i])
        if any(dot(cross(edge, minus(p, face[i])), normal) < 0 for p in face):
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


def raw_triangles(vertices: np.ndarray, triangles: np.ndarray) -> Polyhedron:
    """The triangles as they are, unmerged."""
    return Polyhedron(vertices, triangles)

"""The plane of each face and how far rounding may have moved it: what the search in doubles relies on."""

import math

import numpy as np

from clearance.jit import inlined, kernel
from clearance.kernels.expansion import N_TERMS, orient3d
from clearance.kernels.vec3 import Vec3, add, cross, dot, row, sub

SLENDER = 2.0**-15
"""Sine of a corner's angle below which the normal is not used: heights over it would be wrong by more than
a few per mille."""

ROUNDING = 64.0 * 2.0**-53
"""Relative error of an area vector, with room."""


@inlined
def unit(v):
    """v / |v|, scaled first so that nothing under- or overflows; zero for a zero vector."""
    largest = max(abs(v.x), max(abs(v.y), abs(v.z)))
    if not largest > 0.0:
        return v
    x, y, z = v.x / largest, v.y / largest, v.z / largest
    length = math.sqrt(x * x + y * y + z * z)
    return Vec3(x / length, y / length, z / length)


@inlined
def plane_of(points, flat, start, end):
    """(normal, blunt, width) of one face as in `Surface`.

    A convex polygon of twice the area A within L of its first corner has no corner sharper than A / (4 L^2),
    and is nowhere wider than 2 A / L.
    """
    first = row(points, flat[start])
    area = Vec3(0.0, 0.0, 0.0)
    reach_sq = 0.0
    for c in range(start + 1, end):
        u = sub(row(points, flat[c]), first)
        reach_sq = max(reach_sq, dot(u, u))
        if c + 1 < end:
            area = add(area, cross(u, sub(row(points, flat[c + 1]), first)))
    reach = math.sqrt(reach_sq)
    twice_area = math.sqrt(dot(area, area))
    angle = twice_area / (4.0 * reach_sq) if reach_sq > 0.0 else 0.0
    if not angle > SLENDER:
        width = 4.0 * twice_area / reach if reach > 0.0 else 0.0
        return Vec3(0.0, 0.0, 0.0), 1.0, width + ROUNDING * reach
    normal = unit(area)
    warp = 0.0
    for c in range(start + 3, end):
        warp = max(warp, abs(dot(normal, sub(row(points, flat[c]), first))))
    return normal, 1.0 / angle, warp + ROUNDING * reach / angle


@kernel
def face_planes(points, starts, flat, normals, blunt, width, bent):
    """Fills the fields of `Surface` for all faces."""
    terms = np.empty(N_TERMS)
    for face in range(len(starts) - 1):
        start, end = starts[face], starts[face + 1]
        normal, blunt[face], width[face] = plane_of(points, flat, start, end)
        for axis in range(3):
            normals[face, axis] = normal[axis]
        bent[face] = False
        for c in range(start + 2, end - 1):
            if orient3d(
                points[flat[start]], points[flat[start + 1]], points[flat[c]], points[flat[c + 1]], terms
            ) != 0:  # fmt: skip
                bent[face] = True
                break

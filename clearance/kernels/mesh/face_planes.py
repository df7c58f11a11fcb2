"""The plane of each face and its error by rounding: the search in doubles relies on both."""

import math

import numpy as np

from clearance.compile.declared import Flags, Floats, Floats2, Integers
from clearance.compile.decorators import inline, kernel
from clearance.kernels.arithmetic.expansion import N_TERMS, orient2d, orient3d
from clearance.kernels.arithmetic.vec3 import Vec3, add, cross, dot, row, sub

SLENDER = 2.0**-15
"""Sine of a corner's angle below which the normal is not used: heights would be wrong by more than a few per
mille."""

ROUNDING = 64.0 * 2.0**-53
"""Relative error of an area vector, with a margin."""


@inline
def unit(v):
    """v / |v|, scaled first so that nothing under- or overflows; zero for a zero vector."""
    largest = max(abs(v.x), max(abs(v.y), abs(v.z)))
    if not largest > 0.0:
        return v
    x, y, z = v.x / largest, v.y / largest, v.z / largest
    length = math.sqrt(x * x + y * y + z * z)
    return Vec3(x / length, y / length, z / length)


@inline
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


@inline
def _far_corners(points, flat, start, end):
    """The corner farthest from the first one, and the one farthest from the line through both."""
    first = row(points, flat[start])
    second = third = start
    most = 0.0
    for c in range(start + 1, end):
        u = sub(row(points, flat[c]), first)
        if dot(u, u) > most:
            second, most = c, dot(u, u)
    u = sub(row(points, flat[second]), first)
    most = 0.0
    for c in range(start + 1, end):
        n = cross(u, sub(row(points, flat[c]), first))
        if dot(n, n) > most:
            third, most = c, dot(n, n)
    return second, third


@inline
def _is_bent(points, flat, start, end, normal, terms):
    """True unless the corners are exactly in one plane and the boundary turns the wrong way nowhere."""
    n = end - start
    if n == 3:
        return False
    second, third = _far_corners(points, flat, start, end)
    for c in range(start + 1, end):
        if (
            orient3d(
                points[flat[start]],
                points[flat[second]],
                points[flat[third]],
                points[flat[c]],
                terms,
            )
            != 0
        ):
            return True
    axis = 0
    for other in range(1, 3):
        if abs(normal[other]) > abs(normal[axis]):
            axis = other
    if normal[axis] == 0.0:
        return True
    i, j = (axis + 1) % 3, (axis + 2) % 3
    for c in range(n):
        p, q, r = (
            points[flat[start + c]],
            points[flat[start + (c + 1) % n]],
            points[flat[start + (c + 2) % n]],
        )
        turn = orient2d(p[i], p[j], q[i], q[j], r[i], r[j], terms)
        onward = (q[i] - p[i]) * (r[i] - q[i]) + (q[j] - p[j]) * (r[j] - q[j])
        if turn * normal[axis] < 0.0 or (turn == 0 and onward < 0.0):
            return True
    return False


@inline
def _cut_off(points, flat, start, end, normal):
    """[m] the greatest distance of corners beyond an edge's line: points over the face may seem so far outside."""
    most = 0.0
    for c in range(start, end):
        first = row(points, flat[c])
        after = row(points, flat[c + 1 if c + 1 < end else start])
        outward = unit(cross(sub(after, first), normal))
        for k in range(start, end):
            most = max(most, dot(outward, sub(row(points, flat[k]), first)))
    return most


@kernel
def face_planes(
    points: Floats2,
    starts: Integers,
    flat: Integers,
    normals: Floats2,
    blunt: Floats,
    width: Floats,
    bent: Flags,
):
    """Fills the fields of `Surface` for all faces."""
    terms = np.empty(N_TERMS)
    for face in range(len(starts) - 1):
        start, end = starts[face], starts[face + 1]
        normal, blunt[face], width[face] = plane_of(points, flat, start, end)
        for axis in range(3):
            normals[face, axis] = normal[axis]
        bent[face] = _is_bent(points, flat, start, end, normals[face], terms)
        if bent[face]:
            width[face] += _cut_off(points, flat, start, end, normal)

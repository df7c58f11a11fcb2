"""Distances of single pairs of polygons, in batches, without trees."""

import numpy as np

from clearance.jit import inlined, kernel
from clearance.kernels.descent import nothing_yet
from clearance.kernels.face_pair import nearest_of_faces
from clearance.kernels.surface import Surface
from clearance.kernels.vec3 import Rigid, Vec3, cross, row, sub


@inlined
def _empty_surface(n):
    """Room for one polygon of n vertices that owns all its features."""
    nodes = np.empty((0, 3))
    none = np.empty(0, dtype=np.int64)
    ends = np.array([0, n])
    around = np.arange(n)
    edges = np.empty((n, 2), dtype=np.int64)
    for i in range(n):
        edges[i, 0] = i
        edges[i, 1] = (i + 1) % n
    return Surface(
        np.empty((n, 3)), ends, around, np.empty((1, 3)), np.empty((n, 3)), ends, around, ends, edges,
        np.empty((0, 3, 3)), nodes, nodes, np.empty((0, 2), dtype=np.int64),
        none, none, none, none, none,
    )  # fmt: skip


@inlined
def _store_unit(array, i, v):
    """Writes v / |v|, scaled first so that tiny polygons keep their normals; zeros for a zero vector."""
    largest = max(abs(v.x), max(abs(v.y), abs(v.z)))
    x, y, z = 0.0, 0.0, 0.0
    if largest > 0.0:
        x, y, z = v.x / largest, v.y / largest, v.z / largest
        length = np.sqrt(x * x + y * y + z * z)
        x, y, z = x / length, y / length, z / length
    array[i, 0], array[i, 1], array[i, 2] = x, y, z


@inlined
def _fill(surface, points, origin):
    """Puts one polygon, shifted to `origin`, and its plane data into `surface`."""
    n = points.shape[0]
    for i in range(n):
        for axis in range(3):
            surface.vertices[i, axis] = points[i, axis] - origin[axis]
    first = row(surface.vertices, 0)
    area = Vec3(0.0, 0.0, 0.0)
    for i in range(1, n - 1):
        u = sub(row(surface.vertices, i), first)
        v = sub(row(surface.vertices, i + 1), first)
        w = cross(u, v)
        area = Vec3(area.x + w.x, area.y + w.y, area.z + w.z)
    _store_unit(surface.normals, 0, area)
    normal = row(surface.normals, 0)
    for i in range(n):
        along_edge = sub(row(surface.vertices, (i + 1) % n), row(surface.vertices, i))
        _store_unit(surface.corner_normals, i, cross(along_edge, normal))


@kernel
def nearest_polygons(ps, qs, gaps_sq, points_p, points_q):
    """Fills squared distances [m^2] and witness points [m] for each pair `ps[k]`, `qs[k]`."""
    a = _empty_surface(ps.shape[1])
    b = _empty_surface(qs.shape[1])
    still = Rigid(1.0, 0.0, 0.0, 0.0, 1.0, 0.0, 0.0, 0.0, 1.0, Vec3(0.0, 0.0, 0.0))
    for k in range(ps.shape[0]):
        origin = ps[k, 0]
        _fill(a, ps[k], origin)
        _fill(b, qs[k], origin)
        hit = nearest_of_faces(a, 0, b, 0, still, True, nothing_yet(np.inf))
        gaps_sq[k] = hit.gap_sq
        for axis in range(3):
            points_p[k, axis] = hit.p[axis] + origin[axis]
            points_q[k, axis] = hit.q[axis] + origin[axis]

"""Whether a body lies wholly inside another one whose surface it does not meet.

A point is inside where the winding number of the closed, consistently oriented components is not zero, so
that cavities are outside and overlapping components inside. Open surfaces have no inside. Source: van
Oosterom & Strackee 1983 for the solid angle of a triangle.
"""

import math

from clearance.jit import inlined, kernel
from clearance.kernels.bounds import LEAN
from clearance.kernels.surface import box_of
from clearance.kernels.vec3 import cross, dot, move, move_back, row, sub


@inlined
def _solid_angle(x, y, z):
    """The signed solid angle of the triangle x y z seen from the origin."""
    nx = math.sqrt(dot(x, x))
    ny = math.sqrt(dot(y, y))
    nz = math.sqrt(dot(z, z))
    volume = dot(x, cross(y, z))
    return 2.0 * math.atan2(
        volume, nx * ny * nz + dot(x, y) * nz + dot(y, z) * nx + dot(z, x) * ny
    )


@inlined
def _in_box(surface, node, x):
    box = box_of(surface, node)
    d = sub(x, box.centre)
    lean = LEAN * (abs(d.x) + abs(d.y) + abs(d.z))
    if abs(dot(box.x, d)) > box.half.x + lean or abs(dot(box.y, d)) > box.half.y + lean:
        return False
    return abs(dot(box.z, d)) <= box.half.z + lean


@inlined
def is_inside(surface, body, x):
    """True if `x` (body frame) is inside the solid; `x` must not lie on its surface."""
    if not _in_box(surface, surface.roots[body], x):
        return False
    angle = 0.0
    for i in range(surface.solid_starts[body], surface.solid_starts[body + 1]):
        face = surface.solid_faces[i]
        start = surface.face_starts[face]
        first = sub(row(surface.vertices, surface.face_vertices[start]), x)
        for c in range(start + 2, surface.face_starts[face + 1]):
            second = sub(row(surface.vertices, surface.face_vertices[c - 1]), x)
            third = sub(row(surface.vertices, surface.face_vertices[c]), x)
            angle += _solid_angle(first, second, third)
    return abs(angle) > 2.0 * math.pi


@kernel
def contained(a, body_a, b, body_b, m):
    """(found, point): a point (frame of a) of one body inside the other; their surfaces must not meet."""
    for i in range(a.probe_starts[body_a], a.probe_starts[body_a + 1]):
        x = row(a.vertices, a.probes[i])
        if is_inside(b, body_b, move_back(m, x)):
            return True, x
    for i in range(b.probe_starts[body_b], b.probe_starts[body_b + 1]):
        x = move(m, row(b.vertices, b.probes[i]))
        if is_inside(a, body_a, x):
            return True, x
    return False, m.t

"""Bounds on the distance of two whole faces under a displacement, along one direction or along none.

Not for: which faces (`descent`), and their nearest points (`features.face_pair`).
"""

import math

from clearance.compile.decorators import inline
from clearance.kernels.arithmetic.lanes import WIDTH
from clearance.kernels.arithmetic.vec3 import dot, row
from clearance.kernels.mesh.corners import corners_at, greatest_in, least_in
from clearance.kernels.search.displacement import (
    movement_of_point,
    movement_of_point_along,
    movement_of_point_in_search,
)


@inline(force=True)
def bound_along(faces, direction, displacement):
    """[m] a lower bound on two faces along the prepared direction."""
    a, b = faces.surface_a, faces.surface_b
    u, v = direction.u, direction.v
    far, near = -math.inf, math.inf
    end = a.face_starts[faces.a + 1]
    for c in range(a.face_starts[faces.a], end, WIDTH):
        x = corners_at(a, c, end)
        far = max(far, greatest_in(dot(u, x) + movement_of_point_along(displacement, x, 0, u)))
    end = b.face_starts[faces.b + 1]
    for c in range(b.face_starts[faces.b], end, WIDTH):
        x = corners_at(b, c, end)
        near = min(near, least_in(dot(v, x) - movement_of_point_along(displacement, x, 1, v)))
    return near + direction.offset - far - displacement.slack


@inline(force=True)
def bound_in_search(faces, direction, displacement):
    """[m] the same along the direction of the search."""
    a, b = faces.surface_a, faces.surface_b
    u, v = direction.u, direction.v
    far, near = -math.inf, math.inf
    end = a.face_starts[faces.a + 1]
    for c in range(a.face_starts[faces.a], end, WIDTH):
        x = corners_at(a, c, end)
        far = max(far, greatest_in(dot(u, x) + movement_of_point_in_search(displacement, x, 0, u)))
    end = b.face_starts[faces.b + 1]
    for c in range(b.face_starts[faces.b], end, WIDTH):
        x = corners_at(b, c, end)
        near = min(near, least_in(dot(v, x) - movement_of_point_in_search(displacement, x, 1, v)))
    return near + direction.offset - far - displacement.slack


@inline
def movement_of_both(faces, displacement):
    """[m] the most by which two faces come nearer."""
    moved = _movement_of_face(faces.surface_a, faces.a, 0, displacement)
    return moved + _movement_of_face(faces.surface_b, faces.b, 1, displacement)


@inline
def _movement_of_face(surface, face, side, displacement):
    moved = 0.0
    for c in range(surface.face_starts[face], surface.face_starts[face + 1]):
        x = row(surface.vertices, surface.face_vertices[c])
        moved = max(moved, movement_of_point(displacement, x, side))
    return moved

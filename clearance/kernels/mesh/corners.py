"""Corners of a face, four in one register: each result is computed for all four at once.

Each lane has the result of a loop over the corners, to the bit. Not for: arithmetic in lanes (`lanes`).
"""

from clearance.compile.decorators import inline
from clearance.kernels.arithmetic.lanes import lane, lanes_of
from clearance.kernels.arithmetic.vec3 import Vec3, row


@inline(force=True)
def points_in_lanes(p, q, r, s):
    """Four points in lanes."""
    return Vec3(
        lanes_of(p.x, q.x, r.x, s.x), lanes_of(p.y, q.y, r.y, s.y), lanes_of(p.z, q.z, r.z, s.z)
    )


@inline(force=True)
def corners_at(surface, first, end):
    """Four corners of a face from corner `first` on, in lanes; corner `end - 1` again where there are fewer."""
    vertices, corners, last = surface.vertices, surface.face_vertices, end - 1
    return points_in_lanes(
        row(vertices, corners[first]),
        row(vertices, corners[min(first + 1, last)]),
        row(vertices, corners[min(first + 2, last)]),
        row(vertices, corners[min(first + 3, last)]),
    )


@inline(force=True)
def rows_at(array, first, end):
    """Four rows of an (n, 3) array from row `first` on, in lanes; row `end - 1` again where there are fewer."""
    last = end - 1
    return points_in_lanes(
        row(array, first),
        row(array, min(first + 1, last)),
        row(array, min(first + 2, last)),
        row(array, min(first + 3, last)),
    )


@inline(force=True)
def greatest_in(lanes):
    """The greatest of the four."""
    return max(max(lane(lanes, 0), lane(lanes, 1)), max(lane(lanes, 2), lane(lanes, 3)))


@inline(force=True)
def least_in(lanes):
    """The least of the four."""
    return min(min(lane(lanes, 0), lane(lanes, 1)), min(lane(lanes, 2), lane(lanes, 3)))

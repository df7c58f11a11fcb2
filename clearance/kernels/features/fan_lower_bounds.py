"""The lower bound of two bent faces, triangle by triangle of their fans: slow, and rarely needed.

Where two faces bent by rounding lie parallel over each other, no single direction separates all of their
triangles. Each pair of triangles is convex; the direction between its own nearest features separates it.
"""

from clearance.compile.decorators import inline, kernel
from clearance.kernels.arithmetic.double_double import Wide, less, lesser
from clearance.kernels.features.face_lower_bounds import CornerRange, corners_of, lower_bound_along
from clearance.kernels.features.feature import simplex
from clearance.kernels.features.posed_pair import PosedPair
from clearance.kernels.features.wide_features import PointPair, Simplex, wide_feature

MOST = 64
"""Most triangle pairs; faces with more have the bound of their convex hulls."""


@inline(force=True)
def _turned(triangle, i):
    """The triangle read from corner `i`."""
    if i == 0:
        return triangle
    if i == 1:
        return Simplex(3, triangle.v, triangle.w, triangle.u)
    return Simplex(3, triangle.w, triangle.u, triangle.v)


@inline(force=True)
def _start(n, triangle):
    """The first `n` corners of a triangle as a simplex of its own."""
    return Simplex(n, triangle.u, triangle.u if n == 1 else triangle.v, triangle.w)


@inline
def _nearest_of_triangles(frames, one, two):
    """The nearest pair of points of two triangles that do not meet, and so its direction."""
    best = wide_feature(frames, _start(1, one), _start(1, two))
    for kind in range(6):
        n_one = 3 if kind == 4 else (2 if kind in (1, 3) else 1)
        n_two = 3 if kind == 5 else (2 if kind in (2, 3) else 1)
        for i in range(1 if n_one == 3 else 3):
            for j in range(1 if n_two == 3 else 3):
                found = wide_feature(
                    frames, _start(n_one, _turned(one, i)), _start(n_two, _turned(two, j))
                )
                if less(found.gap_sq, best.gap_sq):
                    best = found
    return best


@kernel
def lower_bound_of_fans(faces: PosedPair, pair: PointPair, least: Wide, lower_bound: Wide) -> Wide:
    """[m] `lower_bound`, or a greater lower bound on the distance of two faces.

    Args:
        least: (`Wide`) the lower bound that is enough: triangles with it along `pair` are skipped.
    """
    a, b = faces.surface_a, faces.surface_b
    face_a, face_b, frames = faces.a, faces.b, faces.frames
    start_a, end_a = a.face_starts[face_a], a.face_starts[face_a + 1]
    start_b, end_b = b.face_starts[face_b], b.face_starts[face_b + 1]
    if (end_a - start_a - 2) * (end_b - start_b - 2) > MOST:
        return lower_bound
    least_lower_bound = least
    for i in range(start_a + 1, end_a - 1):
        for j in range(start_b + 1, end_b - 1):
            part_a = corners_of(a, face_a, CornerRange(i, i + 2))
            part_b = corners_of(b, face_b, CornerRange(j, j + 2))
            direction = pair
            for attempt in range(2):
                own = lower_bound_along(frames, part_a, part_b, direction)
                if not less(own, least) or attempt == 1:
                    break
                one, two = simplex(a, face_a, 3, i), simplex(b, face_b, 3, j)
                direction = _nearest_of_triangles(frames, one, two)
            least_lower_bound = lesser(own, least_lower_bound)
    return lower_bound if less(least_lower_bound, lower_bound) else least_lower_bound

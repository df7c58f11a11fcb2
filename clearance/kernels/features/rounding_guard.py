"""Features of two faces that rounding hides: they seem to be outside, and may be near.

Rounding limits the test whether the foot of a corner is inside a face or an edge. A foot just outside belongs to a
feature of a neighbouring face, which is measured instead. It is as near only where `is_beyond_rounding` holds.
Other face pairs wait with a lower bound in place of a distance. Not for: visible features (`face_pair`).
"""

from clearance.compile.decorators import inline
from clearance.kernels.arithmetic.vec3 import gap_sq, inverse, move, row
from clearance.kernels.features.bounds import lower_bound_faces_across, lower_bound_faces_outward
from clearance.kernels.features.face_pair import has_plane
from clearance.kernels.features.segments import nearest_on_segment

HIDING_SHARE = 2.0**-26
"""Rounding below this share of the distance of two faces, with a margin, hides none of their features."""

PASSED_OVER = 2.0**-56
"""Share of a distance by which a skipped face pair can be nearer than the answer.

Its features seemed to be outside, and neighbouring ones were measured instead. These lie to the side by at most
2^-28 of the distance, which lengthens it by half the square. `HIDING_SHARE` allows 64 times the error of points,
and four times the width of a face without a plane. Directions are off by 2^-34 where a normal is the least
certain, and by 2^-28 where an edge is as short as 2^-24 of the bodies' size.
"""


@inline(force=True)
def _shape_error(surface, face):
    """[m] the greatest distance of a face from its plane, or from its edges if it has no plane."""
    if surface.bent[face] or not has_plane(surface, face):
        return surface.width[face]
    return 0.0


@inline(force=True)
def is_beyond_rounding(a, face_a, b, face_b, gap, margin):
    """True if hidden features of two faces with a distance of `gap` [m] are nearer by at most `PASSED_OVER`."""
    return (
        2.0 * margin + 4.0 * (_shape_error(a, face_a) + _shape_error(b, face_b))
        <= HIDING_SHARE * gap
    )


@inline(force=True)
def _corner_near(one, face_one, two, face_two, two_from_one, limit):
    """True if a corner that a face owns may be within a limit of the inside of a face that is bent or has no
    plane.

    Points of a face without a plane are within its width of its edges.
    """
    if has_plane(two, face_two):
        return two.bent[face_two]
    limit += two.width[face_two]
    first, end = two.face_starts[face_two], two.face_starts[face_two + 1]
    for k in range(one.vertex_starts[face_one], one.vertex_starts[face_one + 1]):
        x = move(two_from_one, row(one.vertices, one.owned_vertices[k]))
        before = row(two.vertices, two.face_vertices[end - 1])
        for c in range(first, end):
            after = row(two.vertices, two.face_vertices[c])
            if gap_sq(x, nearest_on_segment(x, before, after)) <= limit * limit:
                return True
            before = after
    return False


@inline(force=True)
def may_hide(a, face_a, b, face_b, m, margin, limit, least):
    """True if rounding can hide features of two faces within a limit, whatever was seen.

    Nothing is hidden where `is_beyond_rounding` holds. If only the shape of a face leaves that open, corners
    decide.

    Args:
        least: [m] a lower bound on the distance of any two faces, except hidden features.
    """
    if is_beyond_rounding(a, face_a, b, face_b, least, margin):
        return False
    return (
        2.0 * margin > HIDING_SHARE * least
        or _corner_near(a, face_a, b, face_b, inverse(m), limit + margin)
        or _corner_near(b, face_b, a, face_a, m, limit + margin)
    )


@inline(force=True)
def sure_gap(a, face_a, b, face_b, m, margin, along_direction):
    """[m] a lower bound on the distance of two faces: `along_direction`, or a greater one if too close."""
    if is_beyond_rounding(a, face_a, b, face_b, along_direction, margin):
        return along_direction
    gap = max(along_direction, lower_bound_faces_outward(a, face_a, b, face_b, m) - margin)
    if gap > 0.0:
        return gap
    return max(gap, lower_bound_faces_across(a, face_a, b, face_b, m) - margin)

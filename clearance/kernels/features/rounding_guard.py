"""What rounding hides of two faces: features that were taken for outside, and how near they can be.

Whether the foot of a corner is inside a face or an edge is known to rounding only. Where it is outside but for
rounding, another face's feature beside it is measured, which is as near only where faces are `told_apart`. Others
wait with a lower bound in place of what was seen. Not for: what is seen (`face_pair`).
"""

from clearance.compile.decorators import inline
from clearance.kernels.arithmetic.vec3 import gap_sq, inverse, move, row
from clearance.kernels.features.bounds import lower_bound_faces_across, lower_bound_faces_beside
from clearance.kernels.features.face_pair import has_plane
from clearance.kernels.features.segments import nearest_on_segment

TOLD = 2.0**-26
"""Share of their distance below which rounding aside, with room, does not hide features of two faces."""

PASSED_OVER = 2.0**-56
"""Share of a distance by which a face pair that was passed over can be nearer than the answer.

Its features were taken for outside, so that others beside them are measured, off to the side by 2^-28 of the
distance at most; that lengthens it by half the square. `TOLD` grants 64 times what points are off, and four
times the width of a face without a plane. Directions are off by 2^-34 where a normal is the least certain, and by
2^-28 where an edge is as short as 2^-24 of the bodies' size.
"""


@inline(force=True)
def _unsure(surface, face):
    """[m] how far its triangles, or its inside where it has no plane, may be off what stands for a face."""
    if surface.bent[face] or not has_plane(surface, face):
        return surface.width[face]
    return 0.0


@inline(force=True)
def told_apart(a, face_a, b, face_b, gap, margin):
    """True if what rounding can hide of two faces that are `gap` apart is no nearer than by `PASSED_OVER`."""
    return 2.0 * margin + 4.0 * (_unsure(a, face_a) + _unsure(b, face_b)) <= TOLD * gap


@inline(force=True)
def _corner_near(one, face_one, two, face_two, two_from_one, limit):
    """True if a corner that a face owns may be within a limit of the inside of one that is bent or has no plane.

    What has no plane is no farther from its edges than its width.
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

    Nothing is hidden where faces are `told_apart`; if only their own shape leaves them undecided, corners are.

    Args:
        least: [m] no two faces are nearer but for what is hidden.
    """
    if told_apart(a, face_a, b, face_b, least, margin):
        return False
    return (
        2.0 * margin > TOLD * least
        or _corner_near(a, face_a, b, face_b, inverse(m), limit + margin)
        or _corner_near(b, face_b, a, face_a, m, limit + margin)
    )


@inline(force=True)
def sure_gap(a, face_a, b, face_b, m, margin, along_direction):
    """[m] a lower bound on the distance of two faces: `along_direction`, or a greater one if too close."""
    if told_apart(a, face_a, b, face_b, along_direction, margin):
        return along_direction
    gap = max(along_direction, lower_bound_faces_beside(a, face_a, b, face_b, m) - margin)
    if gap > 0.0:
        return gap
    return max(gap, lower_bound_faces_across(a, face_a, b, face_b, m) - margin)

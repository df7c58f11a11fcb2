"""Lower bounds: each pruning bound is a function that never exceeds the distance it bounds.

An argument that is a box may be four boxes in lanes (`surface.group_at`); the result then has a bound for each.
"""

import math
from typing import NamedTuple

from clearance.compile.decorators import inline
from clearance.kernels.arithmetic.lanes import WIDTH, lane, larger, square_root, where_positive
from clearance.kernels.arithmetic.vec3 import (
    RigidMotion,
    Vec3,
    along,
    cross,
    dot,
    inverse,
    move,
    rigid,
    row,
    sub,
    turn,
    turn_back,
)
from clearance.kernels.mesh.corners import corners_at, rows_at
from clearance.kernels.mesh.surface import box_of

SLACK = 128.0 * 2.0**-53
"""Rounding of a box bound, relative to the sum of the coordinates' magnitudes: 40 operations, doubled."""

NO_REACH = 1e300
"""[m] Stands for minus infinity: the bound of boxes whose centres coincide."""

LEAN = 2.0**-20
"""Four times what rounding to single precision can turn the axes of a box, relative to 1."""


CROSSED = 64
"""Pairs of edges that are worth crossing."""


@inline(force=True)
def _axis_gap(centre, half_a, half_b, slack):
    return larger(abs(centre) - half_a - half_b - slack, 0.0)


@inline(force=True)
def between_boxes(p, u, v, w, d):
    """The motion between two boxes: from the axes u, v, w of one to those of p; d is from centre to centre."""
    x, y, z = p.x, p.y, p.z
    return RigidMotion(
        dot(x, u), dot(x, v), dot(x, w),
        dot(y, u), dot(y, v), dot(y, w),
        dot(z, u), dot(z, v), dot(z, w),
        Vec3(dot(x, d), dot(y, d), dot(z, d)),
    )  # fmt: skip


@inline(force=True)
def lower_bound_boxes(p, q, m, slack):
    """[m] a lower bound on the distance of two boxes, p in the frame of a and q in that of b.

    The greatest of three. In the frame of either box the other one fits in an axis-parallel box of half sizes
    |R| h, and the distance of two axis-parallel boxes is known. Along the line of the centres the reach of both
    boxes is at most the sum of their half sizes' shares. The axes are orthonormal to `LEAN` / 4 only, which can
    raise each of the three by that share of the centres' distance. Where the boxes overlap it is the last one,
    which falls as they overlap more.
    """
    d = sub(turn(m, q.centre), sub(p.centre, m.t))
    n = between_boxes(p, turn(m, q.x), turn(m, q.y), turn(m, q.z), d)
    return lower_bound_between(p.half, q.half, n, slack)


@inline(force=True)
def lower_bound_between(h, k, n, slack):
    """[m] `lower_bound_boxes` from the half sizes of both boxes and the motion `between_boxes`."""
    d = n.t
    slack = slack + LEAN * (abs(d.x) + abs(d.y) + abs(d.z))
    x = _axis_gap(d.x, h.x, abs(n.xx) * k.x + abs(n.xy) * k.y + abs(n.xz) * k.z, slack)
    y = _axis_gap(d.y, h.y, abs(n.yx) * k.x + abs(n.yy) * k.y + abs(n.yz) * k.z, slack)
    z = _axis_gap(d.z, h.z, abs(n.zx) * k.x + abs(n.zy) * k.y + abs(n.zz) * k.z, slack)
    in_p = x * x + y * y + z * z
    e = turn_back(n, d)
    x = _axis_gap(e.x, k.x, abs(n.xx) * h.x + abs(n.yx) * h.y + abs(n.zx) * h.z, slack)
    y = _axis_gap(e.y, k.y, abs(n.xy) * h.x + abs(n.yy) * h.y + abs(n.zy) * h.z, slack)
    z = _axis_gap(e.z, k.z, abs(n.xz) * h.x + abs(n.yz) * h.y + abs(n.zz) * h.z, slack)
    in_q = x * x + y * y + z * z
    gap_sq = dot(d, d)
    reach = abs(d.x) * h.x + abs(d.y) * h.y + abs(d.z) * h.z
    reach = reach + abs(e.x) * k.x + abs(e.y) * k.y + abs(e.z) * k.z
    between_centres = larger(
        (gap_sq - reach) / square_root(gap_sq) - slack, -NO_REACH
    )  # NaN where they coincide
    outside = square_root(larger(in_p, in_q))
    return where_positive(outside, larger(outside, between_centres), between_centres)


class SeparatingDirection(NamedTuple):
    """A direction that separates two bodies: along `u` in the frame of a, `v` in that of b, from a to b.

    Any unit vector gives a valid bound; that of the best witness points gives a tight one.
    """

    u: Vec3
    v: Vec3
    offset: float  # [m] u . t of `a_from_b`


@inline(force=True)
def direction_between(p, q, m):
    """The direction from `p` to `q` (frame of a); one of zero length bounds nothing."""
    d = sub(q, p)
    length = math.sqrt(dot(d, d))
    if length > 0.0:
        d = Vec3(d.x / length, d.y / length, d.z / length)
    return SeparatingDirection(d, turn_back(m, d), dot(d, m.t))


@inline(force=True)
def _back(direction):
    """The other way along the same line."""
    u, v = direction.u, direction.v
    return SeparatingDirection(Vec3(-u.x, -u.y, -u.z), Vec3(-v.x, -v.y, -v.z), -direction.offset)


@inline(force=True)
def opposite(direction):
    """The same direction with a and b exchanged."""
    u, v = direction.u, direction.v
    return SeparatingDirection(Vec3(-v.x, -v.y, -v.z), Vec3(-u.x, -u.y, -u.z), direction.offset)


@inline(force=True)
def box_reach(box, direction):
    """[m] half of the width of a box along a direction."""
    h = box.half
    return (
        h.x * abs(dot(box.x, direction))
        + h.y * abs(dot(box.y, direction))
        + h.z * abs(dot(box.z, direction))
    )


@inline(force=True)
def lower_bound_boxes_along_direction(p, q, direction):
    """[m] a lower bound on the distance of two boxes, without their rounding slack; may be negative."""
    far_of_a = dot(direction.u, p.centre) + box_reach(p, direction.u)
    near_of_b = dot(direction.v, q.centre) - box_reach(q, direction.v)
    return near_of_b + direction.offset - far_of_a


@inline(force=True)
def lower_bound_faces_along_direction(a, face_a, b, face_b, direction):
    """[m] a lower bound on the distance of two faces, without rounding slack; may be negative."""
    far_of_a = -math.inf
    for c in range(a.face_starts[face_a], a.face_starts[face_a + 1]):
        far_of_a = max(far_of_a, dot(direction.u, row(a.vertices, a.face_vertices[c])))
    near_of_b = math.inf
    for c in range(b.face_starts[face_b], b.face_starts[face_b + 1]):
        near_of_b = min(near_of_b, dot(direction.v, row(b.vertices, b.face_vertices[c])))
    return near_of_b + direction.offset - far_of_a


@inline(force=True)
def _outward_gap(surface, face, other, face_other, m):
    """(squared distance, direction) of a face from the plane and one edge of another face, in the other's frame.

    Args:
        m: from the frame of the other body to its own.
    """
    first, last = other.face_starts[face_other], other.face_starts[face_other + 1]
    normal = row(surface.normals, face)
    v = turn_back(m, normal)
    least, most = math.inf, -math.inf
    for c in range(first, last):
        h = dot(v, row(other.vertices, other.face_vertices[c]))
        least, most = min(least, h), max(most, h)
    start = surface.face_starts[face]
    offset = dot(normal, sub(m.t, row(surface.vertices, surface.face_vertices[start])))
    height = max(0.0, least + offset) + min(0.0, most + offset)
    farthest, outward = 0.0, normal
    end = surface.face_starts[face + 1]
    for e in range(start, end, WIDTH):
        u = rows_at(surface.corner_normals, e, end)
        v = turn_back(m, u)
        inward = 0.0 * v.x - math.inf  # in lanes, as all that follows
        for c in range(first, last):
            x = row(other.vertices, other.face_vertices[c])
            inward = larger(inward, dot(v, Vec3(-x.x, -x.y, -x.z)))
        beyond = dot(u, sub(m.t, corners_at(surface, e, end))) - inward
        for k in range(WIDTH):
            if lane(beyond, k) > farthest:
                farthest = lane(beyond, k)
                outward = row(surface.corner_normals, min(e + k, end - 1))
    to = along(
        Vec3(farthest * outward.x, farthest * outward.y, farthest * outward.z), height, normal
    )
    return height * height + farthest * farthest, to


@inline(force=True)
def direction_outward(a, face_a, b, face_b, from_a, from_b):
    """A direction that probably separates two faces: up from the plane of one and outward from its nearest edge.

    Args:
        from_a, from_b: `a_from_b` and the inverse.
    """
    of_a, d = _outward_gap(a, face_a, b, face_b, from_a)
    of_b, e = _outward_gap(b, face_b, a, face_a, from_b)
    if of_b > of_a:
        d = turn(from_a, Vec3(-e.x, -e.y, -e.z))
    return direction_between(Vec3(0.0, 0.0, 0.0), d, from_a)


@inline(force=True)
def lower_bound_faces_outward(a, face_a, b, face_b, m):
    """[m] a lower bound on the distance of two faces along `direction_outward`, without rounding slack."""
    return lower_bound_faces_along_direction(
        a, face_a, b, face_b, direction_outward(a, face_a, b, face_b, m, inverse(m))
    )


@inline(force=True)
def lower_bound_faces_across(a, face_a, b, face_b, m):
    """[m] the same across an edge of each: the greatest of all pairs; 0 where none separates the faces."""
    most = 0.0
    first_a, last_a = a.face_starts[face_a], a.face_starts[face_a + 1]
    first_b, last_b = b.face_starts[face_b], b.face_starts[face_b + 1]
    if (last_a - first_a) * (last_b - first_b) > CROSSED:
        return most
    p = row(a.vertices, a.face_vertices[last_a - 1])
    for c in range(first_a, last_a):
        before, p = p, row(a.vertices, a.face_vertices[c])
        u = sub(p, before)
        q = row(b.vertices, b.face_vertices[last_b - 1])
        for k in range(first_b, last_b):
            behind, q = q, row(b.vertices, b.face_vertices[k])
            direction = direction_between(Vec3(0.0, 0.0, 0.0), cross(u, turn(m, sub(q, behind))), m)
            most = max(most, lower_bound_faces_along_direction(a, face_a, b, face_b, direction))
            most = max(
                most, lower_bound_faces_along_direction(a, face_a, b, face_b, _back(direction))
            )
    return most


@inline(force=True)
def _reach(surface, root):
    """[m] an upper bound on the sum of coordinate magnitudes of a body's points."""
    box = box_of(surface, root)
    c, h = box.centre, box.half
    return abs(c.x) + abs(c.y) + abs(c.z) + 2.0 * (h.x + h.y + h.z)


@inline(force=True)
def rounding_slack(a, root_a, b, root_b, frames):
    """[m] the most that rounding, and rotations off orthonormal, can raise a box bound."""
    t = frames.m.t
    shift = abs(t.x) + abs(t.y) + abs(t.z)
    return (SLACK + 8.0 * frames.defect) * (shift + _reach(a, root_a) + _reach(b, root_b))


@inline
def margin_of(slack):
    """[m] the rounding of a distance between two points of the bodies, from their `rounding_slack`."""
    return 4.0 * slack


@inline(force=True)
def displacement(surface, root, before, after):
    """[m] an upper bound on the motion of any point of a body from one pose to another.

    The displacement is the norm of an affine map, hence convex: its maximum over the body's box is
    attained at a corner. `before` and `after` are (4, 4) poses.
    """
    box = box_of(surface, root)
    a, b = rigid(after), rigid(before)
    change = RigidMotion(
        a.xx - b.xx, a.xy - b.xy, a.xz - b.xz,
        a.yx - b.yx, a.yy - b.yy, a.yz - b.yz,
        a.zx - b.zx, a.zy - b.zy, a.zz - b.zz,
        sub(a.t, b.t),
    )  # fmt: skip
    centre = move(change, box.centre)
    x, y, z = turn(change, box.x), turn(change, box.y), turn(change, box.z)
    most_sq = 0.0
    for corner in range(4):  # and the opposite one
        out = along(Vec3(0.0, 0.0, 0.0), box.half.x, x)
        out = along(out, box.half.y if corner & 1 else -box.half.y, y)
        out = along(out, box.half.z if corner & 2 else -box.half.z, z)
        most_sq = max(most_sq, dot(out, out) + 2.0 * abs(dot(centre, out)))
    most_sq += dot(centre, centre)
    return math.sqrt(most_sq) * (1.0 + SLACK)

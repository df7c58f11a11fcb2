"""Which parts of a body the holes of another one leave in doubt: near enough a hole, and wound round by enough.

Not for: what is proven to be inside (`containment`), which the search asks for.
"""

import math

import numpy as np

from clearance.compile.declared import Flags, Floats, Floats2, Floats3
from clearance.compile.decorators import inline, kernel
from clearance.kernels.arithmetic.double_double import frames_of, size
from clearance.kernels.arithmetic.vec3 import (
    Vec3,
    cross,
    dot,
    move,
    move_back,
    relative,
    rigid,
    row,
    sub,
)
from clearance.kernels.mesh.surface import Surface
from clearance.kernels.search.containment import (
    DOUBTFUL,
    Probe,
    in_box,
    signed_turns_of_caps,
    solid_angle,
    winding_number,
)
from clearance.kernels.search.scratch import new_scratch

WOUND = 0.98
"""[turns] Loose faces that go round a point by as much may be a solid with cracks, seen under 2 % at most."""


@kernel
def generalized_windings(
    surface: Surface,
    points: Floats2,
    poses: Floats3,
    poses_of_points: Floats3,
    least: Floats,
    most: Floats,
):
    """Fills the least and greatest magnitude of the points' winding numbers at each of n poses, caps not counted.

    Points outside the body's box have 0. To rounding, but for points near a cap, which may be off by 1.

    Args:
        surface: of one body.
        points: (m, 3) [m] in a frame of their own.
        poses, poses_of_points: (n, 4, 4) [m] of the body and of the points.
        least, most: (n,) where they are written.
    """
    scratch = new_scratch()
    for i in range(len(poses)):
        frames = frames_of(rigid(poses[i]), rigid(poses_of_points[i]))
        least[i], most[i] = np.inf, 0.0
        for k in range(len(points)):
            v = row(points, k)
            x = move(frames.m, v)
            away = size(frames.m.t) + size(v)
            number = 0.0
            if in_box(surface, surface.roots[0], x, away):
                arguments = (
                    surface,
                    0,
                    False,
                    Probe(v, x, away),
                    frames,
                    scratch.exact,
                    scratch.nodes,
                )
                number = abs(winding_number(*arguments) - signed_turns_of_caps(surface, 0, x))
            least[i] = min(least[i], number)
            most[i] = max(most[i], number)


@inline
def _turns_at_most(holes, first, last, low, high, frame, frame_of_box):
    """[turns] no point of a box from `low` to `high` sees more through some holes; infinite if in one."""
    seen = 0.0
    for k in range(first, last):
        x = move_back(frame_of_box, move(frame, Vec3(holes[k, 0], holes[k, 1], holes[k, 2])))
        dx = max(low[0] - x.x, max(0.0, x.x - high[0]))
        dy = max(low[1] - x.y, max(0.0, x.y - high[1]))
        dz = max(low[2] - x.z, max(0.0, x.z - high[2]))
        rounding = 1e-12 * (size(x) + size(frame.t) + size(frame_of_box.t))
        away = np.sqrt(dx * dx + dy * dy + dz * dz) - holes[k, 3] - rounding
        if away <= 1e-100:
            return np.inf
        seen += holes[k, 4] / (away * away)
    return seen / (4.0 * math.pi)


@inline
def _half(low, high):
    return Vec3(0.5 * (high[0] - low[0]), 0.5 * (high[1] - low[1]), 0.5 * (high[2] - low[2]))


@inline
def _is_beside(low, high, low_of_other, high_of_other, frame, frame_of_other):
    """True only if two boxes, each in a frame of its own, are beside each other along an axis of the first."""
    half, half_of_other = _half(low, high), _half(low_of_other, high_of_other)
    middle = Vec3(low[0] + half.x, low[1] + half.y, low[2] + half.z)
    at = Vec3(
        low_of_other[0] + half_of_other.x,
        low_of_other[1] + half_of_other.y,
        low_of_other[2] + half_of_other.z,
    )
    m = relative(frame, frame_of_other)
    away = sub(move(m, at), middle)
    reach = Vec3(
        abs(m.xx) * half_of_other.x + abs(m.xy) * half_of_other.y + abs(m.xz) * half_of_other.z,
        abs(m.yx) * half_of_other.x + abs(m.yy) * half_of_other.y + abs(m.yz) * half_of_other.z,
        abs(m.zx) * half_of_other.x + abs(m.zy) * half_of_other.y + abs(m.zz) * half_of_other.z,
    )
    rounding = 1e-12 * (
        size(away) + size(frame.t) + size(frame_of_other.t) + size(middle) + size(at)
    )
    return (
        abs(away.x) > half.x + reach.x + rounding
        or abs(away.y) > half.y + reach.y + rounding
        or abs(away.z) > half.z + reach.z + rounding
    )


@kernel
def near_holes(
    holes: Floats2,
    bounds: Floats2,
    low: Floats,
    high: Floats,
    poses: Floats3,
    poses_of_box: Floats3,
    found: Flags,
):
    """Sets `found` (n,) where a box may see more than nearly `DOUBTFUL` through holes, at each of n poses.

    A surface of area A that is nowhere nearer than d has a solid angle of at most A / d^2.

    Args:
        holes: (1 + h, 5) centres, radii [m] and areas [m^2] of balls that hold their caps; the first holds all.
        bounds: (2, 3) [m] of their body: what is beside it is not near.
        low, high: (3,) [m] corners of the box in a frame of its own.
        poses, poses_of_box: (n, 4, 4) [m] of the frame of the holes and of that of the box.
    """
    few = 0.99 * DOUBTFUL
    for i in range(len(poses)):
        frame, other = rigid(poses[i]), rigid(poses_of_box[i])
        found[i] = (
            _turns_at_most(holes, 0, 1, low, high, frame, other) > few
            and not _is_beside(bounds[0], bounds[1], low, high, frame, other)
            and not _is_beside(low, high, bounds[0], bounds[1], other, frame)
            and _turns_at_most(holes, 1, len(holes), low, high, frame, other) > few
        )


@inline
def _turns_of(triangles, x):
    """[turns] the magnitude of the solid angle of triangles (k, 3, 3) from `x`."""
    total = 0.0
    for i in range(len(triangles)):
        a, b, c = (
            sub(row(triangles[i], 0), x),
            sub(row(triangles[i], 1), x),
            sub(row(triangles[i], 2), x),
        )
        angle = solid_angle(a, b, c)
        total += angle if dot(a, cross(b, c)) > 0.0 else -angle
    return abs(total) / (4.0 * math.pi)


@inline
def _all_wound(triangles, points, frame, frame_of_points):
    for k in range(len(points)):
        if (
            not _turns_of(triangles, move_back(frame, move(frame_of_points, row(points, k))))
            >= WOUND
        ):
            return False
    return True


@inline
def _all_within(bounds, points, frame, frame_of_points):
    for k in range(len(points)):
        x = move_back(frame, move(frame_of_points, row(points, k)))
        if not (bounds[0, 0] <= x.x <= bounds[1, 0] and bounds[0, 1] <= x.y <= bounds[1, 1]):
            return False
        if not bounds[0, 2] <= x.z <= bounds[1, 2]:
            return False
    return True


@kernel
def wound_by_loose(
    triangles: Floats3,
    bounds: Floats2,
    points: Floats2,
    poses: Floats3,
    poses_of_points: Floats3,
    stride: float,
    found: Flags,
):
    """Sets `found` (n,) where triangles go round all of some points, within their bounds, by `WOUND`.

    Of poses in a row at which the points are within the bounds, the first and the last are asked, and each at
    which the first point is more than `stride` [m] from where it was asked last; others have the last answer.

    Args:
        triangles: (k, 3, 3) [m]. bounds: (2, 3) [m] of their body.
        points: (m, 3) [m] in a frame of their own.
        poses, poses_of_points: (n, 4, 4) [m] of the body and of the points.
        stride: negative to ask at each pose.
    """
    n = len(poses)
    within = np.zeros(n + 1, dtype=np.bool_)
    for i in range(n):
        within[i] = _all_within(bounds, points, rigid(poses[i]), rigid(poses_of_points[i]))
    answer, last = False, Vec3(0.0, 0.0, 0.0)
    for i in range(n):
        if not within[i]:
            continue
        frame, other = rigid(poses[i]), rigid(poses_of_points[i])
        x = move_back(frame, move(other, row(points, 0)))
        d = sub(x, last)
        if i == 0 or not within[i - 1] or not within[i + 1] or np.sqrt(dot(d, d)) > stride:
            answer, last = _all_wound(triangles, points, frame, other), x
        found[i] = found[i] or answer

"""Where it is open whether a body is inside another one: not all of its points are known to be outside.

One number tells: the generalized winding number (`containment`). Not for: what is proven to be inside, which the
search finds.
"""

import math
from typing import NamedTuple

import numpy as np

from clearance.compile.declared import Flags, Floats2, Floats3
from clearance.compile.decorators import inline, kernel
from clearance.kernels.arithmetic.double_double import frames_of, size
from clearance.kernels.arithmetic.vec3 import Vec3, cross, dot, move, move_back, rigid, row, sub
from clearance.kernels.mesh.surface import Surface
from clearance.kernels.search.containment import (
    Probe,
    in_box,
    solid_angle,
    winding_number,
)
from clearance.kernels.search.scratch import new_scratch


class OutsideRule(NamedTuple):
    """Which points are known to be outside, and which are asked about.

    Attributes:
        most: [turns] a point with a greater winding number is not known to be outside.
        by_one: True if all points are outside where one is known to be, since the faces have openings.
        near_caps: True to ask only where a point may see more than `most` through caps: the search decides others.
        stride: [m] how far the first point moves before it is asked about again. The first and last of poses in a
            row with all points within the bounds are asked anyway. Negative to ask at each pose.
    """

    most: float
    by_one: bool
    near_caps: bool
    stride: float


@inline
def _winding(surface, loose, v, frames, scratch):
    """[turns] the magnitude of the winding number of a point; 0 where it is beside the body."""
    x, far = move(frames.m, v), size(frames.m.t) + size(v)
    if not in_box(surface, surface.roots[0], x, far):
        return 0.0
    probe = Probe(v, x, far)
    number = winding_number(surface, 0, False, probe, frames, scratch.exact, scratch.nodes)
    angles = 0.0
    for i in range(len(loose)):
        a, b, c = row(loose[i], 0), row(loose[i], 1), row(loose[i], 2)
        angles += solid_angle(sub(a, x), sub(b, x), sub(c, x))
    return abs(number + angles / (4.0 * math.pi))


@inline
def _is_in_doubt(surface, loose, points, rule, frames, scratch):
    for k in range(len(points)):
        is_outside = _winding(surface, loose, row(points, k), frames, scratch) <= rule.most
        if is_outside == rule.by_one:
            return not rule.by_one
    return rule.by_one


@inline
def _all_within(bounds, points, m):
    for k in range(len(points)):
        x = move(m, row(points, k))
        if not (bounds[0, 0] <= x.x <= bounds[1, 0] and bounds[0, 1] <= x.y <= bounds[1, 1]):
            return False
        if not bounds[0, 2] <= x.z <= bounds[1, 2]:
            return False
    return True


@inline
def _turns_at_most(surface, low, high, m):
    """[turns] no point of a box from `low` to `high` sees more through the body's caps; infinite if in one.

    A surface of area A that is nowhere nearer than d has a solid angle of at most A / d^2.
    """
    seen = 0.0
    for i in range(0, len(surface.caps), 3):
        a, b, c = row(surface.caps, i), row(surface.caps, i + 1), row(surface.caps, i + 2)
        ab, ac = sub(b, a), sub(c, a)
        x, normal = move_back(m, a), cross(ab, ac)
        dx = max(low.x - x.x, max(0.0, x.x - high.x))
        dy = max(low.y - x.y, max(0.0, x.y - high.y))
        dz = max(low.z - x.z, max(0.0, x.z - high.z))
        away = np.sqrt(dx * dx + dy * dy + dz * dz) - np.sqrt(max(dot(ab, ab), dot(ac, ac)))
        away -= 1e-12 * (size(x) + size(a) + size(b) + size(c) + size(m.t))
        if away <= 1e-100:
            return np.inf
        seen += 0.5 * np.sqrt(dot(normal, normal)) / (away * away)
    return seen / (4.0 * math.pi)


@kernel
def in_doubt(
    surface: Surface,
    loose: Floats3,
    bounds: Floats2,
    points: Floats2,
    rule: OutsideRule,
    poses: Floats3,
    poses_of_points: Floats3,
    found: Flags,
):
    """Sets `found` (n,) where points are not known to be outside a body, at each of n poses.

    Args:
        surface: of one body. loose: (k, 3, 3) [m] triangles of it that count beside its faces and caps.
        bounds: (2, 3) [m] of the body.
        points: (m, 3) [m] in a frame of their own. rule: an `OutsideRule`.
        poses, poses_of_points: (n, 4, 4) [m] of the body and of the points.
    """
    scratch = new_scratch()
    low, high = row(points, 0), row(points, 0)
    for k in range(1, len(points)):
        v = row(points, k)
        low = Vec3(min(low.x, v.x), min(low.y, v.y), min(low.z, v.z))
        high = Vec3(max(high.x, v.x), max(high.y, v.y), max(high.z, v.z))
    near = np.zeros(len(poses) + 1, dtype=np.bool_)
    for i in range(len(poses)):
        frames = frames_of(rigid(poses[i]), rigid(poses_of_points[i]))
        if rule.near_caps:
            near[i] = _turns_at_most(surface, low, high, frames.m) > rule.most
        else:
            near[i] = not rule.by_one or _all_within(bounds, points, frames.m)
    answer, last = False, low
    for i in range(len(poses)):
        if not near[i]:
            continue
        frames = frames_of(rigid(poses[i]), rigid(poses_of_points[i]))
        x = move(frames.m, row(points, 0))
        d = sub(x, last)
        if i == 0 or not (near[i - 1] and near[i + 1]) or np.sqrt(dot(d, d)) > rule.stride:
            answer, last = _is_in_doubt(surface, loose, points, rule, frames, scratch), x
        found[i] = found[i] or answer

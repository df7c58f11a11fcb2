"""Two bodies seen along a direction that their errors tilt, so that boxes cost what they do without errors.

How far errors move a point along a direction is convex in the point. Over the box of a body it is at most an
affine function, whose slope is added to the direction. What that would overrate is kept as rows of their own.
`NOTES.md` in `clearance/budget` has the proof. Not for: the rows (`view`), and which direction (`left`).
"""

import math

from clearance.compile.decorators import inline
from clearance.kernels.arithmetic.lanes import square_root
from clearance.kernels.arithmetic.vec3 import Vec3, along, cross, dot, sub
from clearance.kernels.budget.view import moved_of_point
from clearance.kernels.features.bounds import LEAN, SeparatingDirection, box_reach
from clearance.kernels.motion.joint_path import OUTWARD

OVERRATED = 0.005
"""The share of what errors take in the middle of a body that one row may be overrated by, or it is kept."""


@inline(force=True)
def _keep(r, to):
    to[0], to[1], to[2], to[3] = r[0], r[1], r[2], r[3]


@inline
def _tilt(box, side, u, seen, kept):
    """(slope, [m] value in the middle of the box) above what errors do to a body, but for the rows it keeps."""
    c = box.centre
    radius = math.sqrt(dot(box.half, box.half)) * (1.0 + LEAN)
    little = OVERRATED * moved_of_point(c, side, u, seen)
    slope, height = Vec3(0.0, 0.0, 0.0), seen.alike[side]
    n_linear = n_frames = 0
    for k in range(seen.n_linear[side]):
        r = seen.linear[side, k]
        n = Vec3(r[0], r[1], r[2])
        at = dot(n, c) + r[3]
        reach = box_reach(box, n) + LEAN * radius * math.sqrt(dot(n, n))
        if abs(at) >= reach:  # of one sign
            slope, height = along(slope, 1.0 if at > 0.0 else -1.0, n), height + abs(at)
        elif reach - at * at / reach > little:
            _keep(r, kept.linear[side, n_linear])
            n_linear += 1
        else:  # above |t| at both ends
            slope, height = along(slope, at / reach, n), height + reach
    for k in range(seen.n_frames[side]):
        r = seen.frames[side, k]
        d = sub(c, Vec3(r[0], r[1], r[2]))
        across = along(d, -dot(u, d), u)
        far_sq = dot(across, across)
        top = math.sqrt(far_sq + radius * radius)
        if r[3] * (top - math.sqrt(far_sq)) > little:
            _keep(r, kept.frames[side, n_frames])
            n_frames += 1
        elif top > 0.0:  # 2 |z| <= z^2 / top + top
            slope, height = along(slope, r[3] / top, across), height + r[3] * top
    kept.n_linear[side], kept.n_frames[side] = n_linear, n_frames
    to = kept.directions[side]
    to[0], to[1], to[2] = u.x, u.y, u.z
    return slope, height * OUTWARD


@inline
def tilted(direction, box_a, box_b, seen, kept):
    """A direction along which boxes are bounded with their errors, but for the rows that are kept.

    Args:
        box_a, box_b: of both bodies whole. seen: all rows along the direction. kept: is overwritten.
    """
    u, v = direction.u, direction.v
    slope_a, height_a = _tilt(box_a, 0, u, seen, kept)
    slope_b, height_b = _tilt(box_b, 1, v, seen, kept)
    offset = direction.offset - height_a - height_b
    offset += dot(slope_a, box_a.centre) + dot(slope_b, box_b.centre)
    return SeparatingDirection(along(u, 1.0, slope_a), along(v, -1.0, slope_b), offset)


@inline(force=True)
def kept_of_box(box, side, kept):
    """[m] how far the rows that are kept move any point of a box, or of four in lanes, at most."""
    c, half = box.centre, box.half
    moved = 0.0 * half.x
    for k in range(kept.n_linear[side]):
        r = kept.linear[side, k]
        reach = box_reach(box, Vec3(r[0], r[1], r[2]))
        moved = moved + abs(r[0] * c.x + r[1] * c.y + r[2] * c.z + r[3]) + reach
    for k in range(kept.n_frames[side]):
        r, w = kept.frames[side, k], kept.directions[side]
        d = cross(Vec3(w[0], w[1], w[2]), sub(c, Vec3(r[0], r[1], r[2])))
        moved = moved + r[3] * (square_root(dot(d, d)) + square_root(dot(half, half)))
    return moved * (1.0 + LEAN)


@inline(force=True)
def kept_of_point(x, side, kept):
    """[m] how far the rows that are kept move a point at most, or four in lanes."""
    moved = 0.0 * x.x
    for k in range(kept.n_linear[side]):
        r = kept.linear[side, k]
        moved = moved + abs(r[0] * x.x + r[1] * x.y + r[2] * x.z + r[3])
    for k in range(kept.n_frames[side]):
        r, w = kept.frames[side, k], kept.directions[side]
        d = cross(Vec3(w[0], w[1], w[2]), sub(x, Vec3(r[0], r[1], r[2])))
        moved = moved + r[3] * square_root(dot(d, d))
    return moved * OUTWARD

"""The rows of errors along one direction: the part that is the same for all nodes, computed once.

For boxes the direction is tilted, so that their bounds cost no more than without errors. The motion of a point
along a direction by errors is convex in the point. Over the box of a body an affine function bounds it; its slope
is added to the direction. Rows that this function would overrate stay separate. `NOTES.md` in `clearance/budget`
has the proof. Not for: the rows of errors (`rows`), and the direction (`search.proof`).
"""

import math
from typing import NamedTuple

import numpy as np

from clearance.compile.declared import Floats, Floats2, Floats3, Integers
from clearance.compile.decorators import inline
from clearance.kernels.arithmetic.lanes import square_root
from clearance.kernels.arithmetic.vec3 import Vec3, along, cross, dot, sub
from clearance.kernels.budget.errors import (
    FIRST,
    FRAME,
    KIND,
    OFFSETS,
    REST,
    SLIDE,
    TURN,
)
from clearance.kernels.features.bounds import LEAN, SeparatingDirection, box_reach
from clearance.kernels.motion.joint_path import OUTWARD

OVERRATED = 0.005
"""A row overrated by more than this share of the loss in the middle of a body stays separate."""


class AlongRows(NamedTuple):
    """The rows of both bodies of a pair along one direction.

    Attributes:
        linear: (2, rows, 4) n and c: a point x moves by |n . x + c| [m]. n_linear: (2,).
        frames: (2, rows, 4) o and an angle: a point x moves by angle |u x (x - o)| [m]. n_frames: (2,).
        common: (2,) [m] motion of every point.
        directions: (2, 3) unit.
    """

    linear: Floats3
    n_linear: Integers
    frames: Floats3
    n_frames: Integers
    common: Floats
    directions: Floats2


@inline
def new_along_rows(most_rows):
    """Empty rows."""
    return AlongRows(
        np.zeros((2, most_rows, 4)), np.zeros(2, dtype=np.int64),
        np.zeros((2, most_rows, 4)), np.zeros(2, dtype=np.int64), np.zeros(2),
        np.zeros((2, 3)),
    )  # fmt: skip


@inline
def project_errors(found, body, side, u, seen):
    """Writes a body's errors along a unit direction of its frame."""
    rows = found.rows[body]
    moved = found.sums[body, OFFSETS] + found.sums[body, REST]
    n_linear = n_frames = 0
    for k in range(found.n_rows[body]):
        r = rows[k]
        kind, first = r[KIND], r[FIRST]
        o, a = Vec3(r[0], r[1], r[2]), Vec3(r[3], r[4], r[5])
        if kind == SLIDE:
            moved += first * abs(dot(u, a))
        elif kind == FRAME and first > 0.0:
            row = seen.frames[side, n_frames]
            row[0], row[1], row[2], row[3] = o.x, o.y, o.z, first
            n_frames += 1
        elif kind != FRAME:
            n = cross(u, a)
            row = seen.linear[side, n_linear]
            if kind == TURN:
                row[0], row[1], row[2] = first * n.x, first * n.y, first * n.z
                row[3] = -first * dot(n, o)
            else:
                row[0], row[1], row[2], row[3] = n.x, n.y, n.z, dot(u, o)
            n_linear += 1
    seen.n_linear[side], seen.n_frames[side] = n_linear, n_frames
    seen.common[side] = moved * OUTWARD
    seen.directions[side, 0], seen.directions[side, 1], seen.directions[side, 2] = u.x, u.y, u.z


@inline(force=True)
def moved_of_point(x, side, u, seen):
    """[m] the greatest motion of a point, or four in lanes, along the direction, by errors and joints."""
    moved = seen.common[side] + 0.0 * x.x  # as many lanes
    for k in range(seen.n_linear[side]):
        r = seen.linear[side, k]
        moved = moved + abs(r[0] * x.x + r[1] * x.y + r[2] * x.z + r[3])
    for k in range(seen.n_frames[side]):
        r = seen.frames[side, k]
        d = cross(u, sub(x, Vec3(r[0], r[1], r[2])))
        moved = moved + r[3] * square_root(dot(d, d))
    return moved * OUTWARD


@inline(force=True)
def _copy_row(r, to):
    to[0], to[1], to[2], to[3] = r[0], r[1], r[2], r[3]


@inline
def _tilt(box, side, u, seen, separate):
    """(slope, [m] value in the middle of the box) of a bound on the motion by all rows that are not separate."""
    c = box.centre
    radius = math.sqrt(dot(box.half, box.half)) * (1.0 + LEAN)
    little = OVERRATED * moved_of_point(c, side, u, seen)
    slope, height = Vec3(0.0, 0.0, 0.0), seen.common[side]
    n_linear = n_frames = 0
    for k in range(seen.n_linear[side]):
        r = seen.linear[side, k]
        n = Vec3(r[0], r[1], r[2])
        at = dot(n, c) + r[3]
        reach = box_reach(box, n) + LEAN * radius * math.sqrt(dot(n, n))
        if abs(at) >= reach:  # of one sign
            slope, height = along(slope, 1.0 if at > 0.0 else -1.0, n), height + abs(at)
        elif reach - at * at / reach > little:
            _copy_row(r, separate.linear[side, n_linear])
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
            _copy_row(r, separate.frames[side, n_frames])
            n_frames += 1
        elif top > 0.0:  # 2 |z| <= z^2 / top + top
            slope, height = along(slope, r[3] / top, across), height + r[3] * top
    separate.n_linear[side], separate.n_frames[side] = n_linear, n_frames
    to = separate.directions[side]
    to[0], to[1], to[2] = u.x, u.y, u.z
    return slope, height * OUTWARD


@inline
def tilted(direction, box_a, box_b, seen, separate):
    """A direction along which bounds of boxes include their errors, except those of separate rows.

    Args:
        box_a, box_b: of the whole bodies. seen: all rows along the direction. separate: overwritten.
    """
    u, v = direction.u, direction.v
    slope_a, height_a = _tilt(box_a, 0, u, seen, separate)
    slope_b, height_b = _tilt(box_b, 1, v, seen, separate)
    offset = direction.offset - height_a - height_b
    offset += dot(slope_a, box_a.centre) + dot(slope_b, box_b.centre)
    return SeparatingDirection(along(u, 1.0, slope_a), along(v, -1.0, slope_b), offset)


@inline(force=True)
def separate_of_box(box, side, separate):
    """[m] the greatest motion of any point of a box, or of four in lanes, by separate rows."""
    c, half = box.centre, box.half
    moved = 0.0 * half.x
    for k in range(separate.n_linear[side]):
        r = separate.linear[side, k]
        reach = box_reach(box, Vec3(r[0], r[1], r[2]))
        moved = moved + abs(r[0] * c.x + r[1] * c.y + r[2] * c.z + r[3]) + reach
    for k in range(separate.n_frames[side]):
        r, w = separate.frames[side, k], separate.directions[side]
        d = cross(Vec3(w[0], w[1], w[2]), sub(c, Vec3(r[0], r[1], r[2])))
        moved = moved + r[3] * (square_root(dot(d, d)) + square_root(dot(half, half)))
    return moved * (1.0 + LEAN)


@inline(force=True)
def separate_of_point(x, side, separate):
    """[m] the greatest motion of a point, or four in lanes, by separate rows."""
    moved = 0.0 * x.x
    for k in range(separate.n_linear[side]):
        r = separate.linear[side, k]
        moved = moved + abs(r[0] * x.x + r[1] * x.y + r[2] * x.z + r[3])
    for k in range(separate.n_frames[side]):
        r, w = separate.frames[side, k], separate.directions[side]
        d = cross(Vec3(w[0], w[1], w[2]), sub(x, Vec3(r[0], r[1], r[2])))
        moved = moved + r[3] * square_root(dot(d, d))
    return moved * OUTWARD

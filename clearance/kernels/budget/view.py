"""The rows of errors along one direction: the part that is the same for all nodes, computed once.

Not for: the rows of errors (`rows`).
"""

from typing import NamedTuple

import numpy as np

from clearance.compile.declared import Floats, Floats2, Floats3, Integers
from clearance.compile.decorators import inline
from clearance.kernels.arithmetic.lanes import square_root
from clearance.kernels.arithmetic.vec3 import Vec3, cross, dot, sub
from clearance.kernels.budget.errors import (
    FIRST,
    FRAME,
    KIND,
    OFFSETS,
    REST,
    SLIDE,
    TURN,
)
from clearance.kernels.motion.joint_path import OUTWARD


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

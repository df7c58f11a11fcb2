"""How far errors move the nodes of a body along one direction: what is the same for all nodes, worked out once.

Not for: the rows of errors (`rows`).
"""

import math
from typing import NamedTuple

import numpy as np

from clearance.compile.jit import inline, shared
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
from clearance.kernels.features.bounds import LEAN
from clearance.kernels.motion.joint_path import OUTWARD


class AlongRows(NamedTuple):
    """The rows of both bodies of a pair, seen along one direction.

    Attributes:
        linear: (2, rows, 4) a point x moves by |n . x + c| [m]: n and c. n_linear: (2,).
        frames: (2, rows, 4) or by angle |u x (x - o)|: o and the angle. n_frames: (2,).
        numbers: (2, 2) [m] what any point moves by; by how much more for each metre that points are apart.
    """

    linear: np.ndarray
    n_linear: np.ndarray
    frames: np.ndarray
    n_frames: np.ndarray
    numbers: np.ndarray


@shared
def new_along_rows(most_rows):
    """Rows that are not seen yet."""
    return AlongRows(
        np.zeros((2, most_rows, 4)), np.zeros(2, dtype=np.int64),
        np.zeros((2, most_rows, 4)), np.zeros(2, dtype=np.int64), np.zeros((2, 2)),
    )  # fmt: skip


@inline
def look_along(found, body, side, u, seen):
    """Writes how a body's errors are seen along a unit direction of its frame."""
    rows = found.rows[body]
    moved = found.sums[body, OFFSETS] + found.sums[body, REST]
    steep = 0.0
    n_linear = n_frames = 0
    for k in range(found.n_rows[body]):
        r = rows[k]
        kind, first = r[KIND], r[FIRST]
        o, a = Vec3(r[0], r[1], r[2]), Vec3(r[3], r[4], r[5])
        if kind == SLIDE:
            moved += first * abs(dot(u, a))
        elif kind == FRAME:
            row = seen.frames[side, n_frames]
            row[0], row[1], row[2], row[3] = o.x, o.y, o.z, first
            steep += first
            n_frames += 1
        else:
            n = cross(u, a)
            row = seen.linear[side, n_linear]
            if kind == TURN:
                row[0], row[1], row[2] = first * n.x, first * n.y, first * n.z
                row[3] = -first * dot(n, o)
                steep += first * math.sqrt(dot(n, n))
            else:
                row[0], row[1], row[2], row[3] = n.x, n.y, n.z, dot(u, o)
                steep += math.sqrt(dot(n, n))
            n_linear += 1
    seen.n_linear[side], seen.n_frames[side] = n_linear, n_frames
    seen.numbers[side, 0], seen.numbers[side, 1] = moved * OUTWARD, steep * OUTWARD


@inline(force=True)
def moved_of_box(box, side, u, seen):
    """[m] how far errors and motion move any point of a box, or of four in lanes, along the direction seen."""
    radius = square_root(dot(box.half, box.half)) * (1.0 + LEAN)
    moved = seen.numbers[side, 1] * radius + seen.numbers[side, 0]
    c = box.centre
    for k in range(seen.n_linear[side]):
        r = seen.linear[side, k]
        moved = moved + abs(r[0] * c.x + r[1] * c.y + r[2] * c.z + r[3])
    for k in range(seen.n_frames[side]):
        r = seen.frames[side, k]
        d = cross(u, sub(c, Vec3(r[0], r[1], r[2])))
        moved = moved + r[3] * square_root(dot(d, d))
    return moved * OUTWARD


@inline(force=True)
def moved_of_point(x, side, u, seen):
    """[m] how far errors and motion move a point along the direction seen at most."""
    moved = seen.numbers[side, 0]
    for k in range(seen.n_linear[side]):
        r = seen.linear[side, k]
        moved += abs(r[0] * x.x + r[1] * x.y + r[2] * x.z + r[3])
    for k in range(seen.n_frames[side]):
        r = seen.frames[side, k]
        d = cross(u, sub(x, Vec3(r[0], r[1], r[2])))
        moved += r[3] * math.sqrt(dot(d, d))
    return moved * OUTWARD

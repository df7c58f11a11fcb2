"""Through which face a ray from a convex body's centroid leaves it: a map of directions, proven complete.

The directions, after a linear map that makes the body round, are divided into k x k cells on each side of a
cube. Each cell lists every face whose projection meets it, so the face with the greatest n.v/w (the gauge of
v, 1 on the surface) is among those few, whatever the shape: no climbing, hence no false tops. Each cell also
has a bound: the gauge is convex, hence at most its greatest value in the cell's four corners.

If rounding puts another face's plane in front, the listed one falls short of it by no more than the corners
of the body stand out of its own planes, relatively. Not for: deciding what a body's faces are.
"""

from __future__ import annotations

import math

import numpy as np

from clearance.compile.declared import Floats2, Integers
from clearance.compile.decorators import inline, kernel
from clearance.kernels.polytope.body import (
    INNER_SQ,
    INVERSE_WIDTH,
    N_CELLS,
    N_FACES,
    NORMAL,
    ROUND_FROM_BODY,
    WIDTH,
    PackedBody,
    bound_at,
    cell_entries,
    face_number,
    face_vector,
    into_round,
)

BALL_SLACK = 4e-9
"""[-] How much less than its greatest possible radius the inner ball has: what lies in it is inside for all."""


@inline
def cell_at(x, y, z, k):
    """(cell, greatest coordinate's magnitude) of a direction in the round frame."""
    ax = abs(x)
    ay = abs(y)
    az = abs(z)
    if ax >= ay and ax >= az:
        side, most, s, t = (0 if x >= 0.0 else 1), ax, y, z
    elif ay >= az:
        side, most, s, t = (2 if y >= 0.0 else 3), ay, z, x
    else:
        side, most, s, t = (4 if z >= 0.0 else 5), az, x, y
    if most == 0.0:
        return 0, 0.0
    half = 0.5 * k / most
    i = min(int((s + most) * half), k - 1)
    j = min(int((t + most) * half), k - 1)
    return (side * k + i) * k + j, most


@inline
def cell_of(body, x, y, z):
    """(cell, upper bound on the gauge) of the point (x, y, z) about the centroid."""
    numbers, indices = body.numbers, body.indices
    u, v, w = into_round(numbers, x, y, z)
    cell, most = cell_at(u, v, w, indices[N_CELLS])
    return cell, most * numbers[bound_at(indices, cell)]


@inline
def is_in_ball(body, x, y, z):
    """True if (x, y, z) about the centroid lies in a ball of the round frame that is wholly inside the body."""
    u, v, w = into_round(body.numbers, x, y, z)
    return u * u + v * v + w * w < body.numbers[INNER_SQ]


@inline
def exit_in(body, cell, x, y, z):
    """(face, gauge): the face of the cell's list with the greatest n.v/w at (x, y, z) about the centroid."""
    numbers, indices = body.numbers, body.indices
    best = -math.inf
    face = 0
    begin, end = cell_entries(indices, cell)
    for at in range(begin, end):
        i = indices[at]
        nx, ny, nz = face_vector(numbers, i, NORMAL)
        value = nx * x + ny * y + nz * z
        value *= face_number(numbers, i, INVERSE_WIDTH)
        if value > best:
            best = value
            face = i
    return face, best


@inline
def clipped(ring, spare, n, sign, other):
    """Number of corners left of the cone over `ring[:n]` where ring[0] >= sign ring[other]."""
    n_kept = 0
    for i in range(n):
        p = ring[i]
        q = ring[(i + 1) % n]
        a = p[0] - sign * p[other]
        b = q[0] - sign * q[other]
        if a >= 0.0:
            for c in range(3):
                spare[n_kept, c] = p[c]
            n_kept += 1
        if (a > 0.0 and b < 0.0) or (a < 0.0 and b > 0.0):
            for c in range(3):
                spare[n_kept, c] = p[c] + (q[c] - p[c]) * (a / (a - b))
            n_kept += 1
    for i in range(n_kept):
        for c in range(3):
            ring[i, c] = spare[i, c]
    return n_kept


@inline
def ring_on_side(corners, flat, begin, end, side, pad, ring, spare):
    """Number of corners of a face's projection to a side of the cube, as rows (s, t) of `ring`."""
    axis = side // 2
    sign = 1.0 if side % 2 == 0 else -1.0
    most = 0.0
    n = end - begin
    for i in range(n):
        p = corners[flat[begin + i]]
        ring[i, 0] = (sign + sign * pad) * p[axis]
        ring[i, 1] = p[(axis + 1) % 3]
        ring[i, 2] = p[(axis + 2) % 3]
        most = max(most, ring[i, 0])
    if most <= 0.0:
        return 0
    for i in range(4):
        n = clipped(ring, spare, n, 1.0 if i < 2 else -1.0, 1 + i % 2)
    for i in range(n):
        front = ring[i, 0] if ring[i, 0] > 0.0 else math.inf
        ring[i, 0] = ring[i, 1] / front
        ring[i, 1] = ring[i, 2] / front
    return n


@inline
def misses(ring, n, turn, pad, s, t, half):
    """True if a square about (s, t) lies wholly beyond one edge of the flat ring."""
    for i in range(n):
        along = ring[(i + 1) % n, 0] - ring[i, 0]
        up = ring[(i + 1) % n, 1] - ring[i, 1]
        left = turn * (along * (t - ring[i, 1]) - up * (s - ring[i, 0]))
        if left < -half * (abs(along) + abs(up)) - pad:
            return True
    return False


@inline
def area_sign(ring, n):
    """1 if the flat ring turns left, else -1."""
    twice = 0.0
    for i in range(1, n - 1):
        twice += (ring[i, 0] - ring[0, 0]) * (ring[i + 1, 1] - ring[0, 1])
        twice -= (ring[i, 1] - ring[0, 1]) * (ring[i + 1, 0] - ring[0, 0])
    return 1.0 if twice >= 0.0 else -1.0


@inline
def cell_span(ring, n, column, pad, k):
    """The first and the last cell that the flat ring reaches in one coordinate."""
    low = math.inf
    high = -math.inf
    for i in range(n):
        low = min(low, ring[i, column])
        high = max(high, ring[i, column])
    first = math.floor((low - pad + 1.0) * 0.5 * k)
    last = math.floor((high + pad + 1.0) * 0.5 * k)
    return max(0, min(k - 1, first)), max(0, min(k - 1, last))


@kernel
def exit_cells(
    corners: Floats2, starts: Integers, flat: Integers, k: int, pad: float
) -> tuple[Integers, Integers]:
    """(cell of each entry, face of each entry): which faces each cell sees, faces ascending.

    Args:
        corners: (n, 3) about the centroid in the round frame; starts, flat: the faces.
        pad: how much wider than a face's projection is taken.
    """
    most = 0
    for f in range(len(starts) - 1):
        most = max(most, starts[f + 1] - starts[f])
    ring = np.empty((most + 8, 3))
    spare = np.empty((most + 8, 3))
    cells = np.empty(16 * len(starts) + 64, dtype=np.int64)
    faces = np.empty(16 * len(starts) + 64, dtype=np.int64)
    n_found = 0
    for f in range(len(starts) - 1):
        for side in range(6):
            n = ring_on_side(corners, flat, starts[f], starts[f + 1], side, pad, ring, spare)
            if n == 0:
                continue
            turn = area_sign(ring, n)
            low, high = cell_span(ring, n, 0, 2.0 * pad, k)
            left, right = cell_span(ring, n, 1, 2.0 * pad, k)
            if n_found + (high - low + 1) * (right - left + 1) > len(cells):
                more = np.empty(len(cells) + k * k, dtype=np.int64)
                cells = np.concatenate((cells, more))
                faces = np.concatenate((faces, more))
            for i in range(low, high + 1):
                for j in range(left, right + 1):
                    s = (2.0 * i + 1.0) / k - 1.0
                    t = (2.0 * j + 1.0) / k - 1.0
                    if not misses(ring, n, turn, 8.0 * pad, s, t, 1.0 / k):
                        cells[n_found] = (side * k + i) * k + j
                        faces[n_found] = f
                        n_found += 1
    return cells[:n_found], faces[:n_found]


@inline
def inner_radius_sq(numbers, n_faces, back, slack):
    """The square of the radius of the ball in the round frame that every plane leaves room for, less `slack`.

    The plane n.x = w stands w / |n back| from the centroid there.
    """
    least = math.inf
    for face in range(n_faces):
        n = face_vector(numbers, face, NORMAL)
        length_sq = 0.0
        for c in range(3):
            part = 0.0
            for d in range(3):
                part += n[d] * back[d, c]
            length_sq += part * part
        width = face_number(numbers, face, WIDTH)
        least = min(least, width * width / length_sq)
    return least * max(0.0, 1.0 - slack) ** 2


@kernel
def bound_cells(body: PackedBody, back: Floats2):
    """Fills in each cell's bound: the greatest gauge of its faces in its four corners; and the ball.

    The bounds are raised by 1e-12, and by what rounding in the round frame may hide: 8 u |there| |back|.

    Args:
        back: (3, 3) from the round frame to the body's.
    """
    numbers, indices = body.numbers, body.indices
    k = indices[N_CELLS]
    there_sq = 0.0
    back_sq = 0.0
    for c in range(9):
        there_sq += numbers[ROUND_FROM_BODY + c] ** 2
        back_sq += back[c // 3, c % 3] ** 2
    hidden = 8.0 * 2.0**-53 * math.sqrt(there_sq * back_sq)
    slack = BALL_SLACK + hidden
    numbers[INNER_SQ] = inner_radius_sq(numbers, indices[N_FACES], back, slack)
    for side in range(6):
        axis = side // 2
        sign = 1.0 if side % 2 == 0 else -1.0
        for i in range(k):
            for j in range(k):
                cell = (side * k + i) * k + j
                most = 0.0
                for corner in range(4):
                    s = 2.0 * (i + corner // 2) / k - 1.0
                    t = 2.0 * (j + corner % 2) / k - 1.0
                    d = np.empty(3)
                    for c in range(3):
                        d[c] = (
                            sign * back[c, axis]
                            + s * back[c, (axis + 1) % 3]
                            + t * back[c, (axis + 2) % 3]
                        )
                    most = max(most, exit_in(body, cell, d[0], d[1], d[2])[1])
                numbers[bound_at(indices, cell)] = most * (1.0 + 1e-12 + hidden)

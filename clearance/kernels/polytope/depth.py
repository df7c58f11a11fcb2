"""The deepest common point of convex bodies, by the simplex method with faces brought in on demand.

Each body k is {x: n_i.(x - c_k) <= w_i} with w_i > 0, c_k inside it. Sought are x and the greatest t with
n_i.x + w_i t <= n_i.c_k + w_i for all faces of all bodies: t > 0 is strictly inside all, t < 0 proves that
at most four faces have nothing in common (Helly). The dual simplex basis has four faces; the entering face
is the one through which the ray from c_k to x leaves the body, from its map of directions: none is missed.
All x are about a common origin. Not for: the region itself.
"""

from __future__ import annotations

import math
from typing import NamedTuple

import numpy as np

from clearance.compile.declared import Floats, Floats2, Floats3, Integers, Integers2
from clearance.compile.decorators import inline, kernel
from clearance.kernels.polytope.bodies import body_at
from clearance.kernels.polytope.body import (
    NORMAL,
    SIZE,
    WIDTH,
    PackedBody,
    centroid_of,
    face_number,
    face_vector,
)
from clearance.kernels.polytope.exits import cell_of, exit_in

TURN = 4
"""Faces of one body at a time: settling one body fully before the next takes 5 times as long for 5000 corners."""

T = 3
"""Where t stands after x in the solution, and w after n in a face's row."""

FACES, BOUNDS, INVERSE, SOLUTION, SHARES, SCRATCH = slice(4), 4, slice(5, 9), 9, 10, slice(11, 15)
N_ROWS = 15
"""The rows of four numbers of a `Basis`, and how many there are."""

LEVEL = 12
"""Rounds in which the depth does not fall before the method is said to turn in a circle."""
COLD, WARM, ON = 0, 1, 2


class Basis(NamedTuple):
    """Four faces, and the point where their planes meet.

    Attributes:
        faces: (4, 4) normal n and width w of each. bounds: (4,) n.c + w. inverse: (4, 4), of `faces`.
        solution: (4,) x [m] and t. shares: (4,) the multiplier of each face.
        scratch: (4, 4).
        names: (4,) `(body << 32) + face`, below 0 for a wall of the start.
    """

    faces: Floats2
    bounds: Floats
    inverse: Floats2
    solution: Floats
    shares: Floats
    scratch: Floats2
    names: Integers


@inline
def basis_in(block, names):
    """The `Basis` whose numbers lie in `block` (`N_ROWS`, 4)."""
    return Basis(
        block[FACES], block[BOUNDS], block[INVERSE], block[SOLUTION], block[SHARES], block[SCRATCH],
        names,
    )  # fmt: skip


class PlacedBody(NamedTuple):
    """A body, its number, and (4, 4) world_from_body."""

    body: PackedBody
    pose: np.ndarray
    name: int


@inline
def invert(basis):
    """True if the faces' matrix could be inverted, by Gauss-Jordan with row pivoting."""
    a, inverse = basis.scratch, basis.inverse
    for i in range(4):
        for j in range(4):
            a[i, j] = basis.faces[i, j]
            inverse[i, j] = 1.0 if i == j else 0.0
    for c in range(4):
        p = c
        for r in range(c + 1, 4):
            if abs(a[r, c]) > abs(a[p, c]):
                p = r
        if a[p, c] == 0.0:
            return False
        scale = 1.0 / a[p, c]
        for j in range(4):
            low = a[c, j]
            a[c, j] = a[p, j] * scale
            a[p, j] = low if p != c else a[p, j]
            low = inverse[c, j]
            inverse[c, j] = inverse[p, j] * scale
            inverse[p, j] = low if p != c else inverse[p, j]
        for r in range(4):
            factor = a[r, c]
            if r != c and factor != 0.0:
                for j in range(4):
                    a[r, j] -= factor * a[c, j]
                    inverse[r, j] -= factor * inverse[c, j]
    return True


@inline
def solve(basis):
    """False if the faces' planes meet in no one point or a multiplier is below 0; else sets both."""
    if not invert(basis):
        return False
    for i in range(4):
        total = 0.0
        for j in range(4):
            total += basis.inverse[i, j] * basis.bounds[j]
        basis.solution[i] = total
    sound = True
    for j in range(4):
        share = basis.inverse[T, j]
        sound = sound and share > -1e-9
        basis.shares[j] = max(share, 0.0)
    return sound


@inline
def start_around(basis, reach):
    """A tetrahedron far around the origin; t at its middle is 1."""
    side = 1.0 / math.sqrt(3.0)
    for j in range(4):
        basis.names[j] = j - 4
        basis.faces[j, 0] = side if j < 2 else -side
        basis.faces[j, 1] = side if j % 2 == 0 else -side
        basis.faces[j, 2] = side if j == 0 or j == 3 else -side
        basis.faces[j, T] = reach
        basis.bounds[j] = reach
    solve(basis)


@inline
def put_face(basis, j, placed, away, face):
    """Puts a face at place `j` of the basis; `away` is from the origin to the body's centroid."""
    pose, numbers = placed.pose, placed.body.numbers
    width = face_number(numbers, face, WIDTH)
    x, y, z = face_vector(numbers, face, NORMAL)
    bound = width
    for i in range(3):
        n = pose[i, 0] * x + pose[i, 1] * y + pose[i, 2] * z
        basis.faces[j, i] = n
        bound += n * away[i]
    basis.faces[j, T] = width
    basis.bounds[j] = bound
    basis.names[j] = (placed.name << 32) + np.int64(face)


@inline
def leaving(basis, placed, face):
    """The place in the basis that the ratio test gives to a face, or -1."""
    pose, numbers = placed.pose, placed.body.numbers
    width = face_number(numbers, face, WIDTH)
    x, y, z = face_vector(numbers, face, NORMAL)
    leave = -1
    least = math.inf
    steepest = 0.0
    for j in range(4):
        slope = width * basis.inverse[T, j]
        for i in range(3):
            n = pose[i, 0] * x + pose[i, 1] * y + pose[i, 2] * z
            slope += n * basis.inverse[i, j]
        if slope <= 1e-12:
            continue
        ratio = basis.shares[j] / slope
        if ratio < least or (ratio == least and slope > steepest):
            least = ratio
            leave = j
            steepest = slope
    return leave


@inline
def centre_of(placed, origin):
    """From the origin to the body's centroid in the world."""
    pose = placed.pose
    x, y, z = centroid_of(placed.body.numbers)
    return (
        (pose[0, 0] * x + pose[0, 1] * y + pose[0, 2] * z + pose[0, 3]) - origin[0],
        (pose[1, 0] * x + pose[1, 1] * y + pose[1, 2] * z + pose[1, 3]) - origin[1],
        (pose[2, 0] * x + pose[2, 1] * y + pose[2, 2] * z + pose[2, 3]) - origin[2],
    )


@inline
def is_separate(basis):
    """True if four faces of bodies, none of the start's walls, have t plainly below 0."""
    names = basis.names
    return basis.solution[T] < -1e-6 and min(names[0], names[1], names[2], names[3]) >= 0


@inline
def deepen(placed, origin, basis, margin):
    """(settled, faces brought in): brings in a body's worst faces, `TURN` at most, in widths by `margin` worse."""
    pose, body, away = placed.pose, placed.body, centre_of(placed, origin)
    names = basis.names
    for n_entered in range(TURN):
        x = basis.solution[0] - away[0]
        y = basis.solution[1] - away[1]
        z = basis.solution[2] - away[2]
        u = pose[0, 0] * x + pose[1, 0] * y + pose[2, 0] * z
        v = pose[0, 1] * x + pose[1, 1] * y + pose[2, 1] * z
        w = pose[0, 2] * x + pose[1, 2] * y + pose[2, 2] * z
        cell, _ = cell_of(body, u, v, w)
        face, gauge = exit_in(body, cell, u, v, w)
        if gauge <= 1.0 - basis.solution[T] + margin:
            return True, n_entered
        name = (placed.name << 32) + np.int64(face)
        if name == names[0] or name == names[1] or name == names[2] or name == names[3]:
            return False, n_entered
        leave = leaving(basis, placed, face)
        if leave < 0:
            return False, n_entered
        put_face(basis, leave, placed, away, face)
        solve(basis)
    return False, TURN


@inline
def recall(placed, origin, basis):
    """Puts the faces that the basis names of one body where they are now."""
    away, names = centre_of(placed, origin), basis.names
    for j in range(4):
        if names[j] >= 0 and names[j] >> 32 == placed.name:
            put_face(basis, j, placed, away, names[j] & 0xFFFFFFFF)


@inline
def deepen_two(a, b, origin, basis, margin, begin, passes):
    """Brings in faces of bodies `a` and `b` by turns until neither has a worse one; (settled, faces, passes).

    Args:
        a, b: `PlacedBody`.
        origin: (3,) what all x are about. basis: a `Basis`, changed in place.
        begin: COLD, WARM (from the faces named, if they still hold) or ON (from the basis as it is).
        passes: how many rounds at most; stops when four real faces have t < -1e-6.
    """
    if begin == WARM:
        recall(a, origin, basis)
        recall(b, origin, basis)
    if begin == COLD or (begin == WARM and not solve(basis)):
        start_around(basis, 16.0 * (a.body.numbers[SIZE] + b.body.numbers[SIZE]))
    n_entered = 0
    n_level = 0
    for i_pass in range(1, passes + 1):
        before = basis.solution[T]
        one, n_one = deepen(a, origin, basis, margin)
        other, n_other = deepen(b, origin, basis, margin)
        n_entered += n_one + n_other
        if n_one + n_other == 0 or is_separate(basis):
            return one and other, n_entered, i_pass
        n_level = 0 if before - basis.solution[T] > margin else n_level + 1
        if n_level == LEVEL:
            return False, n_entered, i_pass
    return False, n_entered, passes


@inline
def placed_body(rows, poses, k):
    """Body `k`; where there is one pose it is that of all."""
    return PlacedBody(body_at(rows, k), poses[min(k, len(poses) - 1)], k)


@kernel
def deepen_all(
    rows: Integers2,
    poses: Floats3,
    origin: Floats,
    block: Floats2,
    names: Integers,
    margin: float,
    begin: int,
    passes: int,
) -> tuple[bool, int, int]:
    """Brings in faces of all bodies, two bodies at a time until none has a worse one; (settled, faces, passes).

    Args:
        rows: (m, 4) the bodies, of `polytope.bodies`. poses: (m, 4, 4) world_from_body, or (1, 4, 4) for all.
        block: (`N_ROWS`, 4) the numbers of a `Basis`. names: (4,) its names.
        passes: how many rounds over all bodies at most. Else as `deepen_two`.
    """
    m, basis = len(rows), basis_in(block, names)
    at_once, n_rounds = (passes, 1) if m < 3 else (2, passes)
    n_entered = 0
    for i_round in range(1, n_rounds + 1):
        n_before, settled = n_entered, True
        for k in range(0, m, 2):
            a, b = placed_body(rows, poses, k), placed_body(rows, poses, min(k + 1, m - 1))
            sure, n, n_passes = deepen_two(a, b, origin, basis, margin, begin, at_once)
            if m < 3:
                return sure, n, n_passes
            begin, n_entered, settled = ON, n_entered + n, settled and sure
            if is_separate(basis):
                return settled, n_entered, i_round
        if n_entered == n_before:
            return settled, n_entered, i_round
    return False, n_entered, passes

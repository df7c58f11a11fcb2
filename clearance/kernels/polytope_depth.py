"""The deepest common point of convex bodies, by the simplex method with faces brought in on demand.

Each body k is {x: n_i.(x - c_k) <= w_i} with w_i > 0, c_k inside it. Sought are x and the greatest t with
n_i.x + w_i t <= n_i.c_k + w_i for all faces of all bodies: t > 0 is strictly inside all, t < 0 proves that
at most four faces have nothing in common (Helly). The dual simplex basis has four faces; the entering face
is the worst of one body at x, found by hill climbing over the face graph, since n_i.(x - c)/w_i is linear
over the polar body. Not for: the region itself.
"""

from __future__ import annotations

import numpy as np

from clearance.jit import inlined, kernel

INSIDE, DISJOINT, UNSETTLED = 0, 1, 2
LIMIT = 256


@inlined
def invert(matrix, inverse):
    """True if the (4, 4) matrix could be inverted, by Gauss-Jordan with row pivoting, into `inverse`."""
    work = matrix.copy()
    for i in range(4):
        for j in range(4):
            inverse[i, j] = 1.0 if i == j else 0.0
    for c in range(4):
        p = c
        for r in range(c + 1, 4):
            if abs(work[r, c]) > abs(work[p, c]):
                p = r
        if work[p, c] == 0.0:
            return False
        for j in range(4):
            work[c, j], work[p, j] = work[p, j], work[c, j]
            inverse[c, j], inverse[p, j] = inverse[p, j], inverse[c, j]
        scale = 1.0 / work[c, c]
        for j in range(4):
            work[c, j] *= scale
            inverse[c, j] *= scale
        for r in range(4):
            if r != c and work[r, c] != 0.0:
                factor = work[r, c]
                for j in range(4):
                    work[r, j] -= factor * work[c, j]
                    inverse[r, j] -= factor * inverse[c, j]
    return True


@inlined
def worst_face(normals, widths, starts, neighbours, face, x, y, z):
    """The face with the greatest n.(x - c)/w, climbing from `face`; (x, y, z) is x - c."""
    best = (normals[face, 0] * x + normals[face, 1] * y + normals[face, 2] * z) / widths[face]
    while True:
        here = face
        for i in range(starts[here], starts[here + 1]):
            g = neighbours[i]
            value = (normals[g, 0] * x + normals[g, 1] * y + normals[g, 2] * z) / widths[g]
            if value > best:
                best = value
                face = g
        if face == here:
            return face


@inlined
def solve_basis(rows, bounds, inverse, point, shares):
    """Sets `point` = (x, t) where the four basis planes meet and `shares` = the basis multipliers."""
    if not invert(rows, inverse):
        return False
    for i in range(4):
        total = 0.0
        for j in range(4):
            total += inverse[i, j] * bounds[j]
        point[i] = total
    for j in range(4):
        shares[j] = max(inverse[3, j], 0.0)
    return True


@inlined
def enter(rows, bounds, names, inverse, shares, row, bound, name):
    """True if the plane took the place that the ratio test gives; False if no plane may leave."""
    leave = -1
    least = np.inf
    steepest = 0.0
    for j in range(4):
        slope = 0.0
        for i in range(4):
            slope += row[i] * inverse[i, j]
        if slope <= 1e-12:
            continue
        ratio = shares[j] / slope
        if ratio < least or (ratio == least and slope > steepest):
            least = ratio
            leave = j
            steepest = slope
    if leave < 0:
        return False
    for i in range(4):
        rows[leave, i] = row[i]
    bounds[leave] = bound
    names[leave] = name
    return True


@kernel
def deepen(
    normals, widths, starts, neighbours, centre, body, face, margin,
    rows, bounds, names, inverse, point, shares,
):  # fmt: skip
    """Brings faces of one body into the basis until none is worse than `margin` at the point.

    Args:
        centre: (3,) the body's inner point; body: its number; face: where to begin.
        margin: [-] the violation, in parts of the body's width, that is let pass.
        rows, bounds, names, inverse, point, shares: the basis, changed in place; a name is
            (body << 32) + face.

    Returns: (status, faces brought in, worst face).
    """
    for n_entered in range(LIMIT):
        x = point[0] - centre[0]
        y = point[1] - centre[1]
        z = point[2] - centre[2]
        face = worst_face(normals, widths, starts, neighbours, face, x, y, z)
        width = widths[face]
        reach = normals[face, 0] * x + normals[face, 1] * y + normals[face, 2] * z
        if reach <= (1.0 - point[3] + margin) * width:
            return INSIDE, n_entered, face
        name = (body << 32) + face
        for j in range(4):
            if names[j] == name:
                return UNSETTLED, n_entered, face
        row = np.empty(4)
        row[0] = normals[face, 0]
        row[1] = normals[face, 1]
        row[2] = normals[face, 2]
        row[3] = width
        bound = width
        for i in range(3):
            bound += row[i] * centre[i]
        if not enter(rows, bounds, names, inverse, shares, row, bound, name):
            return UNSETTLED, n_entered, face
        if not solve_basis(rows, bounds, inverse, point, shares):
            return UNSETTLED, n_entered + 1, face
    return UNSETTLED, LIMIT, face

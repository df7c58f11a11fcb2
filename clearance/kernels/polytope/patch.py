"""Putting the part of a body's surface that lies inside another into the cut surface as it is.

Two large bodies share a surface made of two patches and a seam. Cutting by the faces along the seam alone is
enough: then the vertices that are still outside lie over the faces wholly inside, and the finished patch of
these faces takes their place. Its edges that lead out lie between two faces of the seam, by which they are
matched. Not for: deciding anything; if the edges do not match one to one, nothing is done.
"""

from __future__ import annotations

from clearance.compile.jit import inline, kernel
from clearance.kernels.polytope.cut import (
    FIRST,
    FREE,
    LATENT,
    LOOKED,
    MARK,
    N_FREE,
    N_ROWS,
    PLANES,
    QUEUE,
    SEEN,
    STAMP,
    USED,
    WHOLE,
    own_corner,
)
from clearance.kernels.polytope.exits import cell_of, exit_in, is_in_ball

INSIDE = 1.0 - 1e-9
"""[-] Greatest gauge of a corner that counts as wholly inside: the rest are left to the seam."""


@kernel(reference_counts=False)
def mark_patch(numbers_a, indices_a, numbers_b, indices_b, base, table, inside, in_patch):
    """Sets `in_patch` (n,) for the corners of faces of B wholly inside A; these faces become `LATENT`.

    Args:
        inside: (n,) scratch; in_patch: all False.
    """
    for i in range(len(inside)):
        x = numbers_b[indices_b[4] + 3 * i] - numbers_a[0]
        y = numbers_b[indices_b[4] + 3 * i + 1] - numbers_a[1]
        z = numbers_b[indices_b[4] + 3 * i + 2] - numbers_a[2]
        if is_in_ball(numbers_a, x, y, z):
            inside[i] = True
            continue
        cell, bound = cell_of(numbers_a, indices_a, x, y, z)
        inside[i] = bound < INSIDE or exit_in(numbers_a, indices_a, cell, x, y, z)[1] < INSIDE
    for face in range(indices_b[0]):
        whole = True
        for at in range(indices_b[indices_b[2] + face], indices_b[indices_b[2] + face + 1]):
            whole = whole and inside[indices_b[at]]
        if whole:
            table[base + face, USED] = LATENT
            for at in range(indices_b[indices_b[2] + face], indices_b[indices_b[2] + face + 1]):
                in_patch[indices_b[at]] = True


@inline(one_caller=True)
def is_under_patch(mesh, v, indices, base, in_patch):
    """True for a vertex over the patch or in one of its corners."""
    if mesh[v, 0] < 0:
        return False
    if mesh[v, LOOKED] == -1:
        return True
    a = mesh[v, PLANES]
    if a < base or a >= base + indices[0]:
        return False
    corner = own_corner(indices, base, a, mesh[v, PLANES + 1], mesh[v, PLANES + 2])
    return corner >= 0 and in_patch[corner]


@inline(one_caller=True)
def open_edges(mesh, state, stamp, n_gone, work, rim, table):
    """Number of edges that lead out of the marked vertices, or -1 if two lie on one plane."""
    n_rim = 0
    for i in range(n_gone):
        u = work[QUEUE, i]
        for k in range(3):
            w = mesh[u, k]
            if mesh[w, MARK] == stamp:
                continue
            a = mesh[u, PLANES + (k + 1) % 3]
            b = mesh[u, PLANES + (k + 2) % 3]
            if table[a, SEEN] == stamp or n_rim == len(rim):
                return -1
            table[a, SEEN] = stamp
            table[a, FIRST] = n_rim
            rim[n_rim, 0] = w
            rim[n_rim, 1] = 0
            for j in range(3):
                if mesh[w, j] == u and mesh[w, PLANES + j] != a and mesh[w, PLANES + j] != b:
                    rim[n_rim, 1] = j
            rim[n_rim, 2] = b
            rim[n_rim, 3] = -1
            n_rim += 1
    return n_rim


@inline(one_caller=True)
def matched(corner, form, in_patch, base, rim, n_rim, table, stamp):
    """True if the patch's edges that lead out are those of `rim`, one to one."""
    n_out = 0
    for t in range(len(corner)):
        if not in_patch[corner[t]]:
            continue
        for k in range(3):
            if in_patch[corner[form[t, k]]]:
                continue
            a = base + form[t, PLANES + (k + 1) % 3]
            if table[a, SEEN] != stamp:
                return False
            i = table[a, FIRST]
            if rim[i, 2] != base + form[t, PLANES + (k + 2) % 3] or rim[i, 3] >= 0:
                return False
            rim[i, 3] = 3 * t + k
            n_out += 1
    return n_out == n_rim


@inline(one_caller=True)
def rows_for_patch(mesh, state, n_gone, work, corner, in_patch, rows):
    """True if each vertex of the patch got its row, -1 for the others; the rows of those gone are freed first."""
    n_patch = 0
    for t in range(len(corner)):
        n_patch += in_patch[corner[t]]
    if n_patch > state[N_FREE] + n_gone + len(mesh) - state[N_ROWS]:
        return False
    for i in range(n_gone):
        mesh[work[QUEUE, i], 0] = -1
        work[FREE, state[N_FREE]] = work[QUEUE, i]
        state[N_FREE] += 1
    for t in range(len(corner)):
        rows[t] = -1
        if not in_patch[corner[t]]:
            continue
        if state[N_ROWS] < len(mesh):
            rows[t] = state[N_ROWS]
            state[N_ROWS] += 1
        else:
            state[N_FREE] -= 1
            rows[t] = work[FREE, state[N_FREE]]
    return True


@kernel(reference_counts=False)
def lay_patch(
    spots,
    mesh,
    state,
    work,
    rim,
    table,
    numbers,
    indices,
    corner,
    form,
    in_patch,
    rows,
    origin,
    base,
):
    """True if the patch took the place of the vertices over it; faces left `LATENT` may then cut or not.

    Args:
        corner, form: the body's trivalent form; in_patch: from `mark_patch`;
        rows: (t,) scratch. Else as `cut_by_body`.
    """
    state[STAMP] += 2
    stamp = state[STAMP]
    n_gone = 0
    for v in range(state[N_ROWS]):
        if is_under_patch(mesh, v, indices, base, in_patch):
            mesh[v, MARK] = stamp
            work[QUEUE, n_gone] = v
            n_gone += 1
    n_rim = open_edges(mesh, state, stamp, n_gone, work, rim, table)
    laid = n_rim > 2 and matched(corner, form, in_patch, base, rim, n_rim, table, stamp)
    if laid:
        laid = rows_for_patch(mesh, state, n_gone, work, corner, in_patch, rows)
    for face in range(indices[0]):
        if table[base + face, USED] == LATENT:
            table[base + face, USED] = WHOLE if laid else 0
    if not laid:
        return False
    for t in range(len(corner)):
        v = rows[t]
        if v < 0:
            continue
        for c in range(3):
            spots[v, c] = numbers[indices[4] + 3 * corner[t] + c] - origin[c]
            mesh[v, PLANES + c] = base + form[t, PLANES + c]
            mesh[v, c] = rows[form[t, c]]
        mesh[v, MARK] = 0
        mesh[v, LOOKED] = base + 1
    for i in range(n_rim):
        v = rows[rim[i, 3] // 3]
        mesh[v, rim[i, 3] % 3] = rim[i, 0]
        mesh[rim[i, 0], rim[i, 1]] = v
    return True

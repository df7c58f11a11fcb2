"""Putting the part of a body's surface that lies inside another into the cut surface as it is.

Two large bodies share a surface made of two patches and a seam. Cutting by the faces along the seam alone is
enough: then the vertices that are still outside lie over the faces wholly inside, and the finished patch of
these faces takes their place. Its edges that lead out lie between two faces of the seam, by which they are
matched. Not for: deciding anything; if the edges do not match one to one, nothing is done.
"""

from __future__ import annotations

from clearance.compile.declared import Flags, Floats, Integers, Shorts, Shorts2
from clearance.compile.decorators import inline, kernel
from clearance.kernels.polytope.body import N_FACES, PackedBody, centroid_of, face_edges, place_of
from clearance.kernels.polytope.cut import (
    FIRST,
    FREE,
    LATENT,
    MARK,
    N_FREE,
    N_ROWS,
    PLANES,
    QUEUE,
    SEEN,
    STAMP,
    USED,
    VISITED,
    WHOLE,
    Cut,
    own_corner,
)
from clearance.kernels.polytope.exits import cell_of, exit_in, is_in_ball

OUTER, OUTER_SLOT, OUTER_PLANE, EDGE = 0, 1, 2, 3
"""Columns of `Cut.rim` here: an open edge's vertex outside, that one's slot, the plane that follows, and the
patch's edge that it is matched to, -1 while there is none."""

INSIDE = 1.0 - 1e-9
"""[-] Greatest gauge of a corner that counts as wholly inside: the rest are left to the seam."""


@kernel
def mark_patch(
    body_a: PackedBody,
    body_b: PackedBody,
    base: int,
    table: Shorts2,
    inside: Flags,
    in_patch: Flags,
):
    """Sets `in_patch` (n,) for the corners of faces of B wholly inside A; these faces become `LATENT`.

    Args:
        inside: (n,) scratch; in_patch: all False.
    """
    cx, cy, cz = centroid_of(body_a.numbers)
    for i in range(len(inside)):
        x, y, z = place_of(body_b, i)
        x, y, z = x - cx, y - cy, z - cz
        if is_in_ball(body_a, x, y, z):
            inside[i] = True
            continue
        cell, bound = cell_of(body_a, x, y, z)
        inside[i] = bound < INSIDE or exit_in(body_a, cell, x, y, z)[1] < INSIDE
    indices = body_b.indices
    for face in range(indices[N_FACES]):
        whole = True
        begin, end = face_edges(indices, face)
        for edge in range(begin, end):
            whole = whole and inside[indices[edge]]
        if whole:
            table[base + face, USED] = LATENT
            for edge in range(begin, end):
                in_patch[indices[edge]] = True


@inline
def is_under_patch(mesh, v, indices, base, in_patch):
    """True for a vertex over the patch or in one of its corners."""
    if mesh[v, 0] < 0:
        return False
    if mesh[v, VISITED] == -1:
        return True
    a = mesh[v, PLANES]
    if a < base or a >= base + indices[N_FACES]:
        return False
    corner = own_corner(indices, base, a, mesh[v, PLANES + 1], mesh[v, PLANES + 2])
    return corner >= 0 and in_patch[corner]


@inline
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
            rim[n_rim, OUTER] = w
            rim[n_rim, OUTER_SLOT] = 0
            for j in range(3):
                if mesh[w, j] == u and mesh[w, PLANES + j] != a and mesh[w, PLANES + j] != b:
                    rim[n_rim, OUTER_SLOT] = j
            rim[n_rim, OUTER_PLANE] = b
            rim[n_rim, EDGE] = -1
            n_rim += 1
    return n_rim


@inline
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
            if rim[i, OUTER_PLANE] != base + form[t, PLANES + (k + 2) % 3] or rim[i, EDGE] >= 0:
                return False
            rim[i, EDGE] = 3 * t + k
            n_out += 1
    return n_out == n_rim


@inline
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


@kernel
def lay_patch(
    cut: Cut,
    body: PackedBody,
    corner: Integers,
    form: Shorts2,
    in_patch: Flags,
    rows: Shorts,
    origin: Floats,
    base: int,
) -> bool:
    """True if the patch took the place of the vertices over it; faces left `LATENT` may then cut or not.

    Args:
        corner, form: the body's trivalent form; in_patch: from `mark_patch`;
        rows: (t,) scratch; origin: (3,) what the places in `cut` are about; base: the number of the body's first
            plane.
    """
    spots, mesh, state, work, rim, table = (
        cut.spots, cut.mesh, cut.state, cut.work, cut.rim, cut.table
    )  # fmt: skip
    indices = body.indices
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
    for face in range(indices[N_FACES]):
        if table[base + face, USED] == LATENT:
            table[base + face, USED] = WHOLE if laid else 0
    if not laid:
        return False
    for t in range(len(corner)):
        v = rows[t]
        if v < 0:
            continue
        x, y, z = place_of(body, corner[t])
        spots[v, 0], spots[v, 1], spots[v, 2] = x - origin[0], y - origin[1], z - origin[2]
        for c in range(3):
            mesh[v, PLANES + c] = base + form[t, PLANES + c]
            mesh[v, c] = rows[form[t, c]]
        mesh[v, MARK] = 0
        mesh[v, VISITED] = base + 1
    for i in range(n_rim):
        v = rows[rim[i, EDGE] // 3]
        mesh[v, rim[i, EDGE] % 3] = rim[i, OUTER]
        mesh[rim[i, OUTER], rim[i, OUTER_SLOT]] = v
    return True

"""Cutting a convex polytope by a plane, on its trivalent form.

A trivalent vertex lies on three planes. A corner of more faces is several such vertices at one place, joined
by edges of length zero. So every cut is one operation: take away the connected vertices above the plane, put
one new vertex on each edge that leads out of them. This is the dual of inserting a point into a convex hull;
new places are interpolated on edges and cannot run away.

Not for: choosing the planes (`polytope.clip`).
"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from clearance.compile.declared import Floats, Floats2, Integers, Integers2, Shorts2
from clearance.compile.decorators import inline, kernel
from clearance.kernels.polytope.bodies import FIRST_PLANE, body_at
from clearance.kernels.polytope.body import N_FACES, PackedBody, face_edges, place_of

CUT, EMPTY, BROKEN, FULL = 0, 1, 2, 3
N_FREE, STAMP, N_ROWS, FIRST_BODY = range(4)
ACROSS, PLANES, MARK, VISITED = 0, 3, 6, 7
FIRST, SEEN, USED = 0, 1, 2
QUEUE, STACK, LATER, FREE = 0, 1, 2, 3
NEW, OUTSIDE, SLOT, AFTER = 0, 1, 2, 3


class Cut(NamedTuple):
    """A trivalent polytope that is being cut.

    Attributes:
        spots: (c, 4) float64, a row a vertex: its place [m] about the origin, its last height over a plane.
        mesh: (c, 8) int32, a row a vertex: `ACROSS` + k the vertex at the other end of the edge that leaves plane
            k (-1 first: a free row), `PLANES` + k the planes in order, `MARK` a stamp, `VISITED` the last body it
            was held against.
        state: (4,) free rows, last stamp, rows used, the body that is cut.
        work: (4, c) int32 scratch, but `work[FREE]` holds the free rows.
        rim: (c, 4) int32, the last cut's new vertices: `NEW` itself, `OUTSIDE` its neighbour there, `SLOT` that
            one's slot, `AFTER` the plane that follows.
        table: (p, 3) int32, a row a plane: `FIRST` scratch, `SEEN` a stamp, `USED` 1 once it has cut.
    """

    spots: Floats2
    mesh: Shorts2
    state: Integers
    work: Shorts2
    rim: Shorts2
    table: Shorts2


@inline
def cut_in(block, state, table):
    """The `Cut` of c rows whose arrays lie in `block` (12 c,) float64: `spots`, `mesh`, `work`, `rim`."""
    c = len(block) // 12
    return Cut(
        block[: 4 * c].reshape(c, 4),
        block[4 * c : 8 * c].view(np.int32).reshape(c, 8),
        state,
        block[8 * c : 10 * c].view(np.int32).reshape(4, c),
        block[10 * c :].view(np.int32).reshape(c, 4),
        table,
    )


@inline
def over(spots, v, plane):
    """[m] How far vertex `v` stands above the plane."""
    return plane[0] * spots[v, 0] + plane[1] * spots[v, 1] + plane[2] * spots[v, 2] - plane[3]


@inline
def gather_above(spots, mesh, top, plane, tolerance, stamp, work):
    """Number of connected vertices above the plane, from `top`; they are queued and marked `stamp`.

    Vertices next to them are marked `stamp - 1`; the heights of all these are kept.
    """
    work[QUEUE, 0] = top
    mesh[top, MARK] = stamp
    spots[top, 3] = over(spots, top, plane)
    n_above = 1
    i = 0
    while i < n_above:
        u = work[QUEUE, i]
        for k in range(3):
            w = mesh[u, k]
            if mesh[w, MARK] >= stamp - 1:
                continue
            high = over(spots, w, plane)
            spots[w, 3] = high
            mesh[w, MARK] = stamp - 1
            if high > tolerance:
                mesh[w, MARK] = stamp
                work[QUEUE, n_above] = w
                n_above += 1
        i += 1
    return n_above


@inline
def has_corner(indices, face, corner):
    """True if the face has the corner."""
    begin, end = face_edges(indices, face)
    for edge in range(begin, end):
        if indices[edge] == corner:
            return True
    return False


@inline
def own_corner(indices, base, a, b, c):
    """The corner of the body that its planes `a`, `b`, `c` share, or -1 if they are not its or share none."""
    n = indices[N_FACES]
    if b < base or c < base or b >= base + n or c >= base + n:
        return -1
    begin, end = face_edges(indices, a - base)
    for edge in range(begin, end):
        corner = indices[edge]
        if has_corner(indices, b - base, corner) and has_corner(indices, c - base, corner):
            return corner
    return -1


@inline
def put_rim(cut, n_above, stamp, name, body, base, origin):
    """Number of new vertices, one on each edge that leaves the marked region, or -1 if two lie on one plane.

    A corner of the body itself, whose planes are `body` and `base`, gets its given place. The outside is not
    linked yet.
    """
    spots, mesh, state, work, rim, table = (
        cut.spots, cut.mesh, cut.state, cut.work, cut.rim, cut.table
    )  # fmt: skip
    n_rim = 0
    for i in range(n_above):
        u = work[QUEUE, i]
        for k in range(3):
            w = mesh[u, k]
            if mesh[w, MARK] == stamp:
                continue
            a = mesh[u, PLANES + (1 if k == 0 else 2 if k == 1 else 0)]
            b = mesh[u, PLANES + (2 if k == 0 else 0 if k == 1 else 1)]
            if table[a, SEEN] == stamp:
                return -1
            table[a, SEEN] = stamp
            table[a, FIRST] = n_rim
            slot = 0
            for j in range(3):
                if mesh[w, j] == u and mesh[w, PLANES + j] != a and mesh[w, PLANES + j] != b:
                    slot = j
            v = state[N_ROWS] + n_rim - state[N_FREE]
            if n_rim < state[N_FREE]:
                v = work[FREE, state[N_FREE] - 1 - n_rim]
            corner = own_corner(body.indices, base, name, a, b)
            if corner >= 0:
                x, y, z = place_of(body, corner)
                spots[v, 0], spots[v, 1] = x - origin[0], y - origin[1]
                spots[v, 2] = z - origin[2]
            else:
                down = spots[w, 3]
                share = 0.0 if down >= 0.0 else down / (down - spots[u, 3])
                for c in range(3):
                    spots[v, c] = spots[w, c] + share * (spots[u, c] - spots[w, c])
            mesh[v, 0] = w
            mesh[v, PLANES] = name
            mesh[v, PLANES + 1] = a
            mesh[v, PLANES + 2] = b
            rim[n_rim, NEW] = v
            rim[n_rim, OUTSIDE] = w
            rim[n_rim, SLOT] = slot
            rim[n_rim, AFTER] = b
            n_rim += 1
    return n_rim


@inline
def rim_is_one_ring(rim, n_rim, table, stamp):
    """True if the rim's edges follow each other through their planes in one ring."""
    i = 0
    for n_met in range(1, n_rim + 1):
        b = rim[i, AFTER]
        if table[b, SEEN] != stamp:
            return False
        i = table[b, FIRST]
        if i == 0:
            return n_met == n_rim
    return False


@inline
def swap_rows(state, mesh, n_above, n_rim, work):
    """Takes the rows of the new vertices from the free ones and frees those above the plane."""
    n_reused = min(n_rim, state[N_FREE])
    state[N_FREE] -= n_reused
    state[N_ROWS] += n_rim - n_reused
    for i in range(n_above):
        mesh[work[QUEUE, i], 0] = -1
        work[FREE, state[N_FREE]] = work[QUEUE, i]
        state[N_FREE] += 1


@inline
def close_rim(mesh, rim, n_rim, table):
    """Links the new vertices to the outside and to each other."""
    for i in range(n_rim):
        v = rim[i, NEW]
        mesh[v, MARK] = 0
        mesh[v, VISITED] = 0
        mesh[rim[i, OUTSIDE], rim[i, SLOT]] = v
        after = rim[table[rim[i, AFTER], FIRST], NEW]
        mesh[v, 1] = after
        mesh[after, 2] = v


@inline
def cut_by_plane(cut, top, plane, name, tolerance, body, base, origin):
    """(status, number of new vertices, which are `rim[:n, NEW]`) of the cut by a plane that `top` is above."""
    spots, mesh, state, work, rim, table = (
        cut.spots, cut.mesh, cut.state, cut.work, cut.rim, cut.table
    )  # fmt: skip
    state[STAMP] += 2
    stamp = state[STAMP]
    n_above = gather_above(spots, mesh, top, plane, tolerance, stamp, work)
    if state[N_ROWS] - state[N_FREE] + n_above + 2 > len(spots):
        return FULL, 0
    n_rim = put_rim(cut, n_above, stamp, name, body, base, origin)
    if n_rim == 0:
        return EMPTY, 0
    if n_rim < 0 or not rim_is_one_ring(rim, n_rim, table, stamp):
        return BROKEN, 0
    swap_rows(state, mesh, n_above, n_rim, work)
    close_rim(mesh, rim, n_rim, table)
    return CUT, n_rim


@kernel
def begin(
    spots: Floats2,
    mesh: Shorts2,
    rows: Integers2,
    i_body: int,
    corner: Integers,
    form: Shorts2,
    origin: Floats,
):
    """Puts a body's trivalent form (`corner`, `form`) into the first rows, about `origin`.

    Args:
        rows: (m, 5) all bodies, of `polytope.bodies`. i_body: which it is.
    """
    body, base = body_at(rows, i_body), rows[i_body, FIRST_PLANE]
    for v in range(len(corner)):
        x, y, z = place_of(body, corner[v])
        spots[v, 0], spots[v, 1], spots[v, 2] = x - origin[0], y - origin[1], z - origin[2]
        for c in range(3):
            mesh[v, c] = form[v, c]
            mesh[v, PLANES + c] = form[v, PLANES + c] + base
        mesh[v, MARK] = 0
        mesh[v, VISITED] = 0


@inline
def close_up(spots, mesh, state, work):
    """Moves the rows in use together, in their order, so that later bodies walk over no free ones."""
    n_rows = 0
    for v in range(state[N_ROWS]):
        if mesh[v, 0] >= 0:
            work[QUEUE, v] = n_rows
            for c in range(8):
                mesh[n_rows, c] = mesh[v, c]
            for c in range(3):
                spots[n_rows, c] = spots[v, c]
            n_rows += 1
    for v in range(n_rows):
        for c in range(3):
            mesh[v, c] = work[QUEUE, mesh[v, c]]
    state[N_ROWS] = n_rows
    state[N_FREE] = 0


@kernel
def cut_by_planes(
    block: Floats, state: Integers, table: Shorts2, planes: Floats2, name: int, tolerance: float
) -> int:
    """The status after cutting a small polytope, or a large one a few times, by planes (k, 4) in turn.

    A plane is (normal, offset [m]), and plane i is number `name` + i. The top is found by looking at all.

    Args:
        block, state, table: of `cut_in`.
    """
    cut = cut_in(block, state, table)
    spots, mesh = cut.spots, cut.mesh
    no_body = PackedBody(planes[0], np.zeros(8, dtype=np.int32))
    for i in range(len(planes)):
        plane = (planes[i, 0], planes[i, 1], planes[i, 2], planes[i, 3])
        top = -1
        most = tolerance
        for v in range(state[N_ROWS]):
            if mesh[v, 0] >= 0 and over(spots, v, plane) > most:
                most = over(spots, v, plane)
                top = v
        if top < 0:
            continue
        status, _ = cut_by_plane(
            cut, top, plane, name + i, tolerance, no_body, len(cut.table), planes[0]
        )
        if status != CUT:
            return status
    return CUT

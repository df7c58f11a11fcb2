"""Cutting a convex polytope by other bodies, on its trivalent form.

A trivalent vertex lies on three planes. A corner of more faces is several such vertices at one place, joined
by edges of length zero. So every cut is one operation: take away the connected vertices above the plane, put
one new vertex on each edge that leads out of them. This is the dual of inserting a point into a convex hull;
new places are interpolated on edges and cannot run away.

A body cuts by the planes of the faces through which rays from its centroid to the polytope's vertices leave
it, found in its map of directions. Each vertex is looked at once; when the last one is inside, the polytope
is inside the body, to the tolerance, and planes that cut nothing were never touched.

Arrays, a row a vertex: `spots` (c, 4) float64, its place [m] about the origin and its last height over a
plane; `mesh` (c, 8) int32, columns `ACROSS` + k the vertex at the other end of the edge that leaves plane k
(-1 first: a free row), `PLANES` + k the planes in order, a stamp, the last body it was held against. A row a
plane: `table` (p, 3) int32, scratch, a stamp, 1 once it has cut and 2 if it is `LATENT`, to come in with a
patch (`polytope_patch`). `state`: free rows, last stamp, rows used.
"""

from __future__ import annotations

from clearance.jit import inlined, kernel, merged
from clearance.kernels.polytope_exits import HEAD, ROW, cell_of, exit_in

CUT, EMPTY, BROKEN, FULL = 0, 1, 2, 3
N_FREE, STAMP, N_ROWS = 0, 1, 2
ACROSS, PLANES, MARK, LOOKED = 0, 3, 6, 7
FIRST, SEEN, USED = 0, 1, 2
LATENT = 2
QUEUE, STACK, LATER, FREE = 0, 1, 2, 3


@merged
def plane_of(numbers, face, origin):
    """(normal, offset [m]) of a face's plane about `origin`."""
    row = HEAD + ROW * face
    x, y, z = numbers[row], numbers[row + 1], numbers[row + 2]
    offset = x * (numbers[row + 4] - origin[0])
    offset += y * (numbers[row + 5] - origin[1])
    offset += z * (numbers[row + 6] - origin[2])
    return x, y, z, offset


@merged
def over(spots, v, plane):
    """[m] How far vertex `v` stands above the plane."""
    return plane[0] * spots[v, 0] + plane[1] * spots[v, 1] + plane[2] * spots[v, 2] - plane[3]


@inlined
def other_face(numbers, indices, face, origin, spots, v, table, tolerance, stamp, base, work):
    """A face that has not cut yet and that `v` is above by more than `tolerance`, near `face`, or -1.

    In a flat body a face may be little violated in metres and most in parts of its distance. All faces that
    a point violates are connected over their neighbours: they are the corners of the polar body above a
    plane.
    """
    work[QUEUE, 0] = face
    table[base + face, SEEN] = stamp
    n_queue = 1
    i = 0
    while i < n_queue:
        f = work[QUEUE, i]
        if table[base + f, USED] != 1 and over(spots, v, plane_of(numbers, f, origin)) > tolerance:
            return f
        for at in range(indices[indices[2] + f], indices[indices[2] + f + 1]):
            g = indices[at + indices[3]]
            if table[base + g, SEEN] != stamp and n_queue < work.shape[1]:
                if over(spots, v, plane_of(numbers, g, origin)) > 0.0:
                    table[base + g, SEEN] = stamp
                    work[QUEUE, n_queue] = g
                    n_queue += 1
        i += 1
    return -1


@inlined
def flood_level(spots, mesh, start, plane, noise, stamp, work):
    """A vertex above `start` next to the level ground about it, or -1; level means within `noise`."""
    level = over(spots, start, plane)
    work[QUEUE, 0] = start
    mesh[start, MARK] = stamp
    n_queue = 1
    i = 0
    while i < n_queue:
        u = work[QUEUE, i]
        for k in range(3):
            w = mesh[u, k]
            if mesh[w, MARK] == stamp:
                continue
            value = over(spots, w, plane)
            if value > level + noise:
                return w
            if value >= level - noise:
                mesh[w, MARK] = stamp
                work[QUEUE, n_queue] = w
                n_queue += 1
        i += 1
    return -1


@inlined
def climb(spots, mesh, start, plane, noise, state, work):
    """The top vertex over the plane, uphill from `start`; level ground is searched by flooding.

    Source: hill climbing of Tereshchenko (2013), section 1.
    """
    v = start
    top = start
    while v >= 0:
        top = v
        state[STAMP] += 2
        v = flood_level(spots, mesh, top, plane, noise, state[STAMP], work)
    return top


@merged
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


@merged
def has_corner(indices, face, corner):
    """True if the face has the corner."""
    for at in range(indices[indices[2] + face], indices[indices[2] + face + 1]):
        if indices[at] == corner:
            return True
    return False


@merged
def own_corner(indices, base, a, b, c):
    """The corner of the body that its planes `a`, `b`, `c` share, or -1 if they are not its or share none."""
    n = indices[0]
    if b < base or c < base or b >= base + n or c >= base + n:
        return -1
    for at in range(indices[indices[2] + a - base], indices[indices[2] + a - base + 1]):
        if has_corner(indices, b - base, indices[at]) and has_corner(
            indices, c - base, indices[at]
        ):
            return indices[at]
    return -1


@merged
def put_rim(
    spots, mesh, state, n_above, stamp, name, work, rim, table, numbers, indices, base, origin
):
    """Number of new vertices, one on each edge that leaves the marked region, or -1 if two lie on one plane.

    A corner of the body itself, whose planes are `numbers`, `indices` and `base`, gets its given place.
    Row i of `rim` is (new vertex, its neighbour outside, the neighbour's slot, the plane that follows). The
    outside is not linked yet.
    """
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
            corner = own_corner(indices, base, name, a, b)
            if corner >= 0:
                for c in range(3):
                    spots[v, c] = numbers[indices[4] + 3 * corner + c] - origin[c]
            else:
                down = spots[w, 3]
                share = 0.0 if down >= 0.0 else down / (down - spots[u, 3])
                for c in range(3):
                    spots[v, c] = spots[w, c] + share * (spots[u, c] - spots[w, c])
            mesh[v, 0] = w
            mesh[v, PLANES] = name
            mesh[v, PLANES + 1] = a
            mesh[v, PLANES + 2] = b
            rim[n_rim, 0] = v
            rim[n_rim, 1] = w
            rim[n_rim, 2] = slot
            rim[n_rim, 3] = b
            n_rim += 1
    return n_rim


@merged
def rim_is_one_ring(rim, n_rim, table, stamp):
    """True if the rim's edges follow each other through their planes in one ring."""
    i = 0
    for n_met in range(1, n_rim + 1):
        b = rim[i, 3]
        if table[b, SEEN] != stamp:
            return False
        i = table[b, FIRST]
        if i == 0:
            return n_met == n_rim
    return False


@merged
def close_rim(mesh, rim, n_rim, table):
    """Links the new vertices to the outside and to each other."""
    for i in range(n_rim):
        v = rim[i, 0]
        mesh[v, MARK] = 0
        mesh[v, LOOKED] = 0
        mesh[rim[i, 1], rim[i, 2]] = v
        after = rim[table[rim[i, 3], FIRST], 0]
        mesh[v, 1] = after
        mesh[after, 2] = v


@merged
def swap_rows(state, mesh, n_above, n_rim, work):
    """Takes the rows of the new vertices from the free ones and frees those above the plane."""
    taken = min(n_rim, state[N_FREE])
    state[N_FREE] -= taken
    state[N_ROWS] += n_rim - taken
    for i in range(n_above):
        mesh[work[QUEUE, i], 0] = -1
        work[FREE, state[N_FREE]] = work[QUEUE, i]
        state[N_FREE] += 1


@inlined
def cut_by_plane(
    spots,
    mesh,
    state,
    work,
    rim,
    table,
    top,
    plane,
    name,
    tolerance,
    numbers,
    indices,
    base,
    origin,
):
    """(status, number of new vertices, which are `rim[:n, 0]`) of the cut by a plane that `top` is above."""
    state[STAMP] += 2
    stamp = state[STAMP]
    n_above = gather_above(spots, mesh, top, plane, tolerance, stamp, work)
    if state[N_ROWS] - state[N_FREE] + n_above + 2 > len(spots):
        return FULL, 0
    n_rim = put_rim(
        spots, mesh, state, n_above, stamp, name, work, rim, table, numbers, indices, base, origin
    )
    if n_rim == 0:
        return EMPTY, 0
    if n_rim < 0 or not rim_is_one_ring(rim, n_rim, table, stamp):
        return BROKEN, 0
    swap_rows(state, mesh, n_above, n_rim, work)
    close_rim(mesh, rim, n_rim, table)
    return CUT, n_rim


@merged
def is_copy(spots, mesh, v, base):
    """True if the row before is alive, at the same place, and was found inside this body or under a patch."""
    u = v - 1
    if mesh[u, 0] < 0 or (mesh[u, LOOKED] != base + 1 and mesh[u, LOOKED] != -1):
        return False
    return spots[u, 0] == spots[v, 0] and spots[u, 1] == spots[v, 1] and spots[u, 2] == spots[v, 2]


@kernel
def cut_by_body(
    spots, mesh, state, work, rim, table, numbers, indices, origin, base, tolerance, noise
):
    """Cuts the polytope by one body; (status, planes that cut).

    Vertices more than `noise` above a plane are surely connected to its top and cut at once. Where the best
    plane is nearer, rounding may have left a false top: these are looked at last, and the top is searched.

    Args:
        spots, mesh, state, table: the polytope, see above. work: (4, c) and rim: (c, 4) scratch, but
            `work[FREE]` holds the free rows.
        numbers, indices: the body, see `polytope_exits`; base: the number of its first plane.
        tolerance: [m] what counts as on a plane; noise: [m] how far rounding may make false tops stand out.
            FULL asks for more rows; the same call may then go on.
    """
    n_cuts = 0
    n_later = 0
    n_rows = state[N_ROWS]
    shift_x = origin[0] - numbers[0]
    shift_y = origin[1] - numbers[1]
    shift_z = origin[2] - numbers[2]
    for turn in range(2):
        row = 0
        while row < (n_rows if turn == 0 else n_later):
            work[STACK, 0] = row if turn == 0 else work[LATER, row]
            row += 1
            n_stack = 1
            while n_stack > 0:
                n_stack -= 1
                v = work[STACK, n_stack]
                if mesh[v, 0] < 0 or (turn == 0 and mesh[v, LOOKED] == base + 1):
                    continue
                mesh[v, LOOKED] = base + 1
                if turn == 0 and v > 0 and is_copy(spots, mesh, v, base):
                    mesh[v, LOOKED] = mesh[v - 1, LOOKED]
                    continue
                x, y, z = spots[v, 0] + shift_x, spots[v, 1] + shift_y, spots[v, 2] + shift_z
                cell, bound = cell_of(numbers, indices, x, y, z)
                if bound < 1.0:
                    continue
                face, gauge = exit_in(numbers, indices, cell, x, y, z)
                if (gauge - 1.0) * numbers[12] <= tolerance:
                    continue
                plane = plane_of(numbers, face, origin)
                above = over(spots, v, plane)
                if table[base + face, USED] == 1 or above <= tolerance:
                    state[STAMP] += 2
                    face = other_face(
                        numbers,
                        indices,
                        face,
                        origin,
                        spots,
                        v,
                        table,
                        tolerance,
                        state[STAMP],
                        base,
                        work,
                    )
                    if face < 0:
                        continue
                    plane = plane_of(numbers, face, origin)
                    above = over(spots, v, plane)
                if table[base + face, USED] == LATENT:
                    mesh[v, LOOKED] = -1
                    continue
                if turn == 0 and above <= noise:
                    work[LATER, n_later] = v
                    n_later += 1
                    if n_later == work.shape[1]:
                        return FULL, n_cuts
                    continue
                top = v if turn == 0 else climb(spots, mesh, v, plane, noise, state, work)
                status, n_new = cut_by_plane(
                    spots,
                    mesh,
                    state,
                    work,
                    rim,
                    table,
                    top,
                    plane,
                    base + face,
                    tolerance,
                    numbers,
                    indices,
                    base,
                    origin,
                )
                if status != CUT:
                    return status, n_cuts
                table[base + face, USED] = 1
                n_cuts += 1
                if n_stack + n_new + 1 > work.shape[1]:
                    return FULL, n_cuts
                if turn == 1:
                    work[STACK, n_stack] = v
                    n_stack += 1
                for i in range(n_new):
                    work[STACK, n_stack] = rim[i, 0]
                    n_stack += 1
    return CUT, n_cuts


@kernel
def cut_by_half_space(spots, mesh, state, work, rim, table, numbers, indices, normal, name):
    """The status of the cut that takes away all where `normal` leads uphill of the origin; any body will do."""
    plane = (normal[0], normal[1], normal[2], 0.0)
    top = 0
    for v in range(state[N_ROWS]):
        if mesh[v, 0] >= 0 and over(spots, v, plane) > over(spots, top, plane):
            top = v
    return cut_by_plane(
        spots, mesh, state, work, rim, table, top, plane, name, 0.0, numbers, indices, name, normal
    )[0]

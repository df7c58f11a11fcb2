"""Cutting a convex polytope by other bodies.

A body cuts by the planes of the faces through which rays from its centroid to the polytope's vertices leave
it, found in its map of directions. Each vertex is looked at once; when the last one is inside, the polytope
is inside the body, to the tolerance, and planes that cut nothing were never touched.

Arrays as in `polytope.cut`. Not for: the order of the bodies (`query.cutting`).
"""

from __future__ import annotations

from clearance.compile.jit import inline, kernel
from clearance.kernels.polytope.bodies import INDICES, NUMBERS, array_at
from clearance.kernels.polytope.cut import (
    CUT,
    FULL,
    LATENT,
    LATER,
    LOOKED,
    MARK,
    N_FREE,
    N_ROWS,
    QUEUE,
    SEEN,
    STACK,
    STAMP,
    USED,
    close_up,
    cut_by_plane,
    over,
)
from clearance.kernels.polytope.exits import HEAD, ROW, cell_of, exit_in, is_in_ball


@inline(one_caller=True)
def plane_of(numbers, face, origin):
    """(normal, offset [m]) of a face's plane about `origin`."""
    row = HEAD + ROW * face
    x, y, z = numbers[row], numbers[row + 1], numbers[row + 2]
    offset = x * (numbers[row + 4] - origin[0])
    offset += y * (numbers[row + 5] - origin[1])
    offset += z * (numbers[row + 6] - origin[2])
    return x, y, z, offset


@inline(one_caller=True)
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
        if (
            table[base + f, USED] % 2 == 0
            and over(spots, v, plane_of(numbers, f, origin)) > tolerance
        ):
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


@inline(one_caller=True)
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


@inline(one_caller=True)
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


@inline(one_caller=True)
def is_copy(spots, mesh, v, base):
    """True if the row before is alive, at the same place, and was found inside this body or under a patch."""
    u = v - 1
    if mesh[u, 0] < 0 or (mesh[u, LOOKED] != base + 1 and mesh[u, LOOKED] != -1):
        return False
    return spots[u, 0] == spots[v, 0] and spots[u, 1] == spots[v, 1] and spots[u, 2] == spots[v, 2]


@kernel(reference_counts=False)
def rooms_about(bodies, origin, rooms, numbers_like, indices_like):
    """Fills `rooms` [m]: how far the plane is through which the ray from each centroid to `origin` leaves."""
    for i in range(len(bodies)):
        numbers = array_at(bodies, i, NUMBERS, numbers_like)
        indices = array_at(bodies, i, INDICES, indices_like)
        x, y, z = origin[0] - numbers[0], origin[1] - numbers[1], origin[2] - numbers[2]
        cell, _ = cell_of(numbers, indices, x, y, z)
        face, gauge = exit_in(numbers, indices, cell, x, y, z)
        rooms[i] = (1.0 - gauge) * numbers[HEAD + ROW * face + 7]


@inline(one_caller=True)
def cut_by_body(
    spots, mesh, state, work, rim, table, numbers, indices, origin, base, tolerance, noise
):
    """Cuts the polytope by one body; (status, planes that cut).

    Vertices more than `noise` above a plane are surely connected to its top and cut at once. Where the best
    plane is nearer, rounding may have left a false top: these are looked at last, and the top is searched.

    Args:
        spots, mesh, state, table: the polytope, see above. work: (4, c) and rim: (c, 4) scratch, but
            `work[FREE]` holds the free rows.
        numbers, indices: the body, see `polytope.exits`; base: the number of its first plane.
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
            v = row if turn == 0 else work[LATER, row]
            row += 1
            if turn == 0 and (
                mesh[v, 0] < 0
                or mesh[v, LOOKED] == base + 1
                or is_in_ball(
                    numbers, spots[v, 0] + shift_x, spots[v, 1] + shift_y, spots[v, 2] + shift_z
                )
            ):
                continue
            work[STACK, 0] = v
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
                if table[base + face, USED] % 2 == 1 or above <= tolerance:
                    state[STAMP] += 2
                    face = other_face(
                        numbers, indices, face, origin, spots, v, table, tolerance, state[STAMP], base, work
                    )  # fmt: skip
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
                    spots, mesh, state, work, rim, table, top, plane, base + face, tolerance,
                    numbers, indices, base, origin,
                )  # fmt: skip
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


@kernel(reference_counts=False)
def cut_by_bodies(
    spots, mesh, state, work, rim, table, bodies, bases, turns, origin, tolerance, noise, sparse,
    numbers_like, indices_like,
):  # fmt: skip
    """Cuts the polytope by bodies in turn; (status, how many of `turns` are done).

    Rows are closed up after a body that leaves more than `sparse` of them free.

    Args:
        bodies: rows as `polytope.bodies` says; bases: the number of each one's first plane; turns: which bodies,
            in order. The others as in `cut_by_body`; FULL asks for more rows, and to go on from there.
    """
    for i in range(len(turns)):
        numbers = array_at(bodies, turns[i], NUMBERS, numbers_like)
        indices = array_at(bodies, turns[i], INDICES, indices_like)
        status, _ = cut_by_body(
            spots,
            mesh,
            state,
            work,
            rim,
            table,
            numbers,
            indices,
            origin,
            bases[turns[i]],
            tolerance,
            noise,
        )
        if status != CUT:
            return status, i
        if state[N_FREE] > sparse * state[N_ROWS]:
            close_up(spots, mesh, state, work)
    return CUT, len(turns)

"""Cutting a convex polytope by other bodies.

A body cuts by the planes of the faces through which rays from its centroid to the polytope's vertices leave
it, found in its map of directions. Each vertex is looked at once; when the last one is inside, the polytope
is inside the body, to the tolerance, and planes that cut nothing were never touched.

Not for: the order of the bodies (`query.cutting`).
"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from clearance.compile.jit import inline, kernel
from clearance.kernels.polytope.bodies import INDICES, NUMBERS, array_at
from clearance.kernels.polytope.body import (
    GREATEST_WIDTH,
    WIDTH,
    PackedBody,
    centroid_of,
    face_edges,
    face_number,
    face_over,
    plane_about,
)
from clearance.kernels.polytope.cut import (
    CUT,
    FULL,
    LATENT,
    LATER,
    LOOKED,
    MARK,
    N_FREE,
    N_ROWS,
    NEW,
    QUEUE,
    SEEN,
    STACK,
    STAMP,
    USED,
    close_up,
    cut_by_plane,
    over,
)
from clearance.kernels.polytope.exits import cell_of, exit_in, is_in_ball


class Cutters(NamedTuple):
    """Bodies to cut by.

    Attributes:
        rows: (m, 4) int64 as `polytope.bodies` says; bases: the number of each one's first plane.
        origin: (3,) what the places of the polytope that is cut are about.
        like: shows the types of a body's arrays.
    """

    rows: np.ndarray
    bases: np.ndarray
    origin: np.ndarray
    like: PackedBody


class Limits(NamedTuple):
    """What counts as what.

    Attributes:
        on_plane: [m] no farther above a plane is on it; noise: [m] how far rounding may make false tops stand out.
        sparse: the part of the rows that may be free before those in use are moved together.
    """

    on_plane: float
    noise: float
    sparse: float


@inline(one_caller=True)
def other_face(cut, body, face, origin, v, tolerance, base):
    """A face that has not cut yet and that `v` is above by more than `tolerance`, near `face`, or -1.

    In a flat body a face may be little violated in metres and most in parts of its distance. All faces that
    a point violates are connected over their neighbours: they are the corners of the polar body above a
    plane.
    """
    spots, work, table, state = cut.spots, cut.work, cut.table, cut.state
    numbers, indices = body.numbers, body.indices
    state[STAMP] += 2
    stamp = state[STAMP]
    work[QUEUE, 0] = face
    table[base + face, SEEN] = stamp
    n_queue = 1
    i = 0
    while i < n_queue:
        f = work[QUEUE, i]
        if (
            table[base + f, USED] % 2 == 0
            and over(spots, v, plane_about(numbers, f, origin)) > tolerance
        ):
            return f
        begin, end = face_edges(indices, f)
        for edge in range(begin, end):
            g = face_over(indices, edge)
            if table[base + g, SEEN] != stamp and n_queue < work.shape[1]:
                if over(spots, v, plane_about(numbers, g, origin)) > 0.0:
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


@inline(one_caller=True)
def body_at(cutters, i):
    """Body `i`."""
    numbers = array_at(cutters.rows, i, NUMBERS, cutters.like.numbers)
    return PackedBody(numbers, array_at(cutters.rows, i, INDICES, cutters.like.indices))


@kernel(reference_counts=False)
def rooms_about(cutters, rooms):
    """Fills `rooms` [m]: how far the plane is through which the ray from each centroid to the origin leaves."""
    origin = cutters.origin
    for i in range(len(cutters.rows)):
        body = body_at(cutters, i)
        cx, cy, cz = centroid_of(body.numbers)
        x, y, z = origin[0] - cx, origin[1] - cy, origin[2] - cz
        cell, _ = cell_of(body, x, y, z)
        face, gauge = exit_in(body, cell, x, y, z)
        rooms[i] = (1.0 - gauge) * face_number(body.numbers, face, WIDTH)


@inline(one_caller=True)
def face_to_cut_by(cut, body, v, place, origin, base, tolerance):
    """A face of the body that `v`, whose place is given about the centroid, is above, and that may cut; or -1."""
    cell, bound = cell_of(body, place[0], place[1], place[2])
    if bound < 1.0:
        return -1
    face, gauge = exit_in(body, cell, place[0], place[1], place[2])
    if (gauge - 1.0) * body.numbers[GREATEST_WIDTH] <= tolerance:
        return -1
    above = over(cut.spots, v, plane_about(body.numbers, face, origin))
    if cut.table[base + face, USED] % 2 == 1 or above <= tolerance:
        return other_face(cut, body, face, origin, v, tolerance, base)
    return face


@inline(one_caller=True)
def cut_by_body(cut, body, origin, base, limits):
    """Cuts the polytope by one body; (status, planes that cut).

    Vertices more than `limits.noise` above a plane are surely connected to its top and cut at once. Where the best
    plane is nearer, rounding may have left a false top: these are looked at last, and the top is searched.

    The two rounds share one walk, and so one long function: apart they would be spliced in twice, and the walk is
    half of what its caller takes to compile.

    Args:
        base: the number of the body's first plane. FULL asks for more rows; the same call may then go on.
    """
    spots, mesh, state, work, rim, table = cut
    numbers, tolerance = body.numbers, limits.on_plane
    n_cuts = 0
    n_later = 0
    n_rows = state[N_ROWS]
    cx, cy, cz = centroid_of(numbers)
    shift_x = origin[0] - cx
    shift_y = origin[1] - cy
    shift_z = origin[2] - cz
    for turn in range(2):
        row = 0
        while row < (n_rows if turn == 0 else n_later):
            v = row if turn == 0 else work[LATER, row]
            row += 1
            if turn == 0 and (
                mesh[v, 0] < 0
                or mesh[v, LOOKED] == base + 1
                or is_in_ball(
                    body, spots[v, 0] + shift_x, spots[v, 1] + shift_y, spots[v, 2] + shift_z
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
                place = spots[v, 0] + shift_x, spots[v, 1] + shift_y, spots[v, 2] + shift_z
                face = face_to_cut_by(cut, body, v, place, origin, base, tolerance)
                if face < 0:
                    continue
                if table[base + face, USED] == LATENT:
                    mesh[v, LOOKED] = -1
                    continue
                plane = plane_about(numbers, face, origin)
                if turn == 0 and over(spots, v, plane) <= limits.noise:
                    work[LATER, n_later] = v
                    n_later += 1
                    if n_later == work.shape[1]:
                        return FULL, n_cuts
                    continue
                top = v if turn == 0 else climb(spots, mesh, v, plane, limits.noise, state, work)
                status, n_new = cut_by_plane(
                    cut, top, plane, base + face, tolerance, body, base, origin
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
                    work[STACK, n_stack] = rim[i, NEW]
                    n_stack += 1
    return CUT, n_cuts


@kernel(reference_counts=False)
def cut_by_bodies(cut, cutters, turns, limits):
    """Cuts the polytope by bodies in turn; (status, how many of `turns` are done).

    Rows are closed up after a body that leaves more than `limits.sparse` of them free.

    Args:
        turns: which bodies, in order; FULL asks for more rows, and to go on from there.
    """
    state = cut.state
    for i in range(len(turns)):
        body, base = body_at(cutters, turns[i]), cutters.bases[turns[i]]
        status, _ = cut_by_body(cut, body, cutters.origin, base, limits)
        if status != CUT:
            return status, i
        if state[N_FREE] > limits.sparse * state[N_ROWS]:
            close_up(cut.spots, cut.mesh, state, cut.work)
    return CUT, len(turns)

"""Cutting a convex polytope by other bodies.

A body cuts by the planes of the faces through which rays from its centroid to the polytope's vertices leave
it, found in its map of directions. Each vertex is looked at once; when the last one is inside, the polytope
is inside the body, to the tolerance, and planes that cut nothing were never touched.

Not for: the order of the bodies (`query.cutting`).
"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from clearance.compile.declared import Floats, Integers, Integers2, Shorts2
from clearance.compile.decorators import inline, kernel
from clearance.kernels.polytope.bodies import FIRST_PLANE, body_at
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
    LATER,
    MARK,
    N_FREE,
    N_ROWS,
    NEW,
    QUEUE,
    SEEN,
    STACK,
    STAMP,
    USED,
    VISITED,
    close_up,
    cut_by_plane,
    cut_in,
    over,
)
from clearance.kernels.polytope.exits import cell_of, exit_in, is_in_ball

NOISE = 1e5
"""[-] How far rounding may make a false top stand out, in tolerances: corners slide along edges nearly parallel
to a cut; up to 1e-13 has been seen, and level ground of 2 roundings missed a plane (4e-7 of a volume)."""


class CutLimits(NamedTuple):
    """What counts as what.

    Attributes:
        on_plane: [m] no farther above a plane is on it; noise: [m] how far rounding may make false tops stand out.
    """

    on_plane: float
    noise: float


class Cutter(NamedTuple):
    """A body that cuts.

    Attributes:
        base: the number of its first plane.
        origin: (3,) what the places of the polytope that is cut are about; shift: from the centroid to it.
    """

    body: PackedBody
    base: int
    origin: np.ndarray
    shift: tuple[float, float, float]


@inline
def other_face(cut, cutter, face, v, tolerance):
    """A face that has not cut yet and that `v` is above by more than `tolerance`, near `face`, or -1.

    In a flat body a face may be little violated in metres and most in parts of its distance. All faces that
    a point violates are connected over their neighbours: they are the corners of the polar body above a
    plane.
    """
    spots, work, table, state = cut.spots, cut.work, cut.table, cut.state
    numbers, indices = cutter.body.numbers, cutter.body.indices
    base, origin = cutter.base, cutter.origin
    state[STAMP] += 2
    stamp = state[STAMP]
    work[QUEUE, 0] = face
    table[base + face, SEEN] = stamp
    n_queue = 1
    i = 0
    while i < n_queue:
        f = work[QUEUE, i]
        if (
            table[base + f, USED] == 0
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


@inline
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


@inline
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


@inline
def is_copy(spots, mesh, v, base):
    """True if the row before is alive, at the same place, and was found inside this body."""
    u = v - 1
    if mesh[u, 0] < 0 or mesh[u, VISITED] != base + 1:
        return False
    return spots[u, 0] == spots[v, 0] and spots[u, 1] == spots[v, 1] and spots[u, 2] == spots[v, 2]


@kernel
def rooms_about(rows: Integers2, origin: Floats, rooms: Floats):
    """Fills `rooms` [m]: how far the plane is through which the ray from each centroid to the origin leaves."""
    for i in range(len(rows)):
        body = body_at(rows, i)
        cx, cy, cz = centroid_of(body.numbers)
        x, y, z = origin[0] - cx, origin[1] - cy, origin[2] - cz
        cell, _ = cell_of(body, x, y, z)
        face, gauge = exit_in(body, cell, x, y, z)
        rooms[i] = (1.0 - gauge) * face_number(body.numbers, face, WIDTH)


@inline
def face_to_cut_by(cut, cutter, v, place, tolerance):
    """A face of the body that `v`, whose place is given about the centroid, is above, and that may cut; or -1."""
    body = cutter.body
    cell, bound = cell_of(body, place[0], place[1], place[2])
    if bound < 1.0:
        return -1
    face, gauge = exit_in(body, cell, place[0], place[1], place[2])
    if (gauge - 1.0) * body.numbers[GREATEST_WIDTH] <= tolerance:
        return -1
    above = over(cut.spots, v, plane_about(body.numbers, face, cutter.origin))
    if cut.table[cutter.base + face, USED] == 1 or above <= tolerance:
        return other_face(cut, cutter, face, v, tolerance)
    return face


@inline
def place_about_centroid(cutter, spots, v):
    """The place of a vertex about the centroid of the body that cuts."""
    shift = cutter.shift
    return spots[v, 0] + shift[0], spots[v, 1] + shift[1], spots[v, 2] + shift[2]


@inline
def cut_from(cut, cutter, start, turn, n_later, limits):
    """Cuts from a vertex on, until neither it nor what its cuts have made is above a face; (status, `n_later`).

    Args:
        turn: the round (`cut_by_body`). n_later: how many vertices were put off before.
    """
    spots, mesh, state, work, rim, table = (
        cut.spots, cut.mesh, cut.state, cut.work, cut.rim, cut.table
    )  # fmt: skip
    body, base, tolerance = cutter.body, cutter.base, limits.on_plane
    work[STACK, 0] = start
    n_stack = 1
    while n_stack > 0:
        n_stack -= 1
        v = work[STACK, n_stack]
        if mesh[v, 0] < 0 or (turn == 0 and mesh[v, VISITED] == base + 1):
            continue
        mesh[v, VISITED] = base + 1
        if turn == 0 and v > 0 and is_copy(spots, mesh, v, base):
            continue
        place = place_about_centroid(cutter, spots, v)
        face = face_to_cut_by(cut, cutter, v, place, tolerance)
        if face < 0:
            continue
        plane = plane_about(body.numbers, face, cutter.origin)
        if turn == 0 and over(spots, v, plane) <= limits.noise:
            work[LATER, n_later] = v
            n_later += 1
            if n_later == work.shape[1]:
                return FULL, n_later
            continue
        top = v if turn == 0 else climb(spots, mesh, v, plane, limits.noise, state, work)
        status, n_new = cut_by_plane(
            cut, top, plane, base + face, tolerance, body, base, cutter.origin
        )
        if status != CUT:
            return status, n_later
        table[base + face, USED] = 1
        if n_stack + n_new + 1 > work.shape[1]:
            return FULL, n_later
        if turn == 1:
            work[STACK, n_stack] = v
            n_stack += 1
        for i in range(n_new):
            work[STACK, n_stack] = rim[i, NEW]
            n_stack += 1
    return CUT, n_later


@inline
def cut_by_body(cut, cutter, limits):
    """The status after cutting the polytope by one body.

    FULL asks for more rows, and the same call may then go on. Vertices more than `limits.noise` above a plane are
    surely connected to its top and cut at once. Where the best plane is nearer, rounding may have left a false
    top: these are looked at last, and the top is searched.

    The two rounds share one walk: apart they would be spliced in twice, and the walk is half of what its caller
    takes to compile.
    """
    spots, mesh, work, base = cut.spots, cut.mesh, cut.work, cutter.base
    n_later = 0
    n_rows = cut.state[N_ROWS]
    for turn in range(2):
        row = 0
        while row < (n_rows if turn == 0 else n_later):
            v = row if turn == 0 else work[LATER, row]
            row += 1
            if turn == 0:
                if mesh[v, 0] < 0 or mesh[v, VISITED] == base + 1:
                    continue
                x, y, z = place_about_centroid(cutter, spots, v)
                if is_in_ball(cutter.body, x, y, z):
                    continue
            status, n_later = cut_from(cut, cutter, v, turn, n_later, limits)
            if status != CUT:
                return status
    return CUT


@kernel
def cut_by_bodies(
    block: Floats,
    state: Integers,
    table: Shorts2,
    rows: Integers2,
    origin: Floats,
    turns: Integers,
    tolerance: float,
    sparse: float,
) -> tuple[int, int]:
    """Cuts the polytope by bodies in turn; (status, how many of `turns` are done).

    Args:
        block, state, table: of `polytope.cut.cut_in`. rows: (m, 5) all bodies, of `polytope.bodies`.
        origin: (3,) what the places of the polytope are about.
        turns: which bodies, in order; FULL asks for more rows, and to go on from there.
        tolerance: [m] no farther above a plane is on it.
        sparse: rows are closed up after a body that leaves more than this part of them free.
    """
    cut, limits = cut_in(block, state, table), CutLimits(tolerance, NOISE * tolerance)
    for i in range(len(turns)):
        body = body_at(rows, turns[i])
        cx, cy, cz = centroid_of(body.numbers)
        shift = origin[0] - cx, origin[1] - cy, origin[2] - cz
        cutter = Cutter(body, rows[turns[i], FIRST_PLANE], origin, shift)
        status = cut_by_body(cut, cutter, limits)
        if status != CUT:
            return status, i
        if state[N_FREE] > sparse * state[N_ROWS]:
            close_up(cut.spots, cut.mesh, state, cut.work)
    return CUT, len(turns)

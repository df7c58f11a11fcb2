"""The faces of a trivalent polytope in order, and the volume and centroid inside a closed surface.

Not for: changing the polytope (`polytope.cut`).
"""

from __future__ import annotations

import numpy as np

from clearance.compile.declared import Floats, Floats2, Integers, Integers2, Shorts2
from clearance.compile.decorators import inline, kernel
from clearance.kernels.arithmetic.expansion import two_sum
from clearance.kernels.polytope.bodies import FIRST_PLANE, body_at
from clearance.kernels.polytope.body import (
    N_FACES,
    NORMAL,
    PackedBody,
    face_edges,
    face_vector,
    place_of,
    plane_about,
)
from clearance.kernels.polytope.cut import (
    FIRST,
    FIRST_BODY,
    N_ROWS,
    PLANES,
    SEEN,
    STAMP,
    cut_in,
)


@kernel
def face_rings(mesh: Shorts2, n_rows: int) -> tuple[Integers, Integers, Integers]:
    """The faces of the trivalent polytope: (plane of each ring, ring starts, trivalent vertices in order)."""
    walked = np.zeros((n_rows, 3), dtype=np.bool_)
    names = np.empty(n_rows, dtype=np.int64)
    starts = np.zeros(n_rows + 1, dtype=np.int64)
    corners = np.empty(3 * n_rows, dtype=np.int64)
    n_faces = 0
    n_corners = 0
    for i in range(n_rows):
        for k in range(3):
            v = i
            slot = k
            if mesh[v, 0] < 0 or walked[v, slot]:
                continue
            name = mesh[v, PLANES + slot]
            while not walked[v, slot]:
                walked[v, slot] = True
                corners[n_corners] = v
                n_corners += 1
                v = mesh[v, (slot + 1) % 3]
                for j in range(3):
                    if mesh[v, PLANES + j] == name:
                        slot = j
            names[n_faces] = name
            n_faces += 1
            starts[n_faces] = n_corners
    return names[:n_faces], starts[: n_faces + 1], corners[:n_corners]


@kernel
def ring_moments(places: Floats2, starts: Integers, corners: Integers, origin: Floats) -> Floats:
    """(volume [m^3], volume times centroid less `origin` [m^4]) inside rings that close a surface."""
    moments = np.zeros(4)
    for f in range(len(starts) - 1):
        ax = places[corners[starts[f]], 0] - origin[0]
        ay = places[corners[starts[f]], 1] - origin[1]
        az = places[corners[starts[f]], 2] - origin[2]
        for e in range(starts[f] + 1, starts[f + 1] - 1):
            bx = places[corners[e], 0] - origin[0]
            by = places[corners[e], 1] - origin[1]
            bz = places[corners[e], 2] - origin[2]
            cx = places[corners[e + 1], 0] - origin[0]
            cy = places[corners[e + 1], 1] - origin[1]
            cz = places[corners[e + 1], 2] - origin[2]
            sixth = (
                ax * (by * cz - bz * cy) + ay * (bz * cx - bx * cz) + az * (bx * cy - by * cx)
            ) / 6.0
            moments[0] += sixth
            moments[1] += sixth * (ax + bx + cx) * 0.25
            moments[2] += sixth * (ay + by + cy) * 0.25
            moments[3] += sixth * (az + bz + cz) * 0.25
    return moments


@kernel
def face_areas(body: PackedBody) -> Floats2:
    """(f, 4) area [m^2] and centroid [m] of each face."""
    numbers, indices = body.numbers, body.indices
    areas = np.empty((indices[N_FACES], 4))
    for face in range(indices[N_FACES]):
        begin, end = face_edges(indices, face)
        ox, oy, oz = place_of(body, indices[begin])
        nx, ny, nz = face_vector(numbers, face, NORMAL)
        twice = x = y = z = 0.0
        for edge in range(begin + 1, end - 1):
            bx, by, bz = place_of(body, indices[edge])
            cx, cy, cz = place_of(body, indices[edge + 1])
            bx, by, bz = bx - ox, by - oy, bz - oz
            cx, cy, cz = cx - ox, cy - oy, cz - oz
            part = nx * (by * cz - bz * cy)
            part += ny * (bz * cx - bx * cz)
            part += nz * (bx * cy - by * cx)
            twice += part
            x += part * (bx + cx)
            y += part * (by + cy)
            z += part * (bz + cz)
        areas[face, 0] = 0.5 * twice
        areas[face, 1] = ox + x / (3.0 * twice)
        areas[face, 2] = oy + y / (3.0 * twice)
        areas[face, 3] = oz + z / (3.0 * twice)
    return areas


@inline
def whole_face(rows, i_body, areas, name, origin):
    """(volume, volume times centroid about `origin`) of the cone from `origin` over a body's face, by its name."""
    face = name - rows[i_body, FIRST_PLANE]
    _, _, _, high = plane_about(body_at(rows, i_body).numbers, face, origin)
    cone = areas[face, 0] * high / 3.0
    x = 0.75 * cone * (areas[face, 1] - origin[0])
    y = 0.75 * cone * (areas[face, 2] - origin[1])
    z = 0.75 * cone * (areas[face, 3] - origin[2])
    return cone, x, y, z


@inline
def cone_over(places, o, u, w):
    """(volume, volume times centroid) of the tetrahedron of the origin and three vertices."""
    ax, ay, az = places[o, 0], places[o, 1], places[o, 2]
    bx, by, bz = places[u, 0], places[u, 1], places[u, 2]
    cx, cy, cz = places[w, 0], places[w, 1], places[w, 2]
    cone = (ax * (by * cz - bz * cy) + ay * (bz * cx - bx * cz) + az * (bx * cy - by * cx)) / 6.0
    quarter = 0.25 * cone
    return cone, quarter * (ax + bx + cx), quarter * (ay + by + cy), quarter * (az + bz + cz)


@kernel
def trivalent_moments(
    block: Floats,
    state: Integers,
    table: Shorts2,
    rows: Integers2,
    areas: Floats2,
    origin: Floats,
) -> tuple[float, float, float, float, float]:
    """Volume [m^3], volume times centroid (3) [m^4], greatest coordinate, about the origin of a `Cut`.

    Each edge of each face makes a tetrahedron with the face's first corner met and the origin; a face that no
    cut has touched is one cone.

    Args:
        block, state, table: of `polytope.cut.cut_in`. rows: (m, 5) all bodies, of `polytope.bodies`.
        areas: `face_areas` of the body that was cut; (0, 4): all faces are taken by their edges.
        origin: (3,) of the places in the bodies' frame.
    """
    cut = cut_in(block, state, table)
    places, mesh = cut.spots, cut.mesh
    i_first = state[FIRST_BODY]
    base = rows[i_first, FIRST_PLANE]
    state[STAMP] += 2
    stamp = state[STAMP]
    most = volume = x = y = z = 0.0
    rest = rest_x = rest_y = rest_z = 0.0  # what rounding drops of each sum
    for u in range(state[N_ROWS]):
        if mesh[u, 0] < 0:
            continue
        most = max(most, abs(places[u, 0]), abs(places[u, 1]), abs(places[u, 2]))
        for k in range(3):
            name = mesh[u, PLANES + k]
            if table[name, SEEN] != stamp:
                whole = table[name, SEEN] == 0
                table[name, SEEN] = stamp
                if whole and name >= base and name < base + len(areas):
                    part = whole_face(rows, i_first, areas, name, origin)
                else:
                    table[name, FIRST] = u
                    continue
                table[name, FIRST] = -1
            else:
                o = table[name, FIRST]
                w = mesh[u, 0 if k == 2 else k + 1]
                if o < 0 or w == o:
                    continue
                part = cone_over(places, o, u, w)
            volume, lost = two_sum(volume, part[0])
            rest += lost
            x, lost = two_sum(x, part[1])
            rest_x += lost
            y, lost = two_sum(y, part[2])
            rest_y += lost
            z, lost = two_sum(z, part[3])
            rest_z += lost
    return volume + rest, x + rest_x, y + rest_y, z + rest_z, most

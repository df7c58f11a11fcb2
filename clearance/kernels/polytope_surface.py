"""The faces of a trivalent polytope in order, and the volume and centroid inside a closed surface.

Not for: changing the polytope (`polytope_cut`).
"""

from __future__ import annotations

import numpy as np

from clearance.jit import kernel
from clearance.kernels.expansion import two_sum
from clearance.kernels.polytope_cut import FIRST, PLANES, SEEN


@kernel
def face_rings(mesh, n_rows):
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
def ring_moments(places, starts, corners, origin):
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
def trivalent_moments(places, mesh, n_rows, table, stamp):
    """(5,) volume [m^3], volume times centroid [m^4], greatest coordinate, about the origin of `places`.

    Each edge of each face makes a tetrahedron with the face's first corner met and the origin. Arrays as in
    `polytope_cut`; `stamp`: a number that `table` does not hold.
    """
    most = volume = x = y = z = 0.0
    rest = rest_x = rest_y = rest_z = 0.0  # what rounding drops of each sum
    for u in range(n_rows):
        if mesh[u, 0] < 0:
            continue
        bx, by, bz = places[u, 0], places[u, 1], places[u, 2]
        most = max(most, abs(bx), abs(by), abs(bz))
        for k in range(3):
            name = mesh[u, PLANES + k]
            if table[name, SEEN] != stamp:
                table[name, SEEN] = stamp
                table[name, FIRST] = u
                continue
            o = table[name, FIRST]
            w = mesh[u, 0 if k == 2 else k + 1]
            if w == o:
                continue
            ax, ay, az = places[o, 0], places[o, 1], places[o, 2]
            cx, cy, cz = places[w, 0], places[w, 1], places[w, 2]
            sixth = (
                ax * (by * cz - bz * cy) + ay * (bz * cx - bx * cz) + az * (bx * cy - by * cx)
            ) / 6.0
            volume, lost = two_sum(volume, sixth)
            rest += lost
            x, lost = two_sum(x, sixth * (ax + bx + cx) * 0.25)
            rest_x += lost
            y, lost = two_sum(y, sixth * (ay + by + cy) * 0.25)
            rest_y += lost
            z, lost = two_sum(z, sixth * (az + bz + cz) * 0.25)
            rest_z += lost
    return np.array([volume + rest, x + rest_x, y + rest_y, z + rest_z, most])

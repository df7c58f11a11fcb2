"""The faces of a trivalent polytope in order, and the volume and centroid inside a closed surface.

Not for: changing the polytope (`polytope_cut`).
"""

from __future__ import annotations

import numpy as np

from clearance.jit import kernel, merged
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


@merged
def add_to(sums, i, value):
    """Adds to sum `i`, keeping what rounding drops in `sums[4 + i]`."""
    sums[i], rest = two_sum(sums[i], value)
    sums[4 + i] += rest


@kernel
def trivalent_moments(places, mesh, n_rows, table, stamp):
    """(5,) volume [m^3], volume times centroid [m^4], greatest coordinate, about the origin of `places`.

    Each edge of each face makes a tetrahedron with the face's first corner met and the origin. Arrays as in
    `polytope_cut`; `stamp`: a number that `table` does not hold.
    """
    sums = np.zeros(8)
    moments = np.zeros(5)
    for u in range(n_rows):
        if mesh[u, 0] < 0:
            continue
        moments[4] = max(moments[4], abs(places[u, 0]), abs(places[u, 1]), abs(places[u, 2]))
        for k in range(3):
            name = mesh[u, PLANES + k]
            if table[name, SEEN] != stamp:
                table[name, SEEN] = stamp
                table[name, FIRST] = u
                continue
            o = table[name, FIRST]
            w = mesh[u, (k + 1) % 3]
            if w == o:
                continue
            ax, ay, az = places[o, 0], places[o, 1], places[o, 2]
            bx, by, bz = places[u, 0], places[u, 1], places[u, 2]
            cx, cy, cz = places[w, 0], places[w, 1], places[w, 2]
            sixth = (
                ax * (by * cz - bz * cy) + ay * (bz * cx - bx * cz) + az * (bx * cy - by * cx)
            ) / 6.0
            add_to(sums, 0, sixth)
            add_to(sums, 1, sixth * (ax + bx + cx) * 0.25)
            add_to(sums, 2, sixth * (ay + by + cy) * 0.25)
            add_to(sums, 3, sixth * (az + bz + cz) * 0.25)
    for i in range(4):
        moments[i] = sums[i] + sums[4 + i]
    return moments

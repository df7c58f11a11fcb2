"""The faces of a trivalent polytope in order, and the volume and centroid inside a closed surface.

Not for: changing the polytope (`polytope.cut`).
"""

from __future__ import annotations

import numpy as np

from clearance.compile.jit import inline, kernel
from clearance.kernels.arithmetic.expansion import two_sum
from clearance.kernels.polytope.cut import FIRST, PLANES, SEEN, USED, WHOLE
from clearance.kernels.polytope.exits import HEAD, ROW


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
def face_areas(numbers, indices):
    """(f, 4) area [m^2] and centroid [m] of each face of a packed body (`polytope.exits`)."""
    areas = np.empty((indices[0], 4))
    for face in range(indices[0]):
        begin = indices[indices[2] + face]
        o = indices[4] + 3 * indices[begin]
        row = HEAD + ROW * face
        twice = x = y = z = 0.0
        for at in range(begin + 1, indices[indices[2] + face + 1] - 1):
            b = indices[4] + 3 * indices[at]
            c = indices[4] + 3 * indices[at + 1]
            bx = numbers[b] - numbers[o]
            by = numbers[b + 1] - numbers[o + 1]
            bz = numbers[b + 2] - numbers[o + 2]
            cx = numbers[c] - numbers[o]
            cy = numbers[c + 1] - numbers[o + 1]
            cz = numbers[c + 2] - numbers[o + 2]
            part = numbers[row] * (by * cz - bz * cy)
            part += numbers[row + 1] * (bz * cx - bx * cz)
            part += numbers[row + 2] * (bx * cy - by * cx)
            twice += part
            x += part * (bx + cx)
            y += part * (by + cy)
            z += part * (bz + cz)
        areas[face, 0] = 0.5 * twice
        areas[face, 1] = numbers[o] + x / (3.0 * twice)
        areas[face, 2] = numbers[o + 1] + y / (3.0 * twice)
        areas[face, 3] = numbers[o + 2] + z / (3.0 * twice)
    return areas


@inline(one_caller=True)
def whole_face(numbers, areas, face, origin):
    """(volume, volume times centroid about `origin`) of the cone from `origin` over a body's face."""
    row = HEAD + ROW * face
    high = numbers[row] * (numbers[row + 4] - origin[0])
    high += numbers[row + 1] * (numbers[row + 5] - origin[1])
    high += numbers[row + 2] * (numbers[row + 6] - origin[2])
    cone = areas[face, 0] * high / 3.0
    x = 0.75 * cone * (areas[face, 1] - origin[0])
    y = 0.75 * cone * (areas[face, 2] - origin[1])
    z = 0.75 * cone * (areas[face, 3] - origin[2])
    return cone, x, y, z


@inline(one_caller=True)
def cone_over(places, o, u, w):
    """(volume, volume times centroid) of the tetrahedron of the origin and three vertices."""
    ax, ay, az = places[o, 0], places[o, 1], places[o, 2]
    bx, by, bz = places[u, 0], places[u, 1], places[u, 2]
    cx, cy, cz = places[w, 0], places[w, 1], places[w, 2]
    cone = (ax * (by * cz - bz * cy) + ay * (bz * cx - bx * cz) + az * (bx * cy - by * cx)) / 6.0
    quarter = 0.25 * cone
    return cone, quarter * (ax + bx + cx), quarter * (ay + by + cy), quarter * (az + bz + cz)


@kernel(reference_counts=False)
def trivalent_moments(
    places, mesh, n_rows, table, stamp, base_a, numbers_a, areas_a, base_b, numbers_b, areas_b, origin
):  # fmt: skip
    """Volume [m^3], volume times centroid (3) [m^4], greatest coordinate, about the origin of `places`.

    Each edge of each face makes a tetrahedron with the face's first corner met and the origin; a face that no
    cut has touched is one cone. Arrays as in `polytope.cut`; `stamp`: a number that `table` does not hold.

    Args:
        base, numbers, areas: the body that was cut and the one whose patch was laid, with `face_areas`, none
            (0, 4) to take all faces by their edges; origin: (3,) of `places` in the bodies' frame.
    """
    most = volume = x = y = z = 0.0
    rest = rest_x = rest_y = rest_z = 0.0  # what rounding drops of each sum
    for u in range(n_rows):
        if mesh[u, 0] < 0:
            continue
        most = max(most, abs(places[u, 0]), abs(places[u, 1]), abs(places[u, 2]))
        for k in range(3):
            name = mesh[u, PLANES + k]
            if table[name, SEEN] != stamp:
                whole = table[name, SEEN] == 0
                table[name, SEEN] = stamp
                if whole and name >= base_a and name < base_a + len(areas_a):
                    part = whole_face(numbers_a, areas_a, name - base_a, origin)
                elif whole and table[name, USED] == WHOLE and len(areas_b) > 0:
                    part = whole_face(numbers_b, areas_b, name - base_b, origin)
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

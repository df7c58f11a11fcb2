"""What a moving surface leaves in a cutting plane: covered pixels of its closed parts, and its faces' own cuts.

Heights are measured from the plane. Between two poses the points of a body stay within `reach` of their chords
in space, so that whatever cuts the plane comes from the hull of a face's two positions within that height.
Not for: silhouettes (`swept_hulls`).
"""

import math

import numpy as np

from clearance.compile.declared import Flags, Floats2, Floats3, Integers, Integers2, Shorts2
from clearance.compile.decorators import inline, kernel
from clearance.kernels.profile.swept_cover import (
    Raster,
    add_inside,
    column_of,
    draw_edge,
    lies_covered,
    row_of,
)
from clearance.kernels.profile.swept_hulls import CORNERS, fattened_hull, with_polygon

MOST = 40
"""Corners of the largest polygon that is handed out here: six points and fifteen lines cut twice."""

DEEPEST = 12
"""Most times that a triangle is quartered."""


@inline
def _crossing(p, q, level, out):
    """Writes where the segment p-q passes a height; the same bits whichever way it runs."""
    if p[2] > q[2]:
        p, q = q, p
    share = (level - p[2]) / (q[2] - p[2])
    out[0], out[1] = p[0] + share * (q[0] - p[0]), p[1] + share * (q[1] - p[1])


@kernel
def cut_segments(
    points: Floats2, face_starts: Integers, face_vertices: Integers, closed: Flags, out: Floats2
) -> int:
    """Writes the directed cuts of the faces with the plane, inside on their left; returns how many.

    Args:
        points: (v, 3) [m] in the plane's frame; what lies in the plane counts as above it.
        closed: (f,) faces of closed parts, outward oriented; others are passed over.
        out: (f, 4) start and end of each.
    """
    found = 0
    for f in range(len(face_starts) - 1):
        if not closed[f]:
            continue
        first, last = face_starts[f], face_starts[f + 1]
        crossings = 0
        for i in range(first, last):
            p = points[face_vertices[i]]
            q = points[face_vertices[i + 1 if i + 1 < last else first]]
            if (p[2] >= 0.0) != (q[2] >= 0.0):
                # A face seen from outside has the solid below its up-going edge's left: down to up.
                at = 2 if q[2] >= 0.0 else 0
                _crossing(p, q, 0.0, out[found, at : at + 2])
                crossings += 1
        if crossings == 2:
            found += 1
    return found


@kernel
def add_cut_cover(
    raster: Raster, points: Floats3, face_starts: Integers, face_vertices: Integers, closed: Flags
):
    """Marks the pixels that the closed parts of a body fill in the plane at several instants, (k, v, 3)."""
    rows, columns = raster.covered.shape
    touched = np.zeros((rows, columns + 1), np.bool_)
    steps = np.zeros((rows, columns + 1), np.int32)
    cuts = np.empty((len(face_starts), 4))
    for k in range(points.shape[0]):
        n = cut_segments(points[k], face_starts, face_vertices, closed, cuts)
        if n == 0:
            continue
        low_x, high_x, low_y, high_y = math.inf, -math.inf, math.inf, -math.inf
        for i in range(n):
            low_x, high_x = min(low_x, cuts[i, 0], cuts[i, 2]), max(high_x, cuts[i, 0], cuts[i, 2])
            low_y, high_y = min(low_y, cuts[i, 1], cuts[i, 3]), max(high_y, cuts[i, 1], cuts[i, 3])
            draw_edge(raster, cuts[i, 0], cuts[i, 1], cuts[i, 2], cuts[i, 3], 1, touched, steps)
        add_inside(
            raster, max(0, row_of(raster, low_y) - 1), min(rows - 1, row_of(raster, high_y) + 1),
            max(0, column_of(raster, low_x) - 1), min(columns - 1, column_of(raster, high_x) + 1),
            touched, steps,
        )  # fmt: skip


@inline
def _slab_points(six, reach, out):
    """Writes the corners, in the plane, of the hull of six points within `reach` of it; returns how many."""
    n = 0
    for i in range(6):
        if abs(six[i, 2]) <= reach:
            out[n, 0], out[n, 1] = six[i, 0], six[i, 1]
            n += 1
        for j in range(i):
            for level in (-reach, reach):
                if (six[i, 2] < level) != (six[j, 2] < level):
                    _crossing(six[i], six[j], level, out[n])
                    n += 1
    return n


@inline
def _twist(six):
    """[m] a quarter of the greatest change of an edge: how far the hull may be from what the face sweeps."""
    worst = 0.0
    for i in range(3):
        j = (i + 1) % 3
        change = 0.0
        for c in range(3):
            change += (six[3 + j, c] - six[3 + i, c] - six[j, c] + six[i, c]) ** 2
        worst = max(worst, change)
    return 0.25 * math.sqrt(worst)


@inline
def _quarter(stack, at, six):
    """Puts the four similar parts of a triangle at two instants on the stack."""
    for part in range(4):
        for pose in range(2):
            for i in range(3):
                for c in range(3):
                    j, k = (i + 1) % 3, (i + 2) % 3
                    if part == 3:
                        value = 0.5 * (six[3 * pose + j, c] + six[3 * pose + k, c])
                    else:
                        value = 0.5 * (six[3 * pose + i, c] + six[3 * pose + part, c])
                    stack[at + part, 3 * pose + i, c] = value


@kernel
def cut_hulls(
    raster: Raster,
    sums: Shorts2,
    start: Floats2,
    end: Floats2,
    triangles: Integers2,
    reach: float,
    width: float,
    slack: float,
) -> Floats2:
    """What triangles leave in the plane from one instant to the next, as convex polygons, uncovered only.

    Args:
        start, end: (v, 3) [m] vertices in the plane's frame.
        reach: [m] how far points may leave their chords.
        width, slack: as `edge_hulls`.

    Returns:
        (m, CORNERS + 2 MOST) the polygons as rows.
    """
    found, rows = 0, np.empty((64, CORNERS + 2 * MOST))
    stack, six = np.empty((4 * DEEPEST + 4, 6, 3)), np.empty((6, 3))
    depth = np.empty(4 * DEEPEST + 4, np.int64)
    flat, out, widened = np.empty((40, 2)), np.empty((200, 2)), np.empty((160, 2))
    for t in range(len(triangles)):
        for i in range(3):
            stack[0, i], stack[0, 3 + i] = start[triangles[t, i]], end[triangles[t, i]]
        depth[0], left = 0, 1
        while left:
            left -= 1
            six[:] = stack[left]
            if six[:, 2].min() > reach or six[:, 2].max() < -reach:
                continue
            n = fattened_hull(flat, _slab_points(six, reach, flat), width, widened, out)
            if lies_covered(raster, sums, out, n):
                continue
            level = depth[left]
            if level < DEEPEST and _twist(six) > slack:
                _quarter(stack, left, six)
                depth[left : left + 4] = level + 1
                left += 4
                continue
            rows = with_polygon(rows, found, out, n, 0)
            found += 1
    return rows[:found].copy()

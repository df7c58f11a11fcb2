"""What edges and faces sweep between two poses, as convex polygons in the plane, without what is covered anyway.

Between two poses the points of a rigid body stay within a proven distance of the chords of their paths, so
that an edge stays within that distance of the hull of its two positions. Not for: that distance itself.
"""

import math

import numpy as np

from clearance.jit import inlined, kernel
from clearance.kernels.swept_cover import lies_covered

MOST = 8
"""Corners of the largest polygon that is handed out here."""


@inlined
def _turn(ax, ay, bx, by, cx, cy):
    return (bx - ax) * (cy - ay) - (by - ay) * (cx - ax)


@inlined
def hull_of(points, n, out):
    """Writes the convex hull of `points[:n]` counter-clockwise into `out`; returns its number of corners.

    `points` is sorted in place. Source: Andrew (1979).
    """
    for i in range(1, n):
        x, y = points[i, 0], points[i, 1]
        j = i - 1
        while j >= 0 and (points[j, 0] > x or (points[j, 0] == x and points[j, 1] > y)):
            points[j + 1, 0], points[j + 1, 1] = points[j, 0], points[j, 1]
            j -= 1
        points[j + 1, 0], points[j + 1, 1] = x, y
    k = 0
    for way in range(2):
        base = k
        for step in range(n):
            i = step if way == 0 else n - 1 - step
            x, y = points[i, 0], points[i, 1]
            while (
                k - base >= 2
                and _turn(out[k - 2, 0], out[k - 2, 1], out[k - 1, 0], out[k - 1, 1], x, y) <= 0.0
            ):
                k -= 1
            out[k, 0], out[k, 1] = x, y
            k += 1
        k -= 1
    return k


@inlined
def _is_slender(corners, n, width):
    """True if a polygon has less area than a strip of `width` along its longest side."""
    area, longest = 0.0, 0.0
    for i in range(n):
        j = (i + 1) % n
        area += corners[i, 0] * corners[j, 1] - corners[i, 1] * corners[j, 0]
        longest = max(
            longest, math.hypot(corners[j, 0] - corners[i, 0], corners[j, 1] - corners[i, 1])
        )
    return n < 3 or 0.5 * area <= width * longest


@inlined
def fattened_hull(points, n, width, widened, out):
    """The hull, or where it is slenderer than `width` the hull of squares of that size about the points."""
    corners = hull_of(points, n, out)
    if not _is_slender(out, corners, width):
        return corners
    few = max(corners, 1)
    for i in range(few):
        for j in range(4):
            widened[4 * i + j, 0] = out[i, 0] + (width if j & 1 else -width)
            widened[4 * i + j, 1] = out[i, 1] + (width if j & 2 else -width)
    return hull_of(widened, 4 * few, out)


@kernel
def edge_hulls(raster, sums, points, edges, use_starts, use_faces, use_ways, states, width):
    """What the edges that may bound a body's outline sweep between neighbouring instants, uncovered only.

    Args:
        points: (k + 1, v, 2) [m] the vertices in the plane at each instant.
        states: (k, f) for each interval 1 or -1 for faces that are surely seen from the front or from
            behind throughout, 0 for others.
        width: [m] what slenderer polygons are widened by, to either side.

    Returns:
        corners (m, MOST, 2), n_corners (m,), interval (m,).
    """
    capacity, found = 1024, 0
    corners = np.empty((capacity, MOST, 2))
    n_corners = np.empty(capacity, np.int64)
    intervals = np.empty(capacity, np.int64)
    four, out, widened = np.empty((4, 2)), np.empty((40, 2)), np.empty((16, 2))
    for k in range(points.shape[0] - 1):
        for e in range(edges.shape[0]):
            count, known = 0, True
            for use in range(use_starts[e], use_starts[e + 1]):
                state = states[k, use_faces[use]]
                known = known and state != 0
                count += use_ways[use] * state
            if known and count == 0:
                continue
            for i in range(2):
                for c in range(2):
                    four[i, c] = points[k, edges[e, i], c]
                    four[2 + i, c] = points[k + 1, edges[e, i], c]
            n = fattened_hull(four, 4, width, widened, out)
            if lies_covered(raster, sums, out, n):
                continue
            if found == capacity:
                capacity *= 2
                grown = np.empty((capacity, MOST, 2))
                grown[:found] = corners
                corners = grown
                n_grown = np.empty(capacity, np.int64)
                n_grown[:found] = n_corners
                n_corners = n_grown
                i_grown = np.empty(capacity, np.int64)
                i_grown[:found] = intervals
                intervals = i_grown
            corners[found, :n] = out[:n]
            n_corners[found] = n
            intervals[found] = k
            found += 1
    return corners[:found].copy(), n_corners[:found].copy(), intervals[:found].copy()


@kernel
def triangle_hulls(raster, sums, points, triangles, width):
    """The triangles of one body at one instant that are not covered; as `edge_hulls`, without intervals."""
    corners = np.empty((len(triangles), MOST, 2))
    n_corners = np.empty(len(triangles), np.int64)
    four, out, widened = np.empty((4, 2)), np.empty((40, 2)), np.empty((16, 2))
    found = 0
    for t in range(len(triangles)):
        for i in range(3):
            for c in range(2):
                four[i, c] = points[triangles[t, i], c]
        n = fattened_hull(four, 3, width, widened, out)
        if not lies_covered(raster, sums, out, n):
            corners[found, :n] = out[:n]
            n_corners[found] = n
            found += 1
    return corners[:found].copy(), n_corners[:found].copy()

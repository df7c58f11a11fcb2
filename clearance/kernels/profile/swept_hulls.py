"""What edges and faces sweep between two poses, as convex polygons in the plane, without what is covered anyway.

Between two poses the points of a rigid body stay within a proven distance of the chords of their paths, so
that an edge stays within that distance of the hull of its two positions. Not for: that distance itself.
"""

import math

import numpy as np

from clearance.compile.declared import Floats2, Floats3, Integers2, Shorts2, Signs2
from clearance.compile.decorators import inline, kernel
from clearance.kernels.arithmetic.rows import with_capacity
from clearance.kernels.profile.swept_cover import Raster, SweptEdges, lies_covered

MOST = 16
"""Corners of the largest polygon that is handed out here: the hull of four squares, if rounding keeps them all."""

COUNT, INTERVAL, CORNERS = range(3)
"""Columns of a polygon's row: how many corners, of which interval, and from there on x and y of each corner."""


@inline
def with_polygon(rows, n, corners, count, interval):
    """The array of `n` polygons as rows and one more; a larger copy where there was no room."""
    if CORNERS + 2 * count > rows.shape[1]:
        raise AssertionError("a polygon has more corners than its row")
    rows = with_capacity(rows, n, 1)
    rows[n, COUNT], rows[n, INTERVAL] = count, interval
    for i in range(count):
        rows[n, CORNERS + 2 * i], rows[n, CORNERS + 2 * i + 1] = corners[i, 0], corners[i, 1]
    return rows


@inline
def _turn(ax, ay, bx, by, cx, cy):
    return (bx - ax) * (cy - ay) - (by - ay) * (cx - ax)


@inline
def hull_of(points, n, out):
    """Writes the convex hull of `points[:n]` counter-clockwise into `out`; returns its number of corners.

    `points` is sorted in place. Points on either side of the line from the first to the last make a chain each, so
    that no point is there twice, however turns are rounded. Source: Andrew (1979).
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
            side = _turn(points[0, 0], points[0, 1], points[n - 1, 0], points[n - 1, 1], x, y)
            if 0 < i < n - 1 and (side >= 0.0 if way == 0 else side <= 0.0):
                continue
            while (
                k - base >= 2
                and _turn(out[k - 2, 0], out[k - 2, 1], out[k - 1, 0], out[k - 1, 1], x, y) <= 0.0
            ):
                k -= 1
            out[k, 0], out[k, 1] = x, y
            k += 1
        k -= 1
    return k


@inline
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


@inline
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


@inline
def _is_convex(four):
    """True if the loop 0, 2, 3, 1 turns one way only: what the edge sweeps then is its hull."""
    left = right = False
    for i, j, k in ((0, 2, 3), (2, 3, 1), (3, 1, 0), (1, 0, 2)):
        turn = _turn(four[i, 0], four[i, 1], four[j, 0], four[j, 1], four[k, 0], four[k, 1])
        left, right = left or turn > 0.0, right or turn < 0.0
    return not (left and right)


@inline
def _twist(four):
    """[m] how far a point of the hull may be from what the edge sweeps: a quarter of the edge's change.

    A point of the hull with weights w_ij of the four corners is (w_00 w_11 - w_01 w_10) (change of the edge)
    off the point of the ruled patch with the same shares, and that product is at most 1/4.
    """
    x = four[3, 0] - four[2, 0] - four[1, 0] + four[0, 0]
    y = four[3, 1] - four[2, 1] - four[1, 1] + four[0, 1]
    return 0.25 * math.hypot(x, y)


@inline
def _part_of(points, k, a, b, low, high, four):
    """Writes the ends of part `low` to `high` (shares) of edge a-b at the instants k and k + 1."""
    for i in range(2):
        for c in range(2):
            start, end = points[k + i, a, c], points[k + i, b, c]
            four[2 * i, c] = start + low * (end - start) if low > 0.0 else start
            four[2 * i + 1, c] = start + high * (end - start) if high < 1.0 else end


@kernel
def edge_hulls(
    raster: Raster,
    sums: Shorts2,
    points: Floats3,
    edges: SweptEdges,
    states: Signs2,
    width: float,
    slack: float,
) -> Floats2:
    """What the edges that may bound a body's outline sweep between neighbouring instants, uncovered only.

    An edge is cut in halves until what it sweeps is convex or within `slack` of its hull.

    Args:
        points: (k + 1, v, 2) [m] the vertices in the plane at each instant.
        edges: `SweptEdges` of the body.
        states: (k, f) for each interval 1 or -1 for faces that are surely seen from the front or from
            behind throughout, 0 for others.
        width: [m] what slenderer polygons are widened by, to either side.
        slack: [m] how far hulls may exceed what the edges sweep on their chords.

    Returns:
        (m, CORNERS + 2 MOST) the polygons as rows.
    """
    ends, starts, faces, ways = edges.ends, edges.starts, edges.faces, edges.ways
    found, rows = 0, np.empty((1024, CORNERS + 2 * MOST))
    four, spare = np.empty((4, 2)), np.empty((4, 2))
    out, widened, waiting = np.empty((40, 2)), np.empty((16, 2)), np.empty((128, 2))
    for k in range(points.shape[0] - 1):
        for e in range(ends.shape[0]):
            count, known = 0, True
            for use in range(starts[e], starts[e + 1]):
                state = states[k, faces[use]]
                known = known and state != 0
                count += ways[use] * state
            if known and count == 0:
                continue
            waiting[0, 0], waiting[0, 1], left = 0.0, 1.0, 1
            while left:
                left -= 1
                low, high = waiting[left, 0], waiting[left, 1]
                _part_of(points, k, ends[e, 0], ends[e, 1], low, high, four)
                spare[:] = four
                n = fattened_hull(spare, 4, width, widened, out)
                if lies_covered(raster, sums, out, n):
                    continue
                if left < 126 and _twist(four) > slack and not _is_convex(four):
                    middle = 0.5 * (low + high)
                    waiting[left, 0], waiting[left, 1] = middle, high
                    waiting[left + 1, 0], waiting[left + 1, 1] = low, middle
                    left += 2
                    continue
                rows = with_polygon(rows, found, out, n, k)
                found += 1
    return rows[:found].copy()


@kernel
def triangle_hulls(
    raster: Raster, sums: Shorts2, points: Floats2, triangles: Integers2, width: float
) -> Floats2:
    """The triangles of one body at one instant that are not covered; as `edge_hulls`."""
    rows = np.empty((64, CORNERS + 2 * MOST))
    four, out, widened = np.empty((4, 2)), np.empty((40, 2)), np.empty((16, 2))
    found = 0
    for t in range(len(triangles)):
        for i in range(3):
            for c in range(2):
                four[i, c] = points[triangles[t, i], c]
        n = fattened_hull(four, 3, width, widened, out)
        if not lies_covered(raster, sums, out, n):
            rows = with_polygon(rows, found, out, n, 0)
            found += 1
    return rows[:found].copy()

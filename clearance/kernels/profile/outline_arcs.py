"""The fewest lines and arcs, found greedily, that stay within a tolerance of a closed polyline.

In the frame of a chord of length c a circle through both its ends is s (x^2 - c x + y^2) = y, with s half the
reciprocal of the centre's height; each vertex between the ends leaves an interval of s, and a run can be one
arc while the intervals meet. The one taken is then checked in full. Not for: curves (`arc_fit`).
"""

import math

import numpy as np

from clearance.compile.declared import Floats, Floats2, Integers
from clearance.compile.decorators import inline, kernel


@inline
def _run_arc(points, first, count, tolerance):
    """Whether one arc follows `count` edges from vertex `first`, and its bulge (0 for a line)."""
    n = len(points)
    ax, ay = points[first, 0], points[first, 1]
    bx, by = points[(first + count) % n, 0], points[(first + count) % n, 1]
    c = math.hypot(bx - ax, by - ay)
    if count == 1:
        return True, 0.0
    if c <= 2.0 * tolerance:
        return False, 0.0
    ux, uy = (bx - ax) / c, (by - ay) / c
    low, high, before = -1.0 / c, 1.0 / c, 0.0  # at most a quarter turn: |s| c <= tan(pi/4)
    for k in range(1, count):
        dx, dy = points[(first + k) % n, 0] - ax, points[(first + k) % n, 1] - ay
        x, y = ux * dx + uy * dy, ux * dy - uy * dx
        if not before < x < c:
            return False, 0.0
        before = x
        w = x * x - c * x + y * y
        if w >= 0.0:
            return False, 0.0
        low, high = max(low, (y + 0.9 * tolerance) / w), min(high, (y - 0.9 * tolerance) / w)
    if low > high:
        return False, 0.0
    s = 0.0 if low <= 0.0 <= high else 0.5 * (low + high)
    if not _follows(points, first, count, tolerance, s, c, ux, uy):
        return False, 0.0
    # Above, y > 0 is left of the chord; a centre on the left (s > 0) turns counter-clockwise.
    return True, math.tan(0.5 * math.atan(s * c))


@inline
def _follows(points, first, count, tolerance, s, c, ux, uy):
    """True if arc and edges are within `tolerance` of each other, vertex by vertex with the arc's height."""
    n = len(points)
    ax, ay = points[first, 0], points[first, 1]
    radius = math.hypot(0.5 * c, 0.5 / s) if s != 0.0 else math.inf
    last, px, py = 0.0, 0.0, 0.0
    for k in range(1, count + 1):
        dx, dy = points[(first + k) % n, 0] - ax, points[(first + k) % n, 1] - ay
        x, y = ux * dx + uy * dy, ux * dy - uy * dx
        off = abs(y)
        height = 0.0
        if s != 0.0:
            off = abs(math.hypot(x - 0.5 * c, y - 0.5 / s) - radius)
            edge = math.hypot(x - px, y - py)
            height = edge * edge / (4.0 * radius)  # at least the rise of the arc over the edge
        if max(off, last) + height > tolerance:
            return False
        last, px, py = off, x, y
    return True


@kernel
def arcs_of_ring(points: Floats2, tolerance: float) -> tuple[Integers, Floats]:
    """Vertices and bulges (tan of a quarter of the sweep, positive to the left) of a ring's lines and arcs.

    Args:
        points: (n, 2) [m] the ring, without repeating the first; neighbours differ.
        tolerance: [m] greatest distance of arcs and edges from each other.

    Returns:
        (k,) indices of `points` where pieces start; (k,) bulges.
    """
    n = len(points)
    starts = np.empty(n, np.int64)
    bulges = np.empty(n)
    start = _sharpest(points)
    found, done = 0, 0
    while done < n:
        first, left = (start + done) % n, n - done
        good, bulge, step = 1, 0.0, 1
        while good + step <= left:  # gallop, then halve
            fits, turned = _run_arc(points, first, good + step, tolerance)
            if not fits:
                break
            good, bulge, step = good + step, turned, 2 * step
        step = min(step, left - good)
        while step >= 1:
            if good + step <= left:
                fits, turned = _run_arc(points, first, good + step, tolerance)
                if fits:
                    good, bulge = good + step, turned
            step //= 2
        starts[found], bulges[found] = first, bulge
        found += 1
        done += good
    return starts[:found].copy(), bulges[:found].copy()


@inline
def _sharpest(points):
    n, best, least = len(points), 0, math.inf
    for i in range(n):
        ux, uy = points[i, 0] - points[i - 1, 0], points[i, 1] - points[i - 1, 1]
        j = (i + 1) % n
        vx, vy = points[j, 0] - points[i, 0], points[j, 1] - points[i, 1]
        cosine = (ux * vx + uy * vy) / (math.hypot(ux, uy) * math.hypot(vx, vy))
        if cosine < least:
            best, least = i, cosine
    return best

"""The first paper's iteration for the distance of two convex polygons (its section 3), as
published.

Reference points slide along search segments until both stand still or one has met an edge; a last
step along the edges ends it. The result is the distance of two points of the polygons, hence never
below their true distance, but often above it: `query/PAPER.md` says how often. `# Reading:` marks
where the text is silent and what was chosen.

Source: Lim, Oh, Kim, Kim & Kim, Development of an efficient algorithm for the minimum distance
calculation between general polyhedra, section 3.
"""

import math
from typing import NamedTuple

import numpy as np

from clearance.compile.declared import Floats2
from clearance.compile.decorators import inline, kernel
from clearance.kernels.arithmetic.vec3 import Vec3, along, cross, dot, gap_sq, row, sub

MOST_PASSES = 50
"""Passes through step 2 after which the iteration is given up and counted as not converged."""

STILL_SQ = 1e-24
"""[-] A search direction counts as zero where |s|^2 is at most this times |v|^2: s = v - (v n) n
is then rounding error, and moving along it could shorten the distance by no more than 1e-24 of
itself."""


class Polygon(NamedTuple):
    """A convex polygon: rows `start` to `stop` of `corners` in order, unit normal, and a point
    inside."""

    corners: np.ndarray
    start: int
    stop: int
    normal: Vec3
    centre: Vec3


class SearchSegment(NamedTuple):
    """A segment in a polygon, and the edges its two ends lie on; -1 where an end is on none."""

    start: Vec3
    end: Vec3
    edge_start: int
    edge_end: int


class PaperMinimum(NamedTuple):
    """Where the iteration ended: the two points, passes through step 2, and whether it ended by
    itself."""

    p: Vec3
    q: Vec3
    passes: int
    converged: bool


class ClosestPoints(NamedTuple):
    """The closest points p, q of two segments and their places t, u in [0, 1]; 0 and 1 are the
    ends."""

    p: Vec3
    q: Vec3
    t: float
    u: float


@inline
def clamped(x):
    """The nearest number in [0, 1]."""
    return 0.0 if x < 0.0 else (1.0 if x > 1.0 else x)


@inline
def lumelsky(a, b, c, d):
    """The closest points of the segments a b and c d; a point is a segment of length zero.

    As published, for this method alone: the divisor D1 D2 - R^2 loses digits between near-parallel segments.

    Steps as numbered in the source: 1 degenerate segments, 2 the line of a b (t = 0 for parallel
    lines), 3 the foot u on the other line, 4 clamped with t corrected to it. Ties: for parallel
    segments the foot of `a`, where it is on c d.

    Source: Lumelsky, On fast computation of distance between line segments, Information Processing
    Letters 21, 1985.
    """
    d1, d2, d12 = sub(b, a), sub(d, c), sub(c, a)
    length_1, length_2, r = dot(d1, d1), dot(d2, d2), dot(d1, d2)
    s1, s2 = dot(d1, d12), dot(d2, d12)
    t, u = 0.0, 0.0
    if length_2 == 0.0:
        t = clamped(s1 / length_1) if length_1 > 0.0 else 0.0
    elif length_1 == 0.0:
        u = clamped(-s2 / length_2)
    else:
        divisor = length_1 * length_2 - r * r
        t = clamped((s1 * length_2 - s2 * r) / divisor) if divisor > 0.0 else 0.0
        foot = (t * r - s2) / length_2
        u = clamped(foot)
        if u != foot:
            t = clamped((u * r + s1) / length_1)
    p = b if t == 1.0 else along(a, t, d1)
    q = d if u == 1.0 else along(c, u, d2)
    return ClosestPoints(p, q, t, u)


@inline
def chord(polygon, x, s):
    """The part of the line x + t s that is in the polygon; x itself where the line misses it.

    Ties: a line through a corner is taken to end on the edge of least index there.
    """
    low, high, edge_low, edge_high = -math.inf, math.inf, -1, -1
    misses = False
    for i in range(polygon.start, polygon.stop):
        j = i + 1 if i + 1 < polygon.stop else polygon.start
        corner = row(polygon.corners, i)
        inward = cross(polygon.normal, sub(row(polygon.corners, j), corner))
        depth = dot(inward, sub(x, corner))
        rate = dot(inward, s)
        if rate > 0.0 and -depth / rate > low:
            low, edge_low = -depth / rate, i
        elif rate < 0.0 and -depth / rate < high:
            high, edge_high = -depth / rate, i
        elif rate == 0.0 and depth < 0.0:
            misses = True
    if misses or edge_low < 0 or edge_high < 0 or low > high:
        return SearchSegment(x, x, -1, -1)
    return SearchSegment(along(x, low, s), along(x, high, s), edge_low, edge_high)


@inline
def edge_segment(polygon, i):
    """The whole edge that starts at corner `i`, as a search segment (step 2, cases 2 and 3)."""
    j = i + 1 if i + 1 < polygon.stop else polygon.start
    return SearchSegment(row(polygon.corners, i), row(polygon.corners, j), i, i)


@inline
def flattened(v, normal):
    """v without its part along the normal: the search direction of step 2 (1) (ii)."""
    return along(v, -dot(v, normal), normal)


@inline
def projected_chord(polygon, edge, x):
    """The chord of the polygon along the projection of the other polygon's edge (step 2, case 2
    (ii)).

    Reading: the text projects the edge's end nearer to the reference point `x` and the edge's
    direction; the line is the same through either end, but the nearer end is kept. Where the line
    misses the polygon or the projection is a point, which the text does not consider, the segment
    is `x` alone.
    """
    near = edge.start if gap_sq(edge.start, x) <= gap_sq(edge.end, x) else edge.end
    along_edge = flattened(sub(edge.end, edge.start), polygon.normal)
    foot = along(near, dot(sub(x, near), polygon.normal), polygon.normal)
    found = chord(polygon, foot, along_edge)
    return found if found.edge_start >= 0 else SearchSegment(x, x, -1, -1)


@inline
def edge_at(t, segment):
    """The edge on which the point at place `t` of a search segment lies, -1 inside the polygon.

    Reading: a reference point is on an edge exactly if it is an end of its chord; no tolerance.
    """
    return segment.edge_start if t == 0.0 else (segment.edge_end if t == 1.0 else -1)


@inline
def nearest_by_paper(a, b):
    """Steps 1 to 4 for two polygons.

    Reading: a pass in which the two points come no nearer ends the iteration too: in exact
    arithmetic every pass with s not zero gains, so that in floats s is then zero to rounding.
    """
    p, q, edge_p, edge_q = a.centre, b.centre, -1, -1
    for i_pass in range(1, MOST_PASSES + 1):
        v = sub(p, q)
        before = dot(v, v)
        if edge_p >= 0 or edge_q >= 0:
            # cases 2 and 3: along the edges, and that is the answer
            if edge_p >= 0 and edge_q >= 0:
                on_a, on_b = edge_segment(a, edge_p), edge_segment(b, edge_q)
            elif edge_p >= 0:
                on_a = edge_segment(a, edge_p)
                on_b = projected_chord(b, on_a, q)
            else:
                on_b = edge_segment(b, edge_q)
                on_a = projected_chord(a, on_b, p)
            last = lumelsky(on_a.start, on_a.end, on_b.start, on_b.end)
            return PaperMinimum(last.p, last.q, i_pass, True)
        s_p, s_q = flattened(v, a.normal), flattened(v, b.normal)
        if dot(s_p, s_p) <= STILL_SQ * before and dot(s_q, s_q) <= STILL_SQ * before:
            return PaperMinimum(p, q, i_pass, True)
        on_a, on_b = chord(a, p, s_p), chord(b, q, s_q)
        closest = lumelsky(on_a.start, on_a.end, on_b.start, on_b.end)
        edge_p, edge_q = edge_at(closest.t, on_a), edge_at(closest.u, on_b)
        if edge_p < 0 and edge_q < 0 and gap_sq(closest.p, closest.q) >= before:
            return PaperMinimum(p, q, i_pass, True)
        p, q = closest.p, closest.q
    return PaperMinimum(p, q, MOST_PASSES, False)


@kernel
def nearest_polygons_paper(
    corners_a: Floats2,
    normal_a: Floats2,
    centre_a: Floats2,
    corners_b: Floats2,
    normal_b: Floats2,
    centre_b: Floats2,
) -> PaperMinimum:
    """The iteration for two polygons given as (n, 3), (m, 3) with normals and centres as (1, 3)
    rows."""
    a = Polygon(corners_a, 0, len(corners_a), row(normal_a, 0), row(centre_a, 0))
    b = Polygon(corners_b, 0, len(corners_b), row(normal_b, 0), row(centre_b, 0))
    return nearest_by_paper(a, b)

"""Compiled upper bounds of the distance of a part of A to B, and the true distance of one of its points.

Not for: roots of the systems (`hausdorff.roots`), runs of many arcs (`hausdorff.run`), which parts are asked
about and in which order (`hausdorff.interval_search`).
"""

import math

import numpy as np

from clearance.compile.decorators import inline
from clearance.kernels.curve.arc import segment_distance
from clearance.kernels.curve.bernstein import gap_coefficients, greatest, reverse_rows
from clearance.kernels.curve.bezier import cut, hypotenuse, jet
from clearance.kernels.curve.nearest import nearest
from clearance.kernels.curve.scratch import PART_A, PART_B, SQUARES


@inline
def keep_best(state, lower, distance, i, t, j, s):
    """Keeps a point of A where its distance is the greatest so far, or the first."""
    if lower > state.lower or state.piece_a < 0:
        state.lower, state.distance = lower, distance
        state.piece_a, state.at_a = i, t
        state.piece_b, state.at_b = j, s


@inline
def consider(pair, i, t, hint, state, work):
    """The foot on B of A's point at (i, t); the best such point so far is kept in `state`."""
    curves = pair.curves
    here = jet(curves.a, i, t)
    x, y = here.x + curves.shift_x, here.y + curves.shift_y
    foot = nearest(curves.b, pair.leaves, x, y, hint, np.inf, work)
    keep_best(state, foot.lower, foot.distance, i, t, foot.piece, foot.local)
    return foot


@inline
def upper_bound(curves, part, other, work):
    """A proven upper bound of the distance of a part of A to B, and where its square's bound is largest.

    The bound is that to the part `other` of B, run through side by side. The place is a share of A's part.
    """
    p, q = work[PART_A], work[PART_B]
    n, m = _cut_parts(curves, part, other, p, q)
    if other.t0 > other.t1:
        reverse_rows(q, m)
    rational = curves.a.rational[part.piece] or curves.b.rational[other.piece]
    degree = gap_coefficients(n, m, rational, curves.shift_x, curves.shift_y, work)
    most, which = greatest(work[SQUARES], degree)
    return math.sqrt(most), which / degree


@inline
def _cut_parts(curves, part, other, p, q):
    """Writes the control points of a part of A and of one of B, that one forwards; returns both degrees."""
    n = cut(curves.a, part.piece, part.t0, part.t1, p)
    low, high = min(other.t0, other.t1), max(other.t0, other.t1)
    return n, cut(curves.b, other.piece, low, high, q)


@inline
def chord_bound(curves, part, other, work):
    """Another upper bound, which no speed along the curves disturbs: by way of the chord of B's part.

    Each point of the chord is square under a point of B's part, no farther than the part's control points
    are from the chord; A's control points bound its distance to the chord (convexity). Exact on lines.
    """
    p, q = work[PART_A], work[PART_B]
    n, m = _cut_parts(curves, part, other, p, q)
    x0, y0, x1, y1 = q[0, 0] / q[0, 2], q[0, 1] / q[0, 2], q[m, 0] / q[m, 2], q[m, 1] / q[m, 2]
    off, most = 0.0, 0.0
    for k in range(1, m):
        off = max(off, segment_distance(q[k, 0] / q[k, 2], q[k, 1] / q[k, 2], x0, y0, x1, y1))
    for k in range(n + 1):
        x, y = p[k, 0] / p[k, 2] + curves.shift_x, p[k, 1] / p[k, 2] + curves.shift_y
        most = max(most, segment_distance(x, y, x0, y0, x1, y1))
    return most + off


@inline
def extent_bound(curves, part, distance, work):
    """The distance of a part's middle, which is given, and how far its control points are from the middle."""
    here, far = jet(curves.a, part.piece, 0.5 * (part.t0 + part.t1)), 0.0
    points = work[PART_A]
    for k in range(cut(curves.a, part.piece, part.t0, part.t1, points) + 1):
        x, y = points[k, 0] / points[k, 2], points[k, 1] / points[k, 2]
        far = max(far, hypotenuse(x - here.x, y - here.y))
    return distance + far

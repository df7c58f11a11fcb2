"""Compiled arithmetic of circular arcs: distance, control points, and how far a Bézier piece strays from one.

An arc is the twelve numbers of one row: the parameter interval of the piece it stands for (S0, S1), its
ends, centre and radius (0 for a straight segment), sense (+1 counter-clockwise), the proven distance EPS
between it and its part of the curve, and its share of the half angle. No arc spans half a turn or more.
Not for: deciding where to cut a curve (`arc_fit`).
"""

import math
from typing import NamedTuple

import numpy as np

from clearance.compile.declared import Floats2
from clearance.compile.decorators import inline, kernel
from clearance.kernels.curve.bezier import CHOOSE, hypotenuse

S0, S1, X0, Y0, X1, Y1, CX, CY, RADIUS, SENSE, EPS, COSINE = range(12)
WIDTH = 12
ROUNDOFF = 2.0**-53


class Chord(NamedTuple):
    """The two ends of an arc or a segment, where it starts first."""

    x0: float
    y0: float
    x1: float
    y1: float


@inline
def set_segment(row, s0, s1, chord):
    """Makes `row` the straight segment between two points, for the parameters from `s0` to `s1`."""
    row[S0], row[S1] = s0, s1
    row[X0], row[Y0], row[X1], row[Y1] = chord
    row[CX], row[CY], row[RADIUS], row[SENSE], row[EPS], row[COSINE] = 0.0, 0.0, 0.0, 1.0, 0.0, 1.0


@inline
def set_arc(row, s0, s1, chord, tx, ty, flat):
    """Makes `row` the arc over a chord that starts along the unit tangent (tx, ty).

    Where its sagitta would be below `flat`, or it would reach half a turn, it is the segment instead.
    """
    set_segment(row, s0, s1, chord)
    cx, cy = chord.x1 - chord.x0, chord.y1 - chord.y0
    length = hypotenuse(cx, cy)
    if length == 0.0:
        return
    sine = (tx * cy - ty * cx) / length
    cosine = (tx * cx + ty * cy) / length
    if cosine <= 0.02 or abs(sine) * length <= 4.0 * flat:
        return
    radius = length / (2.0 * sine)
    row[CX], row[CY] = chord.x0 - radius * ty, chord.y0 + radius * tx
    row[RADIUS], row[SENSE] = abs(radius), 1.0 if radius > 0.0 else -1.0
    row[COSINE] = cosine


@inline
def segment_distance(x, y, x0, y0, x1, y1):
    """The distance from (x, y) to a segment."""
    dx, dy = x1 - x0, y1 - y0
    length_sq = dx * dx + dy * dy
    t = 0.0
    if length_sq > 0.0:
        t = min(1.0, max(0.0, ((x - x0) * dx + (y - y0) * dy) / length_sq))
    return hypotenuse(x - x0 - t * dx, y - y0 - t * dy)


@inline
def arc_distance(row, x, y):
    """The distance from (x, y) to the arc: the cone of the distance map over that point."""
    if row[RADIUS] == 0.0:
        return segment_distance(x, y, row[X0], row[Y0], row[X1], row[Y1])
    ox, oy = x - row[CX], y - row[CY]
    after = (row[X0] - row[CX]) * oy - (row[Y0] - row[CY]) * ox
    before = ox * (row[Y1] - row[CY]) - oy * (row[X1] - row[CX])
    if after * row[SENSE] >= 0.0 and before * row[SENSE] >= 0.0:
        return abs(hypotenuse(ox, oy) - row[RADIUS])
    start = (x - row[X0]) ** 2 + (y - row[Y0]) ** 2
    return math.sqrt(min(start, (x - row[X1]) ** 2 + (y - row[Y1]) ** 2))


@inline
def arc_middle(row):
    """The middle control point of the arc as a rational quadratic: where its end tangents meet."""
    mx, my = 0.5 * (row[X0] + row[X1]), 0.5 * (row[Y0] + row[Y1])
    if row[RADIUS] == 0.0:
        return mx, my
    # the pole of the chord: centre + (chord middle - centre) / cos^2(half angle)
    grow = 1.0 / (row[COSINE] * row[COSINE])
    return row[CX] + (mx - row[CX]) * grow, row[CY] + (my - row[CY]) * grow


@inline
def segment_error(row, points, n):
    """A proven bound of the distance between segment and curve part: the hull's distance to the segment.

    Distance to a convex set is convex, so that the control points decide; the other way round the curve's
    projection onto the segment is continuous and covers it.
    """
    worst = 0.0
    for k in range(n + 1):
        x, y = points[k, 0] / points[k, 2], points[k, 1] / points[k, 2]
        worst = max(worst, segment_distance(x, y, row[X0], row[Y0], row[X1], row[Y1]))
    return worst


@inline
def arc_error(row, points, n, work):
    """A proven bound of the distance between arc and curve part.

    The Bernstein coefficients of |P - centre|^2 enclose its radii; those of the two linear forms that bound
    the sector enclose how far the curve leaves it. Inside the sector the curve meets every angle (it is
    continuous), so that the bound holds in both directions.
    """
    if row[RADIUS] == 0.0:
        return segment_error(row, points, n)
    cx, cy, radius = row[CX], row[CY], row[RADIUS]
    ax, ay = (row[X0] - cx) / radius, (row[Y0] - cy) / radius
    bx, by = (row[X1] - cx) / radius, (row[Y1] - cy) / radius
    outside, least, most = 0.0, np.inf, 0.0
    for k in range(n + 1):
        w = points[k, 2]
        px, py = points[k, 0] - cx * w, points[k, 1] - cy * w
        outside = max(outside, -row[SENSE] * (ax * py - ay * px) / w)
        outside = max(outside, -row[SENSE] * (px * by - py * bx) / w)
        work[k, 0], work[k, 1], work[k, 2] = px * CHOOSE[n, k], py * CHOOSE[n, k], w * CHOOSE[n, k]
    for k in range(2 * n + 1):
        square, weight = 0.0, 0.0
        for i in range(max(0, k - n), min(n, k) + 1):
            j = k - i
            square += work[i, 0] * work[j, 0] + work[i, 1] * work[j, 1]
            weight += work[i, 2] * work[j, 2]
        least, most = min(least, square / weight), max(most, square / weight)
    radial = max(math.sqrt(most) - radius, radius - math.sqrt(max(least, 0.0)))
    return radial + 2.0 * outside + 16.0 * ROUNDOFF * (radius + abs(cx) + abs(cy))


@kernel
def distances_to_arcs(arcs: Floats2, x: float, y: float) -> tuple[float, int]:
    """The least distance from (x, y) to the rows of `arcs`, and which row has it: the slow truth."""
    best, which = np.inf, 0
    for k in range(arcs.shape[0]):
        distance = arc_distance(arcs[k], x, y)
        if distance < best:
            best, which = distance, k
    return best, which

"""Compiled distance map: the cones of one curve's arcs in a software depth buffer along another curve.

Each arc is a circular cone over the plane whose height is the distance to it; seen from below, the lowest
cone at a pixel is the nearest arc (Hoff et al., SIGGRAPH 1999). The buffer holds only the pixels that the
other curve passes, in the order in which it passes them, so that memory grows with length and not with
area. Cones are evaluated exactly at each pixel's centre: no triangles, so that epsilon 2 is rounding alone.
"""

import math
from typing import NamedTuple

import numpy as np

from clearance.compile.declared import Floats, Integers
from clearance.compile.decorators import inline
from clearance.kernels.curve.arc import EPS, S0, S1, X0, X1, Y0, Y1, arc_distance
from clearance.kernels.curve.arc_fit import BUCKET
from clearance.kernels.curve.bezier import hypotenuse, jet
from clearance.kernels.curve.boxes import cut_sq, nearest_in, with_bucket


class DistanceMap(NamedTuple):
    """Depth and nearest arc of each pixel along a curve, and where each of its leaves enters the list.

    `first` (n_leaves + 1,) points into `depth` and `arc`; `deepest` is the index of the greatest depth,
    reached on leaf `deepest_leaf`.
    """

    depth: Floats
    arc: Integers
    first: Integers
    deepest: int
    deepest_leaf: int


class _NearestArc(NamedTuple):
    """The nearest arc so far, and how near is enough."""

    distance: float
    which: int
    enough: float


@cut_sq.register
def _(best: _NearestArc):
    return best.distance * best.distance if best.distance > best.enough else -1.0


@with_bucket.register
def _(best: _NearestArc, arcs, bucket, x, y):
    distance, which = best.distance, best.which
    for k in range(bucket * BUCKET, min(arcs.shape[0], (bucket + 1) * BUCKET)):
        there = arc_distance(arcs[k], x, y)
        if there < distance:
            distance, which = there, k
    return _NearestArc(distance, which, best.enough)


@inline
def nearest_arc(leaves, x, y, hint, enough, stack):
    """The distance from (x, y) to the nearest arc, and its index: the lowest cone at one pixel.

    Any arc no farther than `enough` ends the search.
    """
    first = _NearestArc(arc_distance(leaves.arcs[hint], x, y), hint, enough)
    found = nearest_in(leaves.boxes, x, y, first, leaves.arcs, stack)
    return found.distance, found.which


@inline
def _samples(row, pixel):
    """How many steps along one arc keep neighbouring samples about a pixel apart."""
    return max(1, math.ceil(1.2 * hypotenuse(row[X1] - row[X0], row[Y1] - row[Y0]) / pixel))


@inline
def draw(pieces, leaves, other, shift_x, shift_y, pixel, stack):
    """The `DistanceMap` of the curve `other` along this curve, moved by the shift into the other's frame."""
    arcs = leaves.arcs
    n_arcs = arcs.shape[0]
    most = 1
    for k in range(n_arcs):
        most += _samples(arcs[k], pixel)
    depth, arc = np.empty(most), np.empty(most, np.int64)
    first = np.empty(n_arcs + 1, np.int64)
    used, hint, column, line = 0, other.arcs.shape[0] // 2, -(2**62), -(2**62)
    deepest, deepest_leaf = 0, 0
    for k in range(n_arcs):
        row = arcs[k]
        steps = _samples(row, pixel)
        for j in range(steps if k + 1 < n_arcs else steps + 1):
            t = row[S0] + (row[S1] - row[S0]) * j / steps
            x, y = row[X0] + shift_x, row[Y0] + shift_y
            if j > 0:
                here = jet(pieces, leaves.piece[k], t)
                x, y = here.x + shift_x, here.y + shift_y
            across, up = math.floor(x / pixel), math.floor(y / pixel)
            if across != column or up != line:
                column, line = across, up
                depth[used], hint = nearest_arc(
                    other, (across + 0.5) * pixel, (up + 0.5) * pixel, hint, -1.0, stack
                )
                arc[used] = hint
                if used == 0 or depth[used] > depth[deepest]:
                    deepest, deepest_leaf = used, k
                used += 1
            if j == 0:
                first[k] = used - 1
    first[n_arcs] = used - 1
    return DistanceMap(depth[:used], arc[:used], first, deepest, deepest_leaf)


@inline
def lower_bound_of_map(drawn, own, other, pixel):
    """Equation (2): the greatest depth less the errors of biarcs, cones and pixels; a true lower bound.

    epsilon 3 is half a pixel's diagonal, because the depth is that of the pixel's centre (the paper's (1)
    allows a whole one).
    """
    biarc = 0.0
    for k in range(other.arcs.shape[0]):
        biarc = max(biarc, other.arcs[k, EPS])
    deepest = drawn.depth[drawn.deepest]
    return max(0.0, deepest * (1.0 - 1e-14) - biarc - pixel * math.sqrt(0.5) * (1.0 + 1e-14))

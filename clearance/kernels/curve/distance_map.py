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
from clearance.kernels.curve.boxes import box_gap_sq


class DistanceMap(NamedTuple):
    """Depth and nearest arc of each pixel along a curve, and where each of its leaves enters the list.

    `first` (n_leaves + 1,) points into `depth` and `arc`; `deepest` is the index of the greatest depth,
    reached on leaf `deepest_leaf` at the local parameter `deepest_at`.
    """

    depth: Floats
    arc: Integers
    first: Integers
    deepest: int
    deepest_leaf: int
    deepest_at: float


@inline
def nearest_arc(leaves, x, y, hint, enough, stack):
    """The distance from (x, y) to the nearest arc, and its index: the lowest cone at one pixel.

    Any arc no farther than `enough` ends the search.
    """
    arcs, boxes = leaves.arcs, leaves.boxes
    n_arcs, size = arcs.shape[0], boxes.shape[0] // 2
    best, which = arc_distance(arcs[hint], x, y), hint
    stack[0, 0], stack[0, 1] = 1.0, 0.0
    top = 1
    while top > 0 and best > enough:
        top -= 1
        node = int(stack[top, 0])
        if stack[top, 1] >= best * best:
            continue
        if node >= size:
            first = (node - size) * BUCKET
            for k in range(first, min(n_arcs, first + BUCKET)):
                distance = arc_distance(arcs[k], x, y)
                if distance < best:
                    best, which = distance, k
            continue
        a, b = box_gap_sq(boxes, 2 * node, x, y), box_gap_sq(boxes, 2 * node + 1, x, y)
        nearer = 2 * node if a <= b else 2 * node + 1
        stack[top, 0], stack[top, 1] = 4 * node + 1 - nearer, max(a, b)
        stack[top + 1, 0], stack[top + 1, 1] = nearer, min(a, b)
        top += 2
    return best, which


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
    deepest, deepest_leaf, deepest_at = 0, 0, 0.0
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
                    deepest, deepest_leaf, deepest_at = used, k, t
                used += 1
            if j == 0:
                first[k] = used - 1
    first[n_arcs] = used - 1
    return DistanceMap(depth[:used], arc[:used], first, deepest, deepest_leaf, deepest_at)


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

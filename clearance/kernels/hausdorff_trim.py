"""Compiled trimming of one curve against the offset of another: equations (3) to (10) of Kim, Oh, Kim (2010).

An arc of the one curve that lies wholly within the lower bound of an arc of the other cannot hold the
Hausdorff distance. Three control points decide. Two differences from the paper, both on the safe side: the
biarc errors of both curves are taken off (the paper takes one), and a straight piece of the other curve is
tested by its whole stadium, which is convex.
"""

import numpy as np

from clearance.jit import inlined, kernel
from clearance.kernels.arc import (
    COSINE,
    CX,
    CY,
    EPS,
    RADIUS,
    SENSE,
    X0,
    X1,
    Y0,
    Y1,
    arc_middle,
    segment_distance,
)
from clearance.kernels.curve_bezier import hypotenuse


@inlined
def _within_segment(points, row, reach):
    for k in range(3):
        x, y = points[k, 0], points[k, 1]
        if not segment_distance(x, y, row[X0], row[Y0], row[X1], row[Y1]) < reach:
            return False
    return True


@inlined
def _within_circle(points, x, y, reach):
    """Equations (9) and (10): all three control points within `reach` of one end of the arc."""
    for k in range(3):
        if not hypotenuse(points[k, 0] - x, points[k, 1] - y) < reach:
            return False
    return True


@inlined
def _side(row, x, y):
    """0 where (x, y) is between the two rays from the arc's centre, -1 before the first, 1 past the second."""
    ox, oy = x - row[CX], y - row[CY]
    if ((row[X0] - row[CX]) * oy - (row[Y0] - row[CY]) * ox) * row[SENSE] < 0.0:
        return -1
    if (ox * (row[Y1] - row[CY]) - oy * (row[X1] - row[CX])) * row[SENSE] < 0.0:
        return 1
    return 0


@inlined
def arc_covers(points, row, reach):
    """Whether the triangle of three control points lies within `reach` of the arc `row`, proven.

    Equation (8) with (4): between the rays, the inner offset circle bulges into the triangle by at most its
    own sagitta, epsilon' = epsilon OA' / OA; a chord at radius OA' + epsilon' / cos(theta) stays outside it.
    """
    if row[RADIUS] == 0.0:
        return _within_segment(points, row, reach)
    for k in range(3):
        side = _side(row, points[k, 0], points[k, 1])
        if side < 0:
            return _within_circle(points, row[X0], row[Y0], reach)
        if side > 0:
            return _within_circle(points, row[X1], row[Y1], reach)
    inner = max(0.0, row[RADIUS] - reach)
    concave = inner * (1.0 - row[COSINE]) / row[COSINE]
    for k in range(3):
        radius = hypotenuse(points[k, 0] - row[CX], points[k, 1] - row[CY])
        if not abs(radius - row[RADIUS]) < reach - concave:
            return False
    return True


@kernel
def trim(leaves, other, drawn, shift_x, shift_y, lower_bound, kept):
    """Marks in `kept` (n_leaves,) the arcs that may hold the Hausdorff distance; returns how many do.

    The candidates for an arc are the other curve's arcs that the map shows at its start, middle and end.
    """
    points = np.empty((3, 2))
    n_kept = 0
    for k in range(leaves.arcs.shape[0]):
        row = leaves.arcs[k]
        mx, my = arc_middle(row)
        points[0, 0], points[0, 1] = row[X0] + shift_x, row[Y0] + shift_y
        points[1, 0], points[1, 1] = mx + shift_x, my + shift_y
        points[2, 0], points[2, 1] = row[X1] + shift_x, row[Y1] + shift_y
        start, end = drawn.first[k], drawn.first[k + 1]
        covered = False
        for j in range(3):
            facing = other.arcs[drawn.arc[start + (end - start) * j // 2]]
            if j > 0 and start == end:
                break
            reach = lower_bound * (1.0 - 1e-14) - row[EPS] - facing[EPS]
            if reach > 0.0 and arc_covers(points, facing, reach):
                covered = True
                break
        kept[k] = not covered
        n_kept += kept[k]
    return n_kept

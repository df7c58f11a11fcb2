"""Compiled trimming of one curve against the offset of another: equations (3) to (10) of Kim, Oh, Kim (2010).

An arc of the one curve that lies wholly within the lower bound of an arc of the other cannot hold the
Hausdorff distance. Three control points decide. Two differences from the paper, both on the safe side: the
biarc errors of both curves are taken off (the paper takes one), and a straight piece of the other curve is
tested by its whole stadium, which is convex.
"""

import numpy as np

from clearance.compile.declared import Flags, Floats, Floats2, Integers2
from clearance.compile.decorators import inline, kernel
from clearance.kernels.curve.arc import (
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
    arc_distance,
    arc_middle,
    segment_distance,
)
from clearance.kernels.curve.arc_fit import Leaves
from clearance.kernels.curve.bezier import Pieces, hypotenuse
from clearance.kernels.curve.distance_map import DistanceMap, draw, nearest_arc


@inline
def _within_segment(points, row, reach):
    for k in range(3):
        x, y = points[k, 0], points[k, 1]
        if not segment_distance(x, y, row[X0], row[Y0], row[X1], row[Y1]) < reach:
            return False
    return True


@inline
def _within_circle(points, x, y, reach):
    """Equations (9) and (10): all three control points within `reach` of one end of the arc."""
    for k in range(3):
        if not hypotenuse(points[k, 0] - x, points[k, 1] - y) < reach:
            return False
    return True


@inline
def _side(row, x, y):
    """0 where (x, y) is between the two rays from the arc's centre, -1 before the first, 1 past the second."""
    ox, oy = x - row[CX], y - row[CY]
    if ((row[X0] - row[CX]) * oy - (row[Y0] - row[CY]) * ox) * row[SENSE] < 0.0:
        return -1
    if (ox * (row[Y1] - row[CY]) - oy * (row[X1] - row[CX])) * row[SENSE] < 0.0:
        return 1
    return 0


@inline
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


@inline
def put_control_points(row, shift_x, shift_y, points):
    """Writes the control points (3, 2) of an arc, moved by the shift."""
    mx, my = arc_middle(row)
    points[0, 0], points[0, 1] = row[X0] + shift_x, row[Y0] + shift_y
    points[1, 0], points[1, 1] = mx + shift_x, my + shift_y
    points[2, 0], points[2, 1] = row[X1] + shift_x, row[Y1] + shift_y


@kernel
def trim(
    leaves: Leaves,
    other: Leaves,
    drawn: DistanceMap,
    shift_x: float,
    shift_y: float,
    lower_bound: float,
    candidates: Flags,
):
    """Clears in `candidates` (n_leaves,) the arcs that cannot hold the Hausdorff distance.

    The candidates for an arc are the other curve's arcs that the map shows at its start, middle and end,
    and the two beside that in the middle.
    """
    points = np.empty((3, 2))
    for k in range(leaves.arcs.shape[0]):
        if not candidates[k]:
            continue
        row = leaves.arcs[k]
        put_control_points(row, shift_x, shift_y, points)
        start, end = drawn.first[k], drawn.first[k + 1]
        covered = False
        for j in range(5):
            if start == end and 0 < j < 3:
                continue
            seen = drawn.arc[start + (end - start) * (j if j < 3 else 1) // 2]
            seen = min(other.arcs.shape[0] - 1, max(0, seen + (0, 0, 0, 1, -1)[j]))
            facing = other.arcs[seen]
            reach = lower_bound * (1.0 - 1e-14) - row[EPS] - facing[EPS]
            if reach > 0.0 and arc_covers(points, facing, reach):
                covered = True
                break
        candidates[k] = not covered


@kernel
def candidate_arcs(
    pa: Pieces,
    la: Leaves,
    lb: Leaves,
    shift_x: float,
    shift_y: float,
    lower_bound: float,
    pixel: float,
) -> Flags:
    """Which arcs of A trimming leaves at a given lower bound (n,), for pictures and for tests."""
    stack = np.empty((96, 2))
    drawn = draw(pa, la, lb, shift_x, shift_y, pixel, stack)
    candidates = np.ones(la.arcs.shape[0], np.bool_)
    trim(la, lb, drawn, shift_x, shift_y, lower_bound, candidates)
    return candidates


@kernel
def field(leaves: Leaves, xs: Floats, ys: Floats, depth: Floats2, which: Integers2):
    """Fills `depth` and `which` (len(ys), len(xs)) with the distance map of a curve over a whole page."""
    stack = np.empty((96, 2))
    hint = leaves.arcs.shape[0] // 2
    for r in range(ys.shape[0]):
        for c in range(xs.shape[0]):
            depth[r, c], hint = nearest_arc(leaves, xs[c], ys[r], hint, -1.0, stack)
            # where the common end of two arcs is nearest both are; the earlier one, or rounding would decide
            enough = depth[r, c] * (1.0 + 1e-12)
            while hint > 0 and arc_distance(leaves.arcs[hint - 1], xs[c], ys[r]) <= enough:
                hint -= 1
            if arc_distance(leaves.arcs[0], xs[c], ys[r]) <= enough:
                hint = 0
            which[r, c] = hint

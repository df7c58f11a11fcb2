"""Segments of a polyline, straight from its control points, in a tree of boxes: which is nearest, which covers.

Segment k lies between the rows 2 k and 2 k + 1 of the control points. Not for: searches (`hausdorff.polyline`).
"""

import math
from typing import NamedTuple

import numpy as np

from clearance.compile.declared import Floats2
from clearance.compile.decorators import inline, kernel
from clearance.kernels.curve.bezier import Joints, Pieces
from clearance.kernels.curve.boxes import cut_sq, fill_inner_boxes, nearest_in, with_bucket

BUCKET = 8  # segments in a box
STACK = 128  # nodes of a tree that may be open at once


class Segments(NamedTuple):
    """A polyline: its pieces, their `segment_boxes` (2 P, 4), and how the pieces follow one another."""

    pieces: Pieces
    boxes: Floats2
    joints: Joints


@kernel
def segment_boxes(control: Floats2) -> Floats2:
    """The implicit tree of boxes (2 P, 4) over segments, rows 2 k and 2 k + 1 of `control`, in their order.

    Node k has the children 2 k and 2 k + 1; node P + b holds the segments from BUCKET b on.
    """
    n = control.shape[0] // 2
    size = 1
    while size * BUCKET < n:
        size *= 2
    boxes = np.empty((2 * size, 4))
    for b in range(size):
        x0, y0, x1, y1 = np.inf, np.inf, -np.inf, -np.inf
        for r in range(2 * BUCKET * b, min(2 * n, 2 * BUCKET * (b + 1))):
            x, y = control[r, 0], control[r, 1]
            x0, y0, x1, y1 = min(x0, x), min(y0, y), max(x1, x), max(y1, y)
        box = boxes[size + b]
        box[0], box[1], box[2], box[3] = x0, y0, x1, y1
    fill_inner_boxes(boxes)
    return boxes


@inline
def foot_on(control, k, x, y):
    """The squared distance from (x, y) to segment `k`, and the local parameter of its foot."""
    x0, y0 = control[2 * k, 0], control[2 * k, 1]
    dx, dy = control[2 * k + 1, 0] - x0, control[2 * k + 1, 1] - y0
    ex, ey = x - x0, y - y0
    along, length_sq = ex * dx + ey * dy, dx * dx + dy * dy
    if along <= 0.0:
        return ex * ex + ey * ey, 0.0
    if along >= length_sq:
        ex, ey = x - control[2 * k + 1, 0], y - control[2 * k + 1, 1]
        return ex * ex + ey * ey, 1.0
    t = along / length_sq
    ex, ey = ex - t * dx, ey - t * dy
    return ex * ex + ey * ey, t


@inline
def distance_to(control, k, x, y):
    """The distance from (x, y) to segment `k`."""
    return math.sqrt(foot_on(control, k, x, y)[0])


class _NearestSegment(NamedTuple):
    """The nearest segment so far, and its squared distance."""

    square: float
    which: int


@cut_sq.register
def _(best: _NearestSegment):
    return best.square


@with_bucket.register
def _(best: _NearestSegment, control, bucket, x, y):
    square, which = best
    for k in range(bucket * BUCKET, min(control.shape[0] // 2, (bucket + 1) * BUCKET)):
        there = foot_on(control, k, x, y)[0]
        if there < square:
            square, which = there, k
    return _NearestSegment(square, which)


@inline
def nearest_segment(segments, x, y, hint, stack):
    """The distance from (x, y) to the nearest segment, and its index; `hint` is tried first."""
    control = segments.pieces.control
    first = _NearestSegment(foot_on(control, hint, x, y)[0], hint)
    found = nearest_in(segments.boxes, x, y, first, control, stack)
    return math.sqrt(found.square), found.which


@inline
def point_at(control, k, t):
    """The point of segment `k` at the local parameter `t`."""
    s = 1.0 - t
    return (
        s * control[2 * k, 0] + t * control[2 * k + 1, 0],
        s * control[2 * k, 1] + t * control[2 * k + 1, 1],
    )


@inline
def is_box_covered(boxes, node, qc, k, shift_x, shift_y, reach_sq):
    """Whether a box lies within reach of segment `k`: its four corners decide, what is in reach is convex."""
    for corner in range(4):
        x = boxes[node, 2 * (corner & 1)] + shift_x
        y = boxes[node, 1 + (corner & 2)] + shift_y
        if not foot_on(qc, k, x, y)[0] <= reach_sq:
            return False
    return True


@inline
def covering_segment(pc, i, qc, hint, shift_x, shift_y, reach_sq):
    """The segment of B within whose reach segment `i` of A lies: the hint, the next, the one before; else -1."""
    x0, y0 = pc[2 * i, 0] + shift_x, pc[2 * i, 1] + shift_y
    x1, y1 = pc[2 * i + 1, 0] + shift_x, pc[2 * i + 1, 1] + shift_y
    for step in (0, 1, -1):
        k = hint + step
        if 0 <= k < qc.shape[0] // 2 and foot_on(qc, k, x1, y1)[0] <= reach_sq:
            if foot_on(qc, k, x0, y0)[0] <= reach_sq:
                return k
    return -1

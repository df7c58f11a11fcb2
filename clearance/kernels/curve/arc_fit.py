"""Compiled biarc approximation of Bézier pieces, and the tree of boxes over the arcs in curve order.

Source: Šír, Feichtinger, Jüttler, Approximating curves and their offsets using biarcs and Pythagorean
hodograph quintics, CAD 38 (2006), section 3: of the biarcs through two end points with their tangents, take
one whose joint lies on the curve, so that each arc keeps a parameter interval of its own. Where no biarc
serves (cusps, tiny or straight parts) a segment with its own proven error does.
"""

import math
from typing import NamedTuple

import numpy as np

from clearance.compile.declared import Floats2, Integers
from clearance.compile.decorators import inline, kernel
from clearance.kernels.curve.arc import (
    CX,
    CY,
    EPS,
    RADIUS,
    S0,
    S1,
    WIDTH,
    X0,
    X1,
    Y0,
    Y1,
    Chord,
    arc_error,
    set_arc,
    set_segment,
)
from clearance.kernels.curve.bezier import Pieces, cut, hypotenuse, jet
from clearance.kernels.curve.boxes import fill_inner_boxes

BUCKET = 4
DEEPEST = 48


class Leaves(NamedTuple):
    """The arcs of one curve in curve order, the piece of each, and an implicit binary tree of boxes.

    `boxes` (2 P, 4) has node k's children at 2 k and 2 k + 1; node P + b holds arcs BUCKET b onwards. Boxes
    contain the curve itself: the arcs grown by their errors.
    """

    arcs: Floats2
    piece: Integers
    boxes: Floats2


@inline
def end_tangent(points, n, at_end):
    """The unit tangent at one end of a control polygon, from the nearest control point that differs."""
    e = n if at_end else 0
    x, y = points[e, 0] / points[e, 2], points[e, 1] / points[e, 2]
    for k in range(1, n + 1):
        i = n - k if at_end else k
        dx, dy = points[i, 0] / points[i, 2] - x, points[i, 1] / points[i, 2] - y
        length = hypotenuse(dx, dy)
        if length > 0.0:
            sign = -1.0 if at_end else 1.0
            return sign * dx / length, sign * dy / length
    return 1.0, 0.0


@inline
def _off_joint_circle(pieces, i, s, row, sine, cosine):
    """The implicit equation of the circle of all joints, at the curve's parameter `s`."""
    here = jet(pieces, i, s)
    cx, cy = row[X1] - row[X0], row[Y1] - row[Y0]
    length = hypotenuse(cx, cy)
    px, py = here.x - row[X0], here.y - row[Y0]
    x, y = (px * cx + py * cy) / length, (py * cx - px * cy) / length
    return sine * (x * (x - length) + y * y) + length * cosine * y


@inline
def joint_parameter(pieces, i, row, ax, ay, bx, by, steps):
    """Where piece `i` crosses the circle of joints between the ends of the segment `row`, or nan.

    The circle leaves the chord at the mean of the end tangents' angles (one angle taken negative), so that
    the curve starts on one side of it and ends on the other: a crossing exists.

    Args:
        ax, ay, bx, by: the unit tangents of the curve at both ends. steps: halvings.
    """
    s0, s1 = row[S0], row[S1]
    cx, cy = row[X1] - row[X0], row[Y1] - row[Y0]
    alpha = math.atan2(cx * ay - cy * ax, cx * ax + cy * ay)
    beta = math.atan2(cx * by - cy * bx, cx * bx + cy * by)
    if abs(alpha) > 1.5 or abs(beta) > 1.5:
        return math.nan
    phi = 0.5 * (alpha - beta)
    if abs(alpha + beta) < 1e-9:
        return 0.5 * (s0 + s1)
    sine, cosine = math.sin(phi), math.cos(phi)
    low, high = 0.0, 1.0
    f_low = math.copysign(1.0, alpha + beta)
    for _ in range(steps):
        u = 0.5 * (low + high)
        f = _off_joint_circle(pieces, i, s0 + u * (s1 - s0), row, sine, cosine)
        if f == 0.0:
            break
        if (f > 0.0) == (f_low > 0.0):
            low = u
        else:
            high = u
    u = 0.5 * (low + high)
    return s0 + u * (s1 - s0) if 0.01 < u < 0.99 else math.nan


@inline
def fit_biarc(pieces, i, s0, s1, flat, steps, work, pair):
    """Writes the biarc of piece `i` on [s0, s1] into the two rows of `pair` and returns how many it used.

    Each row carries its proven error. One row, a segment, where no joint was found.
    """
    points = work[0]
    n = cut(pieces, i, s0, s1, points)
    ax, ay = end_tangent(points, n, False)
    bx, by = end_tangent(points, n, True)
    row = pair[0]
    x0, y0 = points[0, 0] / points[0, 2], points[0, 1] / points[0, 2]
    x1, y1 = points[n, 0] / points[n, 2], points[n, 1] / points[n, 2]
    set_segment(row, s0, s1, Chord(x0, y0, x1, y1))
    row[EPS] = arc_error(row, points, n, work[1])
    if n == 1 or row[EPS] <= flat or (x0 == x1 and y0 == y1):
        return 1
    joint = joint_parameter(pieces, i, row, ax, ay, bx, by, steps)
    if math.isnan(joint):
        return 1
    here = jet(pieces, i, joint)
    set_arc(pair[0], s0, joint, Chord(x0, y0, here.x, here.y), ax, ay, flat)
    set_arc(pair[1], joint, s1, Chord(x1, y1, here.x, here.y), -bx, -by, flat)
    _reverse(pair[1])
    for half in range(2):
        row = pair[half]
        cut(pieces, i, row[0], row[1], points)
        row[EPS] = arc_error(row, points, n, work[1])
    return 2


@inline
def _reverse(row):
    """Runs an arc built from its end backwards the right way round."""
    x, y = row[X0], row[Y0]
    row[X0], row[Y0] = row[X1], row[Y1]
    row[X1], row[Y1] = x, y
    row[9] = -row[9]


@kernel
def fit_leaves(pieces: Pieces, tolerance: float, steps: int) -> tuple[Floats2, Integers]:
    """Arcs (n, WIDTH) in curve order, each within `tolerance` of its part of the curve, and their pieces.

    A part is halved until its biarc is good enough; at the smallest interval that floats allow it is taken
    as it is, with its true error.
    """
    n_pieces = pieces.first.shape[0] - 1
    widest = 0
    for i in range(n_pieces):
        widest = max(widest, pieces.first[i + 1] - pieces.first[i])
    work = np.empty((2, 2 * widest + 2, 3))
    pair = np.empty((2, WIDTH))
    arcs = np.empty((2 * n_pieces + 16, WIDTH))
    owner = np.empty(2 * n_pieces + 16, np.int64)
    stack = np.empty((DEEPEST + 4, 2))
    used = 0
    for i in range(n_pieces):
        start = pieces.first[i]
        if pieces.first[i + 1] - start == 2 and not pieces.rational[i]:
            if used + 2 > arcs.shape[0]:
                arcs, owner = _grown(arcs, owner)
            a, b = pieces.control[start], pieces.control[start + 1]
            chord = Chord(a[0] / a[2], a[1] / a[2], b[0] / b[2], b[1] / b[2])
            set_segment(arcs[used], 0.0, 1.0, chord)
            owner[used] = i
            used += 1
            continue
        stack[0, 0], stack[0, 1] = 0.0, 1.0
        top = 1
        while top > 0:
            top -= 1
            s0, s1 = stack[top, 0], stack[top, 1]
            n_rows = fit_biarc(pieces, i, s0, s1, 0.02 * tolerance, steps, work, pair)
            worst = pair[0, EPS] if n_rows == 1 else max(pair[0, EPS], pair[1, EPS])
            middle = 0.5 * (s0 + s1)
            if not worst <= tolerance and s1 - s0 > 1e-13 and top < DEEPEST:
                stack[top, 0], stack[top, 1] = middle, s1
                stack[top + 1, 0], stack[top + 1, 1] = s0, middle
                top += 2
                continue
            if used + 2 > arcs.shape[0]:
                arcs, owner = _grown(arcs, owner)
            for k in range(n_rows):
                arcs[used] = pair[k]
                owner[used] = i
                used += 1
    return arcs[:used], owner[:used]


@inline
def _grown(arcs, owner):
    size = 2 * arcs.shape[0]
    wider = np.empty((size, arcs.shape[1]))
    wider[: arcs.shape[0]] = arcs
    longer = np.empty(size, np.int64)
    longer[: arcs.shape[0]] = owner
    return wider, longer


@kernel
def box_tree(arcs: Floats2) -> Floats2:
    """The implicit tree of boxes over `arcs` that `Leaves` describes."""
    n_buckets = (arcs.shape[0] + BUCKET - 1) // BUCKET
    size = 1
    while size < n_buckets:
        size *= 2
    boxes = np.empty((2 * size, 4))
    boxes[:, :2] = np.inf
    boxes[:, 2:] = -np.inf
    for k in range(arcs.shape[0]):
        row = arcs[k]
        box = boxes[size + k // BUCKET]
        grow = row[EPS]
        mx, my = 0.5 * (row[X0] + row[X1]), 0.5 * (row[Y0] + row[Y1])
        if row[RADIUS] > 0.0:  # the arc lies within its sagitta of the chord
            cx, cy = mx - row[CX], my - row[CY]
            grow += row[RADIUS] - hypotenuse(cx, cy) + 1e-15 * row[RADIUS]
        box[0] = min(box[0], min(row[X0], row[X1]) - grow)
        box[1] = min(box[1], min(row[Y0], row[Y1]) - grow)
        box[2] = max(box[2], max(row[X0], row[X1]) + grow)
        box[3] = max(box[3], max(row[Y0], row[Y1]) + grow)
    fill_inner_boxes(boxes)
    return boxes

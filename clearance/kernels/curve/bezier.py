"""Compiled arithmetic of planar Bézier pieces, polynomial or rational, of any degree.

A curve is a list of pieces in flat arrays: `control` (m, 3) holds (w x, w y, w) of every control point,
piece i owns the rows `first[i]` to `first[i + 1]`, and `rational[i]` says whether its weights differ.
Everything here is a convex combination of control points, so that its rounding error is at most
3 degree UNIT_ROUNDOFF times the largest coordinate. Not for: distances.
"""

import math
from typing import NamedTuple

import numpy as np

from clearance.compile.declared import Flags, Flags2, Floats, Floats2, Integers
from clearance.compile.decorators import inline, kernel

HIGHEST_DEGREE = 24
CHOOSE = np.array(
    [
        [float(math.comb(n, k)) for k in range(4 * HIGHEST_DEGREE + 1)]
        for n in range(4 * HIGHEST_DEGREE + 1)
    ]
)


class Pieces(NamedTuple):
    """Bézier pieces of one curve, in homogeneous coordinates about the curve's own origin."""

    control: Floats2
    first: Integers
    rational: Flags


class Jet(NamedTuple):
    """A point of a curve with its first and second derivative by the piece's local parameter."""

    x: float
    y: float
    dx: float
    dy: float
    ddx: float
    ddy: float


@inline
def component(control, start, n, column, t):
    """Value, first and second derivative of one homogeneous coordinate at `t`, Bernstein-Horner."""
    s = 1.0 - t
    if n == 1:
        a, b = control[start, column], control[start + 1, column]
        return s * a + t * b, b - a, 0.0
    if n == 2:
        a, b, c = control[start, column], control[start + 1, column], control[start + 2, column]
        ab, bc = s * a + t * b, s * b + t * c
        return s * ab + t * bc, 2.0 * (bc - ab), 2.0 * ((c - b) - (b - a))
    value, slope, bend = control[start, column] * s, 0.0, 0.0
    power, choose = 1.0, 1.0
    for i in range(1, n):
        power *= t
        choose *= (n - i + 1) / i
        value = (value + power * choose * control[start + i, column]) * s
    value += power * t * control[start + n, column]
    power, choose = 1.0, 1.0
    slope = (control[start + 1, column] - control[start, column]) * s
    for i in range(1, n - 1):
        power *= t
        choose *= (n - i) / i
        step = control[start + i + 1, column] - control[start + i, column]
        slope = (slope + power * choose * step) * s
    slope += power * t * (control[start + n, column] - control[start + n - 1, column])
    power, choose = 1.0, 1.0
    for i in range(n - 1):
        turn = control[start + i + 2, column] - 2.0 * control[start + i + 1, column]
        turn += control[start + i, column]
        bend += choose * turn * t**i * s ** (n - 2 - i)
        choose *= (n - 2 - i) / (i + 1)
    return value, n * slope, n * (n - 1) * bend


@inline
def _cubic_jet(control, k, t):
    """The `Jet` of a polynomial cubic from row `k` on, by de Casteljau: both coordinates side by side."""
    s = 1.0 - t
    ax, ay, bx, by = control[k, 0], control[k, 1], control[k + 1, 0], control[k + 1, 1]
    cx, cy, dx, dy = control[k + 2, 0], control[k + 2, 1], control[k + 3, 0], control[k + 3, 1]
    turn_x = s * ((cx - bx) - (bx - ax)) + t * ((dx - cx) - (cx - bx))
    turn_y = s * ((cy - by) - (by - ay)) + t * ((dy - cy) - (cy - by))
    ax, ay, bx, by = s * ax + t * bx, s * ay + t * by, s * bx + t * cx, s * by + t * cy
    cx, cy = s * cx + t * dx, s * cy + t * dy
    ax, ay, bx, by = s * ax + t * bx, s * ay + t * by, s * bx + t * cx, s * by + t * cy
    x, y = s * ax + t * bx, s * ay + t * by
    return Jet(x, y, 3.0 * (bx - ax), 3.0 * (by - ay), 6.0 * turn_x, 6.0 * turn_y)


@inline
def jet(pieces, i, t):
    """The `Jet` of piece `i` at the local parameter `t` in [0, 1]."""
    start = pieces.first[i]
    n = pieces.first[i + 1] - start - 1
    if n == 3 and not pieces.rational[i]:
        return _cubic_jet(pieces.control, start, t)
    x, y, w, dx, dy, dw, ddx, ddy, ddw = 0.0, 0.0, 1.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0
    for column in range(
        3 if pieces.rational[i] else 2
    ):  # a loop, or three columns compile three times
        value, slope, bend = component(pieces.control, start, n, column, t)
        if column == 0:
            x, dx, ddx = value, slope, bend
        elif column == 1:
            y, dy, ddy = value, slope, bend
        else:
            w, dw, ddw = value, slope, bend
    if not pieces.rational[i]:
        return Jet(x, y, dx, dy, ddx, ddy)
    x, y = x / w, y / w
    dx, dy = (dx - x * dw) / w, (dy - y * dw) / w
    ddx = (ddx - 2.0 * dx * dw - x * ddw) / w
    ddy = (ddy - 2.0 * dy * dw - y * ddw) / w
    return Jet(x, y, dx, dy, ddx, ddy)


@inline
def keep_right(points, n, t):
    """Turns the n + 1 rows of `points` into the control points of their part [t, 1]."""
    for r in range(1, n + 1):
        for k in range(n + 1 - r):
            for c in range(3):
                points[k, c] += t * (points[k + 1, c] - points[k, c])


@inline
def keep_left(points, n, t):
    """Turns the n + 1 rows of `points` into the control points of their part [0, t]."""
    for r in range(1, n + 1):
        for k in range(n, r - 1, -1):
            for c in range(3):
                points[k, c] = points[k - 1, c] + t * (points[k, c] - points[k - 1, c])


@inline
def cut(pieces, i, t0, t1, out):
    """Writes the control points of piece `i` on [t0, t1] into `out` and returns the degree.

    The order of the two cuts keeps the second ratio's divisor at 1/2 or more.
    """
    start = pieces.first[i]
    n = pieces.first[i + 1] - start - 1
    for k in range(n + 1):
        for c in range(3):
            out[k, c] = pieces.control[start + k, c]
    if t1 >= 0.5:
        if t1 < 1.0:
            keep_left(out, n, t1)
        if t0 > 0.0:
            keep_right(out, n, t0 / t1)
    else:
        if t0 > 0.0:
            keep_right(out, n, t0)
        keep_left(out, n, (t1 - t0) / (1.0 - t0))
    return n


@kernel
def pieces_of_spline(control: Floats2, knots: Floats, degree: int) -> tuple[Floats2, Floats2]:
    """Bézier control points (n_spans (degree + 1), 3) and the span limits (n_spans, 2) of a B-spline.

    Each control point is the blossom of the spline at the span's two ends, found by de Boor's scheme.
    `control` (n, 3) is homogeneous, `knots` (n + degree + 1,) non-decreasing; empty spans are left out.
    Source: Ramshaw, Blossoming: a connect-the-dots approach to splines (1987), section 9.
    """
    n_spans = 0
    for k in range(degree, control.shape[0]):
        if knots[k + 1] > knots[k]:
            n_spans += 1
    out = np.empty((n_spans * (degree + 1), 3))
    limits = np.empty((n_spans, 2))
    work = np.empty((degree + 1, 3))
    span = 0
    for k in range(degree, control.shape[0]):
        low, high = knots[k], knots[k + 1]
        if not high > low:
            continue
        for j in range(degree + 1):
            for i in range(degree + 1):
                work[i] = control[k - degree + i]
            for r in range(1, degree + 1):
                u = high if r <= j else low
                for i in range(degree, r - 1, -1):
                    left, right = knots[k - degree + i], knots[k + 1 + i - r]
                    ratio = (u - left) / (right - left)
                    for c in range(3):
                        work[i, c] = (1.0 - ratio) * work[i - 1, c] + ratio * work[i, c]
            out[span * (degree + 1) + j] = work[degree]
        limits[span, 0], limits[span, 1] = low, high
        span += 1
    return out, limits


@kernel
def points_on(pieces: Pieces, which: Integers, local: Floats, out: Floats2):
    """Writes point, first and second derivative (n, 6) at the parameters `local` of the pieces `which`."""
    for k in range(which.shape[0]):
        here = jet(pieces, which[k], local[k])
        out[k, 0], out[k, 1], out[k, 2] = here.x, here.y, here.dx
        out[k, 3], out[k, 4], out[k, 5] = here.dy, here.ddx, here.ddy


@kernel
def control_box(control: Floats2) -> Floats:
    """The least box (x0, y0, x1, y1) around the Cartesian control points of homogeneous `control`."""
    box = np.empty(4)
    box[:2], box[2:] = np.inf, -np.inf
    for k in range(control.shape[0]):
        x, y = control[k, 0] / control[k, 2], control[k, 1] / control[k, 2]
        box[0], box[1] = min(box[0], x), min(box[1], y)
        box[2], box[3] = max(box[2], x), max(box[3], y)
    return box


@inline
def hypotenuse(x, y):
    """The length of (x, y), without the cost of guarding against overflow: sizes are checked before."""
    return math.sqrt(x * x + y * y)


@kernel
def piece_spans(rows: Floats2, first: Integers) -> tuple[Floats2, Floats2]:
    """Least and greatest of each column of `rows` within each piece: two arrays (n, 3)."""
    n = first.shape[0] - 1
    low, high = np.empty((n, 3)), np.empty((n, 3))
    for i in range(n):
        for c in range(3):
            low[i, c] = high[i, c] = rows[first[i], c]
            for k in range(first[i] + 1, first[i + 1]):
                low[i, c], high[i, c] = min(low[i, c], rows[k, c]), max(high[i, c], rows[k, c])
    return low, high


class Joints(NamedTuple):
    """How the pieces of a curve follow one another.

    Attributes:
        contour: (n,) the contour of each piece; the last piece of a contour joins its first.
        tangent, within: a joint is smooth where the points are at most `within` from one another, and the sine
            between the tangents is at most `tangent`.
    """

    contour: Integers
    tangent: float
    within: float


@inline
def is_rough(pieces, joints, i, side):
    """Whether piece `i` has at its start (side 0) or end (1) an end of its contour or a corner."""
    contour, step = joints.contour, 2 * side - 1
    other = i + step
    if not (0 <= other < contour.shape[0] and contour[other] == contour[i]):
        other = i  # the other end of the contour
        while 0 <= other - step < contour.shape[0] and contour[other - step] == contour[i]:
            other -= step
    before, after = (i, other) if side == 1 else (other, i)
    a, b = jet(pieces, before, 1.0), jet(pieces, after, 0.0)
    speeds = hypotenuse(a.dx, a.dy) * hypotenuse(b.dx, b.dy)
    meets = hypotenuse(a.x - b.x, a.y - b.y) <= joints.within
    smooth = abs(a.dx * b.dy - a.dy * b.dx) <= joints.tangent * speeds
    return not (meets and smooth and a.dx * b.dx + a.dy * b.dy > 0.0)


@kernel
def rough_joints(pieces: Pieces, joints: Joints) -> Flags2:
    """(n, 2) flags of the pieces' starts and ends that are ends of contours or corners."""
    flags = np.empty((joints.contour.shape[0], 2), np.bool_)
    for i in range(flags.shape[0]):
        for side in range(2):
            flags[i, side] = is_rough(pieces, joints, i, side)
    return flags

"""Compiled bounds of the distance of one interval of A to B, and the roots of the systems (11)-(13) in it.

Not for: which intervals are asked about, and in which order (`hausdorff.search`).
"""

import math

import numpy as np

from clearance.compile.jit import inline, kernel
from clearance.kernels.curve.arc import (
    EPS,
    RADIUS,
    X0,
    X1,
    Y0,
    Y1,
    arc_distance,
    arc_middle,
    segment_distance,
)
from clearance.kernels.curve.bernstein import gap_coefficients, greatest, reverse_rows
from clearance.kernels.curve.bezier import cut, hypotenuse, jet
from clearance.kernels.curve.nearest import nearest, slide_to_foot
from clearance.kernels.hausdorff.state import (
    AT_A,
    AT_B,
    DISTANCE,
    LOWER,
    PIECE_A,
    PIECE_B,
)

LONGEST_RUN = 2000


@inline
def consider(pa, pb, lb, i, t, shift_x, shift_y, hint, state, work):
    """The foot on B of A's point at (i, t); the best such point so far is kept in `state`."""
    here = jet(pa, i, t)
    foot = nearest(pb, lb, here.x + shift_x, here.y + shift_y, hint, np.inf, work)
    if foot.lower > state[LOWER] or state[PIECE_A] < 0.0:
        state[LOWER], state[DISTANCE] = foot.lower, foot.distance
        state[PIECE_A], state[AT_A] = i, t
        state[PIECE_B], state[AT_B] = foot.piece, foot.local
    return foot


@kernel
def slide_from(pa, pb, i, t, j, s, shift_x, shift_y):
    """The foot of A's point at (i, t) on piece `j` of B, followed from the parameter `s`: (s, distance)."""
    here = jet(pa, i, t)
    x, y = here.x + shift_x, here.y + shift_y
    s = slide_to_foot(pb, j, x, y, s, 0.0, 1.0)
    there = jet(pb, j, s)
    return s, hypotenuse(there.x - x, there.y - y)


@kernel
def common_normal(pa, pb, i, t, t0, t1, j, s, shift_x, shift_y):
    """A root (t, s) of system (12) near the given one, held to [t0, t1] and [0, 1]: Newton's method.

    Where the foot stands at an end of B's piece, s stays and the root is that of (11): the end's normal to A.
    """
    for _ in range(10):
        a, b = jet(pa, i, t), jet(pb, j, s)
        ex, ey = a.x + shift_x - b.x, a.y + shift_y - b.y
        f, g = ex * a.dx + ey * a.dy, ex * b.dx + ey * b.dy
        f_t = a.dx * a.dx + a.dy * a.dy + ex * a.ddx + ey * a.ddy
        cross = a.dx * b.dx + a.dy * b.dy
        g_s = ex * b.ddx + ey * b.ddy - b.dx * b.dx - b.dy * b.dy
        if (s == 0.0 and g <= 0.0) or (s == 1.0 and g >= 0.0):
            g, cross, g_s = 0.0, 0.0, 1.0
        determinant = f_t * g_s + cross * cross
        if determinant == 0.0:
            break
        dt = -(f * g_s + g * cross) / determinant
        ds = -(f_t * g - cross * f) / determinant
        moved, slid = min(t1, max(t0, t + dt)), min(1.0, max(0.0, s + ds))
        done = abs(moved - t) <= 1e-16 and abs(slid - s) <= 1e-16
        t, s = moved, slid
        if done:
            break
    return t, s


@kernel
def self_bisector(pa, pb, i, t_one, t_two, j, s, k, r, shift_x, shift_y):
    """Where A between two parameters is equally far from two branches of B: system (13), regula falsi.

    At `t_one` the branch (j, s) is the nearer, at `t_two` the branch (k, r). Feet are followed by Newton's
    method, so that the first two equations hold at every step.
    """
    _, d_one = slide_from(pa, pb, i, t_one, j, s, shift_x, shift_y)
    _, e_one = slide_from(pa, pb, i, t_one, k, r, shift_x, shift_y)
    s_two, d_two = slide_from(pa, pb, i, t_two, j, s, shift_x, shift_y)
    r_two, e_two = slide_from(pa, pb, i, t_two, k, r, shift_x, shift_y)
    low, high, f_low, f_high = t_one, t_two, d_one - e_one, d_two - e_two
    if not (f_low <= 0.0 and f_high >= 0.0) or f_low == f_high:
        return math.nan
    t, s, r, side = t_two, s_two, r_two, 0
    for _ in range(60):
        t = (low * f_high - high * f_low) / (f_high - f_low)
        s, d = slide_from(pa, pb, i, t, j, s, shift_x, shift_y)
        r, e = slide_from(pa, pb, i, t, k, r, shift_x, shift_y)
        f = d - e
        if abs(f) <= 1e-16 * (d + e) or abs(high - low) <= 2e-16:
            break
        if f > 0.0:
            high, f_high = t, f
            f_low *= 0.5 if side == 1 else 1.0
            side = 1
        else:
            low, f_low = t, f
            f_high *= 0.5 if side == -1 else 1.0
            side = -1
    return t


@inline
def upper_bound(pa, pb, i, t0, t1, j, s0, s1, shift_x, shift_y, work):
    """A proven upper bound of the distance of A on [t0, t1] to B, and where its square's bound is largest.

    The bound is that to B's part between `s0` and `s1`, run through side by side. Returns also the bound at
    t0 and t1 themselves.
    """
    p, q, gap, out = work[6], work[7], work[8], work[9]
    n = cut(pa, i, t0, t1, p)
    m = cut(pb, j, min(s0, s1), max(s0, s1), q)
    if s0 > s1:
        reverse_rows(q, m)
    rational = pa.rational[i] or pb.rational[j]
    degree = gap_coefficients(p, n, q, m, rational, shift_x, shift_y, gap, out)
    most, which = greatest(out, degree)
    return math.sqrt(most), which / degree


@inline
def chord_bound(pa, pb, i, t0, t1, j, s0, s1, shift_x, shift_y, work):
    """Another upper bound, which no speed along the curves disturbs: by way of the chord of B's part.

    Each point of the chord is square under a point of B's part, no farther than the part's control points
    are from the chord; A's control points bound its distance to the chord (convexity). Exact on lines.
    """
    p, q = work[6], work[7]
    n = cut(pa, i, t0, t1, p)
    m = cut(pb, j, min(s0, s1), max(s0, s1), q)
    x0, y0, x1, y1 = q[0, 0] / q[0, 2], q[0, 1] / q[0, 2], q[m, 0] / q[m, 2], q[m, 1] / q[m, 2]
    off, most = 0.0, 0.0
    for k in range(1, m):
        off = max(off, segment_distance(q[k, 0] / q[k, 2], q[k, 1] / q[k, 2], x0, y0, x1, y1))
    for k in range(n + 1):
        x, y = p[k, 0] / p[k, 2] + shift_x, p[k, 1] / p[k, 2] + shift_y
        most = max(most, segment_distance(x, y, x0, y0, x1, y1))
    return most + off


@inline
def line_covered(pa, i, t0, t1, lb, hint, shift_x, shift_y, lower):
    """Whether a straight part of A lies within `lower` of the arc that was nearest before: no search needed."""
    here, there = jet(pa, i, t0), jet(pa, i, t1)
    x, y = 0.5 * (here.x + there.x) + shift_x, 0.5 * (here.y + there.y) + shift_y
    half = 0.5 * hypotenuse(there.x - here.x, there.y - here.y)
    row = lb.arcs[hint]
    return half < lower and (arc_distance(row, x, y) + row[EPS] + half) * (1.0 + 1e-14) <= lower


@inline
def chain_bound(pa, i, t0, t1, leaves, first, last, off_first, off_last, shift_x, shift_y, enough):
    """An upper bound of the distance of a straight part of A to the run of B's arcs `first` to `last`.

    The run is connected, and so is its projection onto the line: it covers all between the feet of the
    part's two ends, which are `off_first` and `off_last` away. Every point between has a point of the run
    square above it, no farther than the run's farthest control point is from the line (convexity).
    """
    here, there = jet(pa, i, t0), jet(pa, i, t1)
    dx, dy = there.x - here.x, there.y - here.y
    length = hypotenuse(dx, dy)
    most = max(off_first, off_last)
    if length == 0.0 or most > enough or abs(first - last) > LONGEST_RUN:
        return np.inf
    dx, dy = dx / length, dy / length
    low, high = min(first, last), max(first, last)
    for k in range(low, high + 1):
        row = leaves.arcs[k]
        if k > low and (row[X0] != leaves.arcs[k - 1, X1] or row[Y0] != leaves.arcs[k - 1, Y1]):
            return np.inf
        x, y = row[X1] - here.x - shift_x, row[Y1] - here.y - shift_y
        off = abs(dx * y - dy * x)
        if k == low:
            off = max(
                off, abs(dx * (row[Y0] - here.y - shift_y) - dy * (row[X0] - here.x - shift_x))
            )
        if row[RADIUS] != 0.0:
            mx, my = arc_middle(row)
            off = max(off, abs(dx * (my - here.y - shift_y) - dy * (mx - here.x - shift_x)))
        most = max(most, off + row[EPS])
        if most > enough:
            break
    return most

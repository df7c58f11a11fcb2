"""Proofs by interval bounds that a system has no root in a cell, or one at most.

Boxes are (x0, x1, y0, y1), one for each order of derivative (`curve.interval.enclose`). Not for: finding roots
(`hausdorff.system_roots`).
"""

from typing import NamedTuple

from clearance.compile.decorators import inline
from clearance.kernels.curve.interval import dot, enclose, times

PIECE, S0, S1, OPEN = range(4)  # columns of a cell of B: its part, whether its normal is still open
JOINED = 1e-12  # ends of pieces this near follow one another


class Slopes(NamedTuple):
    """Intervals of the foot equation <A - B, B'>, and of its first two derivatives by B's parameter."""

    low: float
    high: float
    rise_low: float
    rise_high: float
    bend_low: float
    bend_high: float


@inline
def gap_box(a, b, curves, out):
    """The box of A - B from those of a part of each."""
    out[0], out[1] = a[0] + curves.shift_x - b[1], a[1] + curves.shift_x - b[0]
    out[2], out[3] = a[2] + curves.shift_y - b[3], a[3] + curves.shift_y - b[2]


@inline
def foot_slopes(gap, b):
    """The `Slopes` of a cell of B with the boxes `b`."""
    f0, f1 = dot(gap, b[1])
    g0, g1 = dot(gap, b[2])
    h0, h1 = dot(b[1], b[1])
    i0, i1 = dot(gap, b[3])
    j0, j1 = dot(b[1], b[2])
    return Slopes(f0, f1, g0 - h1, g1 - max(h0, 0.0), i0 - 3.0 * j1, i1 - 3.0 * j0)


@inline
def gap_sq(gap):
    """The squared length of the vectors in a box, an interval."""
    x = max(0.0, gap[0], -gap[1])
    y = max(0.0, gap[2], -gap[3])
    far_x, far_y = max(-gap[0], gap[1]), max(-gap[2], gap[3])
    return x * x + y * y, far_x * far_x + far_y * far_y


@inline
def normal_is_single(gap, a, b, is_point):
    """Whether <A - B(s(t)), A'> is strictly monotone, s following the foot or standing still."""
    p0, p1 = dot(gap, a[2])
    q0, q1 = dot(a[1], a[1])
    low, high = p0 + max(q0, 0.0), p1 + q1
    if is_point:
        return low > 0.0 or high < 0.0
    slopes = foot_slopes(gap, b)
    if not slopes.rise_high < 0.0:
        return False
    c0, c1 = dot(a[1], b[1])
    square0, square1 = times(c0, c1, c0, c1)
    if c0 * c1 > 0.0 or c0 == 0.0 or c1 == 0.0:
        square0 = min(c0 * c0, c1 * c1)
    else:
        square0 = 0.0
    # d/dt = <A', A'> + <A - B, A''> - <A', B'>^2 / -(g): g < 0 is the foot equation's derivative
    r0, r1 = square0 / -slopes.rise_low, square1 / -slopes.rise_high
    return low - r1 > 0.0 or high - r0 < 0.0


@inline
def _follows(pb, i, j, ends_b, smoothly):
    """Whether piece `j` of B starts where piece `i` ends (without a corner where `smoothly`)."""
    if smoothly and (ends_b[i, 1] or ends_b[j, 0]):
        return False
    end, start = pb.first[i + 1] - 1, pb.first[j]
    dx = pb.control[end, 0] / pb.control[end, 2] - pb.control[start, 0] / pb.control[start, 2]
    dy = pb.control[end, 1] / pb.control[end, 2] - pb.control[start, 1] / pb.control[start, 2]
    return abs(dx) + abs(dy) < JOINED


@inline
def _single_in(systems, j, s0, s1, a_box, points, scratch, rising_only):
    """Whether piece `j` on [s0, s1] has one nearest point at most to every point of A's part."""
    if s0 == s1:
        return True
    curves, union, gap = systems.pair.curves, scratch[:4], scratch[4]
    enclose(systems.b, j, s0, s1, points, union)
    gap_box(a_box[0], union[0], curves, gap)
    slopes = foot_slopes(gap, union)
    bends = slopes.bend_low > 0.0 or slopes.bend_high < 0.0
    return slopes.rise_high < 0.0 or (not rising_only and bends)


@inline
def same_foot(systems, one, two, a_box, points, scratch):
    """Whether the stretch of B from one cell to the other has provably one nearest point at most.

    Args:
        one, two: the rows of two cells; scratch: (5, 6).
    """
    i, j = int(one[PIECE]), int(two[PIECE])
    if i == j:
        low, high = min(one[S0], two[S0]), max(one[S1], two[S1])
        return _single_in(systems, j, low, high, a_box, points, scratch, False)
    for turn in range(2):
        x, y = (one, two) if turn == 0 else (two, one)
        i, j = int(x[PIECE]), int(y[PIECE])
        point = (x[S0] == x[S1] and x[S0] == 1.0) or (y[S0] == y[S1] and y[S0] == 0.0)
        if _follows(systems.pair.curves.b, i, j, systems.ends_b, not point):
            if _single_in(systems, i, x[S0], 1.0, a_box, points, scratch, True):
                if _single_in(systems, j, 0.0, y[S1], a_box, points, scratch, True):
                    return True
    return False

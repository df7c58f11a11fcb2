"""Compiled solution of the systems (11), (12), (13) on whole curves: the way without trimming.

Source: Elber, Grandine, Hausdorff and minimal distances between parametric freeforms (2008). Every interval
T of curve A carries the cells of B that may hold a foot of its points, found by excluding the rest with
interval bounds; both are halved until each system in T has provably no root or one, which is then found by
Newton's method. No distance excludes anything, which is what trimming is measured against. A cell without
length is an end or corner of B. At each root the distance to the whole of B is taken, so that a superfluous
root does no harm; a lost one would, and is excluded by the proofs named below.
"""

import math

import numpy as np

from clearance.jit import inlined, kernel
from clearance.kernels.curve_bezier import jet
from clearance.kernels.curve_interval import derived, dot, enclose, times
from clearance.kernels.curve_nearest import closest_on
from clearance.kernels.hausdorff import widest, witness
from clearance.kernels.hausdorff_exact import common_normal, consider
from clearance.kernels.hausdorff_state import (
    BISECTORS,
    CUTS,
    ENDS,
    GIVEN_UP,
    NORMALS,
    PIECE_A,
    UPPER,
)

DEEPEST = 34
MOST_CELLS = 4000


@inlined
def _gap_box(a, b, shift_x, shift_y, out):
    """The box of A - B from those of a part of each."""
    out[0], out[1] = a[0] + shift_x - b[1], a[1] + shift_x - b[0]
    out[2], out[3] = a[2] + shift_y - b[3], a[3] + shift_y - b[2]


@inlined
def _foot_slopes(gap, b):
    """Intervals of the foot equation <A - B, B'>, and of its first two derivatives by B's parameter."""
    f0, f1 = dot(gap, b[1])
    g0, g1 = dot(gap, b[2])
    h0, h1 = dot(b[1], b[1])
    i0, i1 = dot(gap, b[3])
    j0, j1 = dot(b[1], b[2])
    return f0, f1, g0 - h1, g1 - max(h0, 0.0), i0 - 3.0 * j1, i1 - 3.0 * j0


@inlined
def _gap_sq(gap):
    """The squared length of the vectors in a box, an interval."""
    x = max(0.0, gap[0], -gap[1])
    y = max(0.0, gap[2], -gap[3])
    far_x, far_y = max(-gap[0], gap[1]), max(-gap[2], gap[3])
    return x * x + y * y, far_x * far_x + far_y * far_y


@inlined
def _normal_is_single(gap, a, b, is_point):
    """Whether <A - B(s(t)), A'> is strictly monotone, s following the foot or standing still."""
    p0, p1 = dot(gap, a[2])
    q0, q1 = dot(a[1], a[1])
    low, high = p0 + max(q0, 0.0), p1 + q1
    if is_point:
        return low > 0.0 or high < 0.0
    _, _, g0, g1, _, _ = _foot_slopes(gap, b)
    if not g1 < 0.0:
        return False
    c0, c1 = dot(a[1], b[1])
    square0, square1 = times(c0, c1, c0, c1)
    if c0 * c1 > 0.0 or c0 == 0.0 or c1 == 0.0:
        square0 = min(c0 * c0, c1 * c1)
    else:
        square0 = 0.0
    # d/dt = <A', A'> + <A - B, A''> - <A', B'>^2 / -(g): g < 0 is the foot equation's derivative
    r0, r1 = square0 / -g0, square1 / -g1
    return low - r1 > 0.0 or high - r0 < 0.0


@inlined
def _follows(pb, i, j, ends_b, smoothly):
    """Whether piece `j` of B starts where piece `i` ends (without a corner where `smoothly`)."""
    if smoothly and (ends_b[i, 1] or ends_b[j, 0]):
        return False
    end, start = pb.first[i + 1] - 1, pb.first[j]
    dx = pb.control[end, 0] / pb.control[end, 2] - pb.control[start, 0] / pb.control[start, 2]
    dy = pb.control[end, 1] / pb.control[end, 2] - pb.control[start, 1] / pb.control[start, 2]
    return abs(dx) + abs(dy) < 1e-12


@inlined
def _single_in(pb, db, j, s0, s1, a_box, shift_x, shift_y, points, union, gap, rising_only):
    """Whether piece `j` on [s0, s1] has one nearest point at most to every point of A's part."""
    if s0 == s1:
        return True
    enclose(pb, db[0], db[1], db[2], j, s0, s1, points, union)
    _gap_box(a_box[0], union[0], shift_x, shift_y, gap)
    _, _, _, g1, h0, h1 = _foot_slopes(gap, union)
    return g1 < 0.0 or (not rising_only and (h0 > 0.0 or h1 < 0.0))


@inlined
def _same_foot(pb, db, one, two, ends_b, a_box, shift_x, shift_y, points, union, gap):
    """Whether the stretch of B from one cell to the other has provably one nearest point at most."""
    i, j = int(one[0]), int(two[0])
    if i == j:
        low, high = min(one[1], two[1]), max(one[2], two[2])
        return _single_in(pb, db, i, low, high, a_box, shift_x, shift_y, points, union, gap, False)
    for turn in range(2):
        x, y = (one, two) if turn == 0 else (two, one)
        i, j = int(x[0]), int(y[0])
        point = (x[1] == x[2] and x[1] == 1.0) or (y[1] == y[2] and y[1] == 0.0)
        if _follows(pb, i, j, ends_b, not point):
            if _single_in(
                pb, db, i, x[1], 1.0, a_box, shift_x, shift_y, points, union, gap, True
            ) and _single_in(
                pb, db, j, 0.0, y[2], a_box, shift_x, shift_y, points, union, gap, True
            ):
                return True
    return False


@kernel
def _solve_systems(
    pa, da, pb, lb, db, ends_b, i, shift_x, shift_y, budget, state, work, cells, boxes
):
    """Finds all candidates on piece `i` of A; see the module. `cells` (levels, most, 3) piece, s0, s1.

    Returns False where the budget or the depth ran out with systems unresolved.
    """
    a_box, gap, gap_two, union = np.empty((4, 4)), np.empty(4), np.empty(4), np.empty((4, 4))
    points = work[9]
    counts = np.zeros(DEEPEST + 2, np.int64)
    n_pieces = pb.first.shape[0] - 1
    n = 0
    for j in range(n_pieces):
        cells[0, n, 0], cells[0, n, 1], cells[0, n, 2] = j, 0.0, 1.0
        n += 1
        for side in range(2):
            if ends_b[j, side] and not (side == 0 and j > 0 and ends_b[j - 1, 1]):
                cells[0, n, 0], cells[0, n, 1], cells[0, n, 2] = j, side, side
                n += 1
            if n + 3 > cells.shape[1]:
                return False
    counts[0] = n
    stack = np.empty((2 * DEEPEST + 4, 3))
    stack[0, 0], stack[0, 1], stack[0, 2] = 0.0, 1.0, 1.0
    top = 1
    resolved = True
    d_low, d_high = np.empty(cells.shape[1]), np.empty(cells.shape[1])
    while top > 0:
        top -= 1
        t0, t1, level = stack[top, 0], stack[top, 1], int(stack[top, 2])
        state[CUTS] += 1.0
        enclose(pa, da[0], da[1], da[2], i, t0, t1, points, a_box)
        n = 0
        for k in range(counts[level - 1]):
            old = cells[level - 1, k]
            halves = 1 if old[1] == old[2] or level == 1 else 2
            for half in range(halves):
                s0, s1 = old[1], old[2]
                if halves == 2:
                    middle = 0.5 * (s0 + s1)
                    s0, s1 = (s0, middle) if half == 0 else (middle, s1)
                if n >= cells.shape[1]:
                    return False
                enclose(pb, db[0], db[1], db[2], int(old[0]), s0, s1, points, boxes[n])
                _gap_box(a_box[0], boxes[n, 0], shift_x, shift_y, gap)
                if s0 != s1:
                    f0, f1, g0, _, _, _ = _foot_slopes(gap, boxes[n])
                    # no foot, or only farthest points, in this cell
                    if f0 > 0.0 or f1 < 0.0 or g0 > 0.0:
                        continue
                d_low[n], d_high[n] = _gap_sq(gap)
                cells[level, n, 0], cells[level, n, 1], cells[level, n, 2] = old[0], s0, s1
                n += 1
        counts[level] = n
        open_here = False
        for k in range(n):
            _gap_box(a_box[0], boxes[k, 0], shift_x, shift_y, gap)
            low, high = dot(gap, a_box[1])
            if low > 0.0 or high < 0.0:
                continue
            cell = cells[level, k]
            if _normal_is_single(gap, a_box, boxes[k], cell[1] == cell[2]):
                _try_normal(pa, pb, lb, i, t0, t1, cell, shift_x, shift_y, state, work)
            else:
                open_here = True
        for k in range(n):
            for m in range(k):
                if d_low[k] > d_high[m] or d_low[m] > d_high[k]:
                    continue
                one, two = cells[level, m], cells[level, k]
                if _same_foot(
                    pb, db, one, two, ends_b, a_box, shift_x, shift_y, points, union, gap_two
                ):
                    continue
                for c in range(0, 4, 2):
                    gap_two[c] = boxes[k, 0, c] - boxes[m, 0, c + 1]
                    gap_two[c + 1] = boxes[k, 0, c + 1] - boxes[m, 0, c]
                low, high = dot(gap_two, a_box[1])
                if low > 0.0 or high < 0.0:  # the difference of both squares is monotone
                    _try_bisector(pa, pb, lb, i, t0, t1, one, two, shift_x, shift_y, state, work)
                else:
                    open_here = True
        if not open_here:
            continue
        if level >= DEEPEST or state[CUTS] > budget:
            state[GIVEN_UP] += 1.0
            resolved = False
            if state[CUTS] > budget:
                return False
            continue
        middle = 0.5 * (t0 + t1)
        stack[top, 0], stack[top, 1], stack[top, 2] = middle, t1, level + 1
        stack[top + 1, 0], stack[top + 1, 1], stack[top + 1, 2] = t0, middle, level + 1
        top += 2
    return resolved


@inlined
def _distance_to_cell(pa, pb, i, t, cell, shift_x, shift_y, work):
    """The distance of A's point to one cell of B, and where."""
    here = jet(pa, i, t)
    x, y = here.x + shift_x, here.y + shift_y
    d, _, s = closest_on(pb, int(cell[0]), cell[1], cell[2], x, y, np.inf, work)
    return d, s


@inlined
def _is_normal(pa, pb, i, t, j, s, shift_x, shift_y):
    """Whether both equations of (12) hold at (t, s) to rounding: the cosines with both tangents vanish."""
    a, b = jet(pa, i, t), jet(pb, j, s)
    ex, ey = a.x + shift_x - b.x, a.y + shift_y - b.y
    gap = ex * ex + ey * ey
    f, g = ex * a.dx + ey * a.dy, ex * b.dx + ey * b.dy
    fine = f * f <= 1e-20 * gap * (a.dx * a.dx + a.dy * a.dy)
    return fine and g * g <= 1e-20 * gap * (b.dx * b.dx + b.dy * b.dy)


@inlined
def _slope_at_foot(pa, pb, i, t, cell, shift_x, shift_y, work):
    """The slope of half the squared distance along A at `t`, from A's foot in one cell of B."""
    _, s = _distance_to_cell(pa, pb, i, t, cell, shift_x, shift_y, work)
    a, b = jet(pa, i, t), jet(pb, int(cell[0]), s)
    return (a.x + shift_x - b.x) * a.dx + (a.y + shift_y - b.y) * a.dy


@kernel
def _bisected_normal(pa, pb, i, t0, t1, cell, shift_x, shift_y, work):
    """The parameter in [t0, t1] where `_slope_at_foot` changes its sign; nan where it does not: no root."""
    low, high = t0, t1
    at_low = _slope_at_foot(pa, pb, i, low, cell, shift_x, shift_y, work)
    if at_low * _slope_at_foot(pa, pb, i, high, cell, shift_x, shift_y, work) > 0.0:
        return math.nan
    for _ in range(60):
        t = 0.5 * (low + high)
        if high - low < 2e-16:
            break
        if at_low * _slope_at_foot(pa, pb, i, t, cell, shift_x, shift_y, work) > 0.0:
            low = t
        else:
            high = t
    return 0.5 * (low + high)


@kernel
def _try_normal(pa, pb, lb, i, t0, t1, cell, shift_x, shift_y, state, work):
    """System (12), or (11) against an end of B: the one root in T, by Newton's method from its middle.

    The system's determinant has one sign over T and the cell, so that there is one root at most. Newton's
    result counts only with a residual of zero inside T and the cell; else the sign of the slope along the
    foot, monotone here, says whether a root exists, and bisection finds it.
    """
    state[NORMALS if cell[1] != cell[2] else ENDS] += 1.0
    t, j = 0.5 * (t0 + t1), int(cell[0])
    if cell[1] != cell[2]:
        s = 0.5 * (cell[1] + cell[2])
        t, s = common_normal(pa, pb, i, t, t0, t1, j, s, shift_x, shift_y)
        if not _is_normal(pa, pb, i, t, j, s, shift_x, shift_y) or not cell[1] <= s <= cell[2]:
            t = _bisected_normal(pa, pb, i, t0, t1, cell, shift_x, shift_y, work)
            if math.isnan(t):
                return
    else:
        end = jet(pb, j, cell[1])
        low, high = t0, t1
        for _ in range(60):
            t = 0.5 * (low + high)
            if high - low < 2e-16:
                break
            if (
                _slope_to(pa, i, t0, end, shift_x, shift_y)
                * _slope_to(pa, i, t, end, shift_x, shift_y)
                > 0.0
            ):
                low = t
            else:
                high = t
    consider(pa, pb, lb, i, t, shift_x, shift_y, 0, state, work)


@inlined
def _slope_to(pa, i, t, end, shift_x, shift_y):
    here = jet(pa, i, t)
    return (here.x + shift_x - end.x) * here.dx + (here.y + shift_y - end.y) * here.dy


@kernel
def _try_bisector(pa, pb, lb, i, t0, t1, one, two, shift_x, shift_y, state, work):
    """System (13): the one point of T that is equally far from two cells, if there is one (regula falsi)."""
    state[BISECTORS] += 1.0
    low, high = t0, t1
    d, _ = _distance_to_cell(pa, pb, i, low, one, shift_x, shift_y, work)
    e, _ = _distance_to_cell(pa, pb, i, low, two, shift_x, shift_y, work)
    f_low = d - e
    d, _ = _distance_to_cell(pa, pb, i, high, one, shift_x, shift_y, work)
    e, _ = _distance_to_cell(pa, pb, i, high, two, shift_x, shift_y, work)
    f_high = d - e
    if f_low * f_high > 0.0 or f_low == f_high:
        return
    side, t = 0, low
    for _ in range(60):
        t = (low * f_high - high * f_low) / (f_high - f_low)
        d, _ = _distance_to_cell(pa, pb, i, t, one, shift_x, shift_y, work)
        e, _ = _distance_to_cell(pa, pb, i, t, two, shift_x, shift_y, work)
        f = d - e
        if abs(f) <= 1e-16 * (d + e) or high - low <= 2e-16:
            break
        if f * f_high > 0.0:
            high, f_high = t, f
            f_low *= 0.5 if side == 1 else 1.0
            side = 1
        else:
            low, f_low = t, f
            f_high *= 0.5 if side == -1 else 1.0
            side = -1
    consider(pa, pb, lb, i, t, shift_x, shift_y, 0, state, work)


@kernel
def solve_directed(pa, ends_a, pb, lb, ends_b, shift_x, shift_y, budget, state, points):
    """Fills `state` and the witness `points` with the directed distance; returns whether all was resolved."""
    state[:] = 0.0
    state[PIECE_A] = -1.0
    rows = max(96, 4 * max(widest(pa), widest(pb)) + 4)
    work = np.empty((11, rows, 4))
    first = derived(pa)
    second = derived(first)
    da = (first, second, derived(second))
    first = derived(pb)
    second = derived(first)
    db = (first, second, derived(second))
    most = MOST_CELLS
    cells, boxes = np.empty((DEEPEST + 2, most, 3)), np.empty((most, 4, 4))
    resolved = True
    for i in range(pa.first.shape[0] - 1):
        for side in range(2):
            state[ENDS] += ends_a[i, side]
            consider(pa, pb, lb, i, float(side), shift_x, shift_y, 0, state, work)
        if not _solve_systems(
            pa, da, pb, lb, db, ends_b, i, shift_x, shift_y, budget, state, work, cells, boxes
        ):
            resolved = False
    state[UPPER] = state[1] if not math.isnan(state[1]) else np.inf
    witness(pa, ends_a, pb, ends_b, shift_x, shift_y, state, points)
    return resolved

"""Compiled solution of the systems (11), (12), (13): the multivariate solver of the paper, with proofs.

Source: Elber, Grandine, Hausdorff and minimal distances between parametric freeforms (2008). Every interval
T of curve A carries the cells of B that may hold a foot of its points, found by excluding the rest with
interval bounds; both are halved until each system in T has provably no root or one, which is then found by
Newton's method. A system that is settled on T is not asked again on T's halves; two feet in one cell are a
system of their own. No distance excludes anything, which is what trimming is measured against. A cell
without length is an end or corner of B. At each root the distance to the whole of B is taken, so that a
superfluous root does no harm; a lost one would, and is excluded by the proofs named below.
"""

import numpy as np

from clearance.compile.jit import inline, kernel
from clearance.kernels.curve.bezier import cut, hypotenuse, jet
from clearance.kernels.curve.interval import derived, dot, enclose, times
from clearance.kernels.hausdorff.both_directions import widest, witness
from clearance.kernels.hausdorff.exact import consider, slide_from, upper_bound
from clearance.kernels.hausdorff.state import (
    CUTS,
    DISTANCE,
    ENDS,
    GIVEN_UP,
    PIECE_A,
    ROOT,
    UPPER,
)
from clearance.kernels.hausdorff.system_roots import (
    keep_root,
    try_bisector,
    try_normal,
)

DEEPEST = 34
MOST_CELLS, MOST_PAIRS = 4000, 40_000
A_ROOT = 40.0  # what finding a root costs beside excluding a cell
PIECE, S0, S1, OPEN = 0, 1, 2, 3


@inline
def _gap_box(a, b, shift_x, shift_y, out):
    """The box of A - B from those of a part of each."""
    out[0], out[1] = a[0] + shift_x - b[1], a[1] + shift_x - b[0]
    out[2], out[3] = a[2] + shift_y - b[3], a[3] + shift_y - b[2]


@inline
def _foot_slopes(gap, b):
    """Intervals of the foot equation <A - B, B'>, and of its first two derivatives by B's parameter."""
    f0, f1 = dot(gap, b[1])
    g0, g1 = dot(gap, b[2])
    h0, h1 = dot(b[1], b[1])
    i0, i1 = dot(gap, b[3])
    j0, j1 = dot(b[1], b[2])
    return f0, f1, g0 - h1, g1 - max(h0, 0.0), i0 - 3.0 * j1, i1 - 3.0 * j0


@inline
def _gap_sq(gap):
    """The squared length of the vectors in a box, an interval."""
    x = max(0.0, gap[0], -gap[1])
    y = max(0.0, gap[2], -gap[3])
    far_x, far_y = max(-gap[0], gap[1]), max(-gap[2], gap[3])
    return x * x + y * y, far_x * far_x + far_y * far_y


@inline
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


@inline
def _follows(pb, i, j, ends_b, smoothly):
    """Whether piece `j` of B starts where piece `i` ends (without a corner where `smoothly`)."""
    if smoothly and (ends_b[i, 1] or ends_b[j, 0]):
        return False
    end, start = pb.first[i + 1] - 1, pb.first[j]
    dx = pb.control[end, 0] / pb.control[end, 2] - pb.control[start, 0] / pb.control[start, 2]
    dy = pb.control[end, 1] / pb.control[end, 2] - pb.control[start, 1] / pb.control[start, 2]
    return abs(dx) + abs(dy) < 1e-12


@inline
def _single_in(pb, db, j, s0, s1, a_box, shift_x, shift_y, points, union, gap, rising_only):
    """Whether piece `j` on [s0, s1] has one nearest point at most to every point of A's part."""
    if s0 == s1:
        return True
    enclose(pb, db[0], db[1], db[2], j, s0, s1, points, union)
    _gap_box(a_box[0], union[0], shift_x, shift_y, gap)
    _, _, _, g1, h0, h1 = _foot_slopes(gap, union)
    return g1 < 0.0 or (not rising_only and (h0 > 0.0 or h1 < 0.0))


@inline
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


@inline
def _first_cells(b_parts, ends_b, cells):
    """The parts of B and its ends and corners as cells; returns their number, 0 where they are too many."""
    n = 0
    for k in range(b_parts.shape[0]):
        j = int(b_parts[k, 0])
        if n + 3 > cells.shape[0]:
            return 0
        cells[n, PIECE], cells[n, S0], cells[n, S1], cells[n, OPEN] = (
            j,
            b_parts[k, 1],
            b_parts[k, 2],
            1.0,
        )
        n += 1
        for side in range(2):
            shared = side == 0 and j > 0 and ends_b[j - 1, 1]
            if ends_b[j, side] and not shared and b_parts[k, 1 + side] == side:
                cells[n, PIECE], cells[n, S0], cells[n, S1], cells[n, OPEN] = j, side, side, 1.0
                n += 1
    return n


@inline
def _child_cells(
    pb, db, old, n_old, split, a_box, shift_x, shift_y, points, new, boxes, child, ranges, gap
):
    """Halves of the `n_old` cells that may hold a foot; `child` (n, 2) says where they are, -1 where none is.

    `ranges` (n, 2) are the squared distances they may have. Returns their number, -1 where there are too many.
    """
    n = 0
    for k in range(n_old):
        child[k, 0], child[k, 1] = -1, -1
        for half in range(2 if split and old[k, S0] != old[k, S1] else 1):
            s0, s1 = old[k, S0], old[k, S1]
            if split and s0 != s1:
                middle = 0.5 * (s0 + s1)
                s0, s1 = (s0, middle) if half == 0 else (middle, s1)
            if n >= new.shape[0]:
                return -1
            enclose(pb, db[0], db[1], db[2], int(old[k, PIECE]), s0, s1, points, boxes[n])
            _gap_box(a_box[0], boxes[n, 0], shift_x, shift_y, gap)
            if s0 != s1:
                f0, f1, g0, _, _, _ = _foot_slopes(gap, boxes[n])
                # no foot, or only farthest points, in this cell
                if f0 > 0.0 or f1 < 0.0 or g0 > 0.0:
                    continue
            ranges[n, 0], ranges[n, 1] = _gap_sq(gap)
            new[n, PIECE], new[n, S0], new[n, S1], new[n, OPEN] = (
                old[k, PIECE],
                s0,
                s1,
                old[k, OPEN],
            )
            child[k, half] = n
            n += 1
    return n


@inline
def _left_out(cells, n, pairs, n_pairs, boxes):
    """Takes out the cells that no open system needs; returns how many stay."""
    needed = np.zeros(n, np.int64)
    for k in range(n):
        needed[k] = cells[k, OPEN] != 0.0
    for p in range(n_pairs):
        needed[pairs[p, 0]], needed[pairs[p, 1]] = 1, 1
    used = 0
    for k in range(n):
        if needed[k]:
            cells[used] = cells[k]
            needed[k] = used
            used += 1
    for p in range(n_pairs):
        pairs[p, 0], pairs[p, 1] = needed[pairs[p, 0]], needed[pairs[p, 1]]
    return used


@kernel
def _leave(pa, pb, lb, i, t0, t1, shift_x, shift_y, state, work):
    """Bounds an interval whose systems stay open: by its middle and extent, or side by side with B."""
    t = 0.5 * (t0 + t1)
    foot = consider(pa, pb, lb, i, t, shift_x, shift_y, 0, state, work)
    s0, _ = slide_from(pa, pb, i, t0, foot.piece, foot.local, shift_x, shift_y)
    s1, _ = slide_from(pa, pb, i, t1, foot.piece, foot.local, shift_x, shift_y)
    bound, _ = upper_bound(pa, pb, i, t0, t1, foot.piece, s0, s1, shift_x, shift_y, work)
    here, far, points = jet(pa, i, t), 0.0, work[6]
    for k in range(cut(pa, i, t0, t1, points) + 1):
        x, y = points[k, 0] / points[k, 2], points[k, 1] / points[k, 2]
        far = max(far, hypotenuse(x - here.x, y - here.y))
    state[UPPER] = max(state[UPPER], min(bound, foot.distance + far))
    state[GIVEN_UP] += 1.0


@kernel
def _pair_is_settled(
    pa,
    pb,
    lb,
    db,
    ends_b,
    i,
    t0,
    t1,
    one,
    two,
    boxes_one,
    boxes_two,
    a_box,
    shift_x,
    shift_y,
    room,
    state,
    work,
):
    """Whether system (13) for two cells has no root in T, or one, which is then found; and what that cost.

    The same cell twice stands for two feet in it.
    """
    points, union, gap = work[9], room[:4], room[4]
    if _same_foot(pb, db, one, two, ends_b, a_box, shift_x, shift_y, points, union, gap):
        return True, 0.0
    if one[PIECE] == two[PIECE] and one[S0] == two[S0] and one[S1] == two[S1]:
        return False, 0.0
    for c in range(0, 4, 2):
        gap[c] = boxes_two[0, c] - boxes_one[0, c + 1]
        gap[c + 1] = boxes_two[0, c + 1] - boxes_one[0, c]
    low, high = dot(gap, a_box[1])
    if low > 0.0 or high < 0.0:  # the difference of both squares is monotone
        try_bisector(pa, pb, lb, i, t0, t1, one, two, shift_x, shift_y, state, work)
        return True, A_ROOT
    return False, 0.0


@kernel
def _solve_systems(
    pa,
    da,
    pb,
    lb,
    db,
    ends_b,
    b_parts,
    part,
    shift_x,
    shift_y,
    budget,
    state,
    work,
    cells,
    pairs,
    boxes,
):
    """Finds all candidates on one part (piece, t0, t1) of A; see the module.

    `cells` (levels, most, 4) piece, s0, s1, whether its normal is open; `pairs` (levels, most, 2) of cells whose
    bisector is open. What the budget, the depth or the room leaves open is bounded.
    """
    i, points = int(part[0]), work[9]
    a_box, gap, room = np.empty((4, 4)), np.empty(4), np.empty((5, 4))
    n_cells, n_pairs = np.zeros(DEEPEST + 2, np.int64), np.zeros(DEEPEST + 2, np.int64)
    child, ranges = np.empty((cells.shape[1], 2), np.int64), np.empty((cells.shape[1], 2))
    n = _first_cells(b_parts, ends_b, cells[0])
    n_cells[0] = n
    for k in range(n):
        for m in range(k + 1):
            if n_pairs[0] < pairs.shape[1]:
                pairs[0, n_pairs[0], 0], pairs[0, n_pairs[0], 1] = k, m
                n_pairs[0] += 1
    too_many = n == 0 or n * (n + 1) // 2 > pairs.shape[1]
    stack = np.empty((2 * DEEPEST + 4, 3))
    stack[0, 0], stack[0, 1], stack[0, 2] = part[1], part[2], 1.0
    top, spent = 1, 0.0
    while top > 0:
        top -= 1
        t0, t1, level = stack[top, 0], stack[top, 1], int(stack[top, 2])
        state[CUTS] += 1.0
        if too_many or spent > budget:
            _leave(pa, pb, lb, i, t0, t1, shift_x, shift_y, state, work)
            continue
        enclose(pa, da[0], da[1], da[2], i, t0, t1, points, a_box)
        old, new, open_pairs = cells[level - 1], cells[level], pairs[level]
        n = _child_cells(
            pb, db, old, n_cells[level - 1], level > 1, a_box, shift_x, shift_y, points, new, boxes, child,
            ranges, gap,
        )  # fmt: skip
        spent += 2.0 * n_cells[level - 1]
        for k in range(n):
            if new[k, OPEN] == 0.0:
                continue
            _gap_box(a_box[0], boxes[k, 0], shift_x, shift_y, gap)
            low, high = dot(gap, a_box[1])
            new[k, OPEN] = 0.0
            if low > 0.0 or high < 0.0:
                continue
            if _normal_is_single(gap, a_box, boxes[k], new[k, S0] == new[k, S1]):
                try_normal(pa, pb, lb, i, t0, t1, new[k], shift_x, shift_y, state, work)
                spent += A_ROOT
            else:
                new[k, OPEN] = 1.0
        n_open, fits = 0, n >= 0
        for p in range(n_pairs[level - 1] if fits else 0):
            one, two = pairs[level - 1, p, 0], pairs[level - 1, p, 1]
            for half in range(4):
                k, m = child[one, half // 2], child[two, half % 2]
                if k < 0 or m < 0 or (one == two and half == 1):
                    continue
                if ranges[k, 0] > ranges[m, 1] or ranges[m, 0] > ranges[k, 1]:
                    continue
                settled, cost = _pair_is_settled(
                    pa, pb, lb, db, ends_b, i, t0, t1, new[m], new[k], boxes[m], boxes[k], a_box, shift_x,
                    shift_y, room, state, work,
                )  # fmt: skip
                spent += 1.0 + cost
                if not settled and n_open < pairs.shape[1]:
                    open_pairs[n_open, 0], open_pairs[n_open, 1] = k, m
                    n_open += 1
                elif not settled:
                    fits = False
        if not fits or level >= DEEPEST:
            n = _left_out(new, max(n, 0), open_pairs, n_open, boxes)
            if not fits or n > 0:
                _leave(pa, pb, lb, i, t0, t1, shift_x, shift_y, state, work)
            continue
        n_cells[level], n_pairs[level] = _left_out(new, n, open_pairs, n_open, boxes), n_open
        if n_cells[level] == 0:
            continue
        middle = 0.5 * (t0 + t1)
        stack[top, 0], stack[top, 1], stack[top, 2] = middle, t1, level + 1
        stack[top + 1, 0], stack[top + 1, 1], stack[top + 1, 2] = t0, middle, level + 1
        top += 2


@kernel
def solve_directed(pa, ends_a, a_parts, pb, lb, ends_b, b_parts, shift_x, shift_y, budget, state):
    """Raises `state` to the directed distance of the parts (n, 3) piece, t0, t1 of A, feet on those of B.

    `UPPER` bounds the distance of the parts of A to B, `ROOT` is the greatest distance of any root.
    """
    rows = max(98, 4 * max(widest(pa), widest(pb)) + 4)
    work = np.empty((11, rows, 4))
    first = derived(pa)
    second = derived(first)
    da = (first, second, derived(second))
    first = derived(pb)
    second = derived(first)
    db = (first, second, derived(second))
    cells, boxes = np.empty((DEEPEST + 2, MOST_CELLS, 4)), np.empty((MOST_CELLS, 4, 4))
    pairs = np.empty((DEEPEST + 2, MOST_PAIRS, 2), np.int64)
    for k in range(a_parts.shape[0]):
        i = int(a_parts[k, 0])
        for side in range(2):
            if ends_a[i, side] and a_parts[k, 1 + side] == side:
                state[ENDS] += 1.0
                foot = consider(pa, pb, lb, i, float(side), shift_x, shift_y, 0, state, work)
                if foot.distance > state[ROOT]:
                    keep_root(foot.distance, i, float(side), foot.piece, foot.local, state)
        _solve_systems(
            pa, da, pb, lb, db, ends_b, b_parts, a_parts[k], shift_x, shift_y, budget / a_parts.shape[0],
            state, work, cells, pairs, boxes,
        )  # fmt: skip
    if state[PIECE_A] < 0.0:  # nothing to solve, and no end: any point for a witness
        consider(pa, pb, lb, 0, 0.5, shift_x, shift_y, 0, state, work)
    state[UPPER] = max(state[UPPER], state[DISTANCE])


@kernel
def witness_of(pa, ends_a, pb, ends_b, shift_x, shift_y, state):
    """The points (5,) that `state` names, as `witness` gives them."""
    points = np.empty(5)
    witness(pa, ends_a, pb, ends_b, shift_x, shift_y, state, points)
    return points

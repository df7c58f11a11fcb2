"""Compiled Hausdorff distance of polylines: no biarcs and no map, segments straight from the control points.

The distance to one segment is convex, so that a part of A is no farther from B than the farther of its two
ends is from any one segment of B. Runs of A that one segment covers within the lower bound are passed over;
any other part is cut where the segments nearest to its two ends are equally far, until that bound, or that
of the connected run between them, is the distance itself. Not for: anything curved (`hausdorff`).
Source: Taha, Hanbury (2015) for the early break; Alt, Behrends, Blömer (1995) for the bisectors of segments.
"""

import math

import numpy as np

from clearance.compile.jit import inline, kernel
from clearance.kernels.hausdorff.state import (
    ARCS,
    AT_A,
    AT_B,
    BISECTORS,
    CUTS,
    DISTANCE,
    ENDS,
    GIVEN_UP,
    KEPT,
    LOWER,
    PIECE_A,
    PIECE_B,
    UPPER,
)

BUCKET = 8  # segments in a box
SEEDS = 512
STACK = 256
LONGEST_RUN = 2000


@kernel
def segment_boxes(control):
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
    for node in range(size - 1, 0, -1):
        for c in range(2):
            boxes[node, c] = min(boxes[2 * node, c], boxes[2 * node + 1, c])
            boxes[node, c + 2] = max(boxes[2 * node, c + 2], boxes[2 * node + 1, c + 2])
    return boxes


@inline
def _foot(control, k, x, y):
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
def _off(control, k, x, y):
    """The distance from (x, y) to segment `k`."""
    return math.sqrt(_foot(control, k, x, y)[0])


@inline
def _box_sq(boxes, node, x, y):
    dx = max(boxes[node, 0] - x, 0.0, x - boxes[node, 2])
    dy = max(boxes[node, 1] - y, 0.0, y - boxes[node, 3])
    return dx * dx + dy * dy


@kernel
def nearest_segment(control, boxes, x, y, hint, nodes, gaps):
    """The distance from (x, y) to the nearest segment, and its index; `hint` is tried first."""
    n, size = control.shape[0] // 2, boxes.shape[0] // 2
    best, which = _foot(control, hint, x, y)[0], hint
    nodes[0], gaps[0], top = 1, 0.0, 1
    while top > 0:
        top -= 1
        node = nodes[top]
        if gaps[top] >= best:
            continue
        if node >= size:
            first = (node - size) * BUCKET
            for k in range(first, min(n, first + BUCKET)):
                square = _foot(control, k, x, y)[0]
                if square < best:
                    best, which = square, k
            continue
        a, b = _box_sq(boxes, 2 * node, x, y), _box_sq(boxes, 2 * node + 1, x, y)
        nearer = 2 * node if a <= b else 2 * node + 1
        nodes[top], gaps[top] = 4 * node + 1 - nearer, max(a, b)
        nodes[top + 1], gaps[top + 1] = nearer, min(a, b)
        top += 2
    return math.sqrt(best), which


@inline
def _at(control, k, t):
    """The point of segment `k` at the local parameter `t`."""
    s = 1.0 - t
    return (
        s * control[2 * k, 0] + t * control[2 * k + 1, 0],
        s * control[2 * k, 1] + t * control[2 * k + 1, 1],
    )


@inline
def _offer(qc, i, t, j, x, y, distance, state):
    """Raises the lower bound by the true distance of one point of A."""
    if distance > state[LOWER] or state[PIECE_A] < 0.0:
        state[LOWER] = state[DISTANCE] = distance
        state[PIECE_A], state[AT_A] = i, t
        state[PIECE_B], state[AT_B] = j, _foot(qc, j, x, y)[1]


@inline
def _crossing(pc, qc, i, t0, t1, j, k, shift_x, shift_y):
    """Where segment `i` of A is equally far from `j`, the nearer at t0, and `k`: system (13), regula falsi.

    Returns the parameter and the greater of both distances there.
    """
    x, y = _at(pc, i, t0)
    f_low = _off(qc, j, x + shift_x, y + shift_y) - _off(qc, k, x + shift_x, y + shift_y)
    x, y = _at(pc, i, t1)
    f_high = _off(qc, j, x + shift_x, y + shift_y) - _off(qc, k, x + shift_x, y + shift_y)
    low, high, side, t, most = t0, t1, 0, 0.5 * (t0 + t1), np.inf
    for _ in range(60):
        t = (low * f_high - high * f_low) / (f_high - f_low) if f_high > f_low else 0.5 * (t0 + t1)
        x, y = _at(pc, i, t)
        d, e = _off(qc, j, x + shift_x, y + shift_y), _off(qc, k, x + shift_x, y + shift_y)
        f, most = d - e, max(d, e)
        if abs(f) <= 1e-15 * most or high - low <= 2e-16 or not f_high > f_low:
            break
        if f > 0.0:
            high, f_high = t, f
            f_low *= 0.5 if side == 1 else 1.0
            side = 1
        else:
            low, f_low = t, f
            f_high *= 0.5 if side == -1 else 1.0
            side = -1
    return t, most


@inline
def _run_bound(pc, i, t0, t1, d0, d1, qc, first, last, shift_x, shift_y, enough):
    """An upper bound of the distance of a part of segment `i` to the run of B's segments first to last.

    The run is connected, and so is its projection onto the line of A: it covers all between the feet of the
    part's two ends, which are d0 and d1 away. Every point between has a point of the run square above it, no
    farther than the run's farthest vertex is from the line. Gives up (inf) past `enough`.
    """
    x0, y0 = _at(pc, i, t0)
    x1, y1 = _at(pc, i, t1)
    dx, dy = x1 - x0, y1 - y0
    length = math.sqrt(dx * dx + dy * dy)
    low, high = min(first, last), max(first, last)
    if length == 0.0 or high - low > LONGEST_RUN or max(d0, d1) > enough:
        return np.inf
    dx, dy = dx / length, dy / length
    x0, y0, most = x0 + shift_x, y0 + shift_y, max(d0, d1)
    for r in range(2 * low, 2 * high + 2):
        if r > 2 * low and r % 2 == 0 and (qc[r, 0] != qc[r - 1, 0] or qc[r, 1] != qc[r - 1, 1]):
            return np.inf
        most = max(most, abs(dx * (qc[r, 1] - y0) - dy * (qc[r, 0] - x0)))
        if most > enough:
            return np.inf
    return most


@inline
def _box_covered(boxes, node, qc, k, shift_x, shift_y, reach_sq):
    """Whether a box lies within reach of segment `k`: its four corners decide, what is in reach is convex."""
    for corner in range(4):
        x = boxes[node, 2 * (corner & 1)] + shift_x
        y = boxes[node, 1 + (corner & 2)] + shift_y
        if not _foot(qc, k, x, y)[0] <= reach_sq:
            return False
    return True


@inline
def _covering(pc, i, qc, hint, shift_x, shift_y, reach_sq):
    """The segment of B within whose reach segment `i` of A lies: the hint, the next, the one before; else -1."""
    x0, y0 = pc[2 * i, 0] + shift_x, pc[2 * i, 1] + shift_y
    x1, y1 = pc[2 * i + 1, 0] + shift_x, pc[2 * i + 1, 1] + shift_y
    for step in (0, 1, -1):
        k = hint + step
        if 0 <= k < qc.shape[0] // 2 and _foot(qc, k, x1, y1)[0] <= reach_sq:
            if _foot(qc, k, x0, y0)[0] <= reach_sq:
                return k
    return -1


@kernel
def _solve_segment(pc, i, qc, boxes, hint, shift_x, shift_y, aim, state, stack, work):
    """Raises the lower bound to the greatest distance of segment `i` of A to B, proven; returns a hint.

    Rows of `stack` (STACK, 6) are parameter, nearest segment and distance at both ends of a part.
    """
    nodes, gaps = work
    stack[0, 0], stack[0, 3] = 0.0, 1.0
    for c in (0, 3):
        x, y = _at(pc, i, stack[0, c])
        d, hint = nearest_segment(qc, boxes, x + shift_x, y + shift_y, hint, nodes, gaps)
        _offer(qc, i, stack[0, c], hint, x + shift_x, y + shift_y, d, state)
        stack[0, c + 1], stack[0, c + 2] = hint, d
    state[ENDS] += 2.0
    top = 1
    while top > 0 and state[LOWER] <= aim.limit:
        top -= 1
        t0, j, d0 = stack[top, 0], int(stack[top, 1]), stack[top, 2]
        t1, k, d1 = stack[top, 3], int(stack[top, 4]), stack[top, 5]
        enough = max(state[LOWER] + aim.gap, aim.enough)
        state[CUTS] += 1.0
        if j == k:  # one segment: the distance is convex between two points already offered
            continue
        x, y = _at(pc, i, t1)
        bound = max(d0, _off(qc, j, x + shift_x, y + shift_y))
        x, y = _at(pc, i, t0)
        bound = min(bound, max(d1, _off(qc, k, x + shift_x, y + shift_y)))
        if bound > enough:
            bound = min(
                bound, _run_bound(pc, i, t0, t1, d0, d1, qc, j, k, shift_x, shift_y, enough)
            )
        t = 0.5 * (t0 + t1)
        if bound > enough:
            t, most = _crossing(pc, qc, i, t0, t1, j, k, shift_x, shift_y)
            state[BISECTORS] += 1.0
            bound = min(bound, max(most, d0, d1))
        if bound <= enough:
            state[UPPER] = max(state[UPPER], bound)
            continue
        if not t0 < t < t1:
            t = 0.5 * (t0 + t1)
        x, y = _at(pc, i, t)
        d, m = nearest_segment(qc, boxes, x + shift_x, y + shift_y, j, nodes, gaps)
        _offer(qc, i, t, m, x + shift_x, y + shift_y, d, state)
        done = bound <= max(state[LOWER] + aim.gap, aim.enough)
        if done or state[CUTS] > aim.budget or top + 2 > STACK or not t0 < t < t1:
            state[GIVEN_UP] += not done
            state[UPPER] = max(state[UPPER], bound)
            continue
        stack[top, 0], stack[top, 1], stack[top, 2] = t, m, d
        stack[top, 3], stack[top, 4], stack[top, 5] = t1, k, d1
        stack[top + 1, 0], stack[top + 1, 1], stack[top + 1, 2] = t0, j, d0
        stack[top + 1, 3], stack[top + 1, 4], stack[top + 1, 5] = t, m, d
        top += 2
    return hint


@kernel
def directed_polyline(pc, p_boxes, qc, q_boxes, shift_x, shift_y, aim, state):
    """Fills `state` with the directed distance from A to B; stops once it passes the limit of `aim`."""
    n, size = pc.shape[0] // 2, p_boxes.shape[0] // 2
    state[:] = 0.0
    state[PIECE_A], state[ARCS] = -1.0, n
    stack, todo = np.empty((STACK, 6)), np.empty(128, np.int64)
    work = (np.empty(128, np.int64), np.empty(128))
    hint = qc.shape[0] // 4
    for k in range(0, n, max(1, n // SEEDS)):
        x, y = _at(pc, k, 0.5)
        d, hint = nearest_segment(qc, q_boxes, x + shift_x, y + shift_y, hint, work[0], work[1])
        _offer(qc, k, 0.5, hint, x + shift_x, y + shift_y, d, state)
    todo[0], top = 1, 1
    while top > 0:
        top -= 1
        node = todo[top]
        if p_boxes[node, 0] > p_boxes[node, 2]:
            continue
        covered_sq = max(state[LOWER], aim.enough) ** 2
        if _box_covered(p_boxes, node, qc, hint, shift_x, shift_y, covered_sq):
            continue
        if node < size:
            todo[top], todo[top + 1] = 2 * node + 1, 2 * node
            top += 2
            continue
        first = (node - size) * BUCKET
        for k in range(first, min(n, first + BUCKET)):
            reach_sq = max(state[LOWER] + aim.gap, aim.enough) ** 2
            covering = _covering(pc, k, qc, hint, shift_x, shift_y, reach_sq)
            if covering >= 0:
                hint = covering
            elif state[LOWER] <= aim.limit:
                state[KEPT] += 1.0
                hint = _solve_segment(
                    pc, k, qc, q_boxes, hint, shift_x, shift_y, aim, state, stack, work
                )
    state[UPPER] = max(state[UPPER], max(state[LOWER] + aim.gap, aim.enough))

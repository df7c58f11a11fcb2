"""Compiled least distance of two curves, and the distances of many points from one: certified.

Two parts are apart by at least the gap of their control polygons along any direction; along that of their
middle points this bound errs by the square of their length alone. Not for: the Hausdorff distance.
"""

import numpy as np

from clearance.compile.jit import inline, kernel
from clearance.kernels.curve.arc import S0, S1, WIDTH
from clearance.kernels.curve.arcs import cells_apart
from clearance.kernels.curve.bezier import cut, hypotenuse, jet
from clearance.kernels.curve.nearest import nearest, slide_to_foot
from clearance.kernels.hausdorff.exact import common_normal

STACK = 4000
BUDGET = 200000.0  # cells after which the rest is given up with its bound
WIDEST = 1e-9  # of the distance: how much of a bound's lack may be the rounding of large radii


@kernel
def feet(pieces, leaves, points, out):
    """Writes distance, proven lower bound, piece and local parameter (n, 4) of each of `points` (n, 2)."""
    widest = 0
    for i in range(pieces.first.shape[0] - 1):
        widest = max(widest, pieces.first[i + 1] - pieces.first[i])
    work = np.empty((6, max(96, 4 * widest + 4), 4))
    hint = 0
    for k in range(points.shape[0]):
        foot = nearest(pieces, leaves, points[k, 0], points[k, 1], hint, np.inf, work)
        hint = foot.leaf
        out[k, 0], out[k, 1], out[k, 2], out[k, 3] = (
            foot.distance,
            foot.lower,
            foot.piece,
            foot.local,
        )


@inline
def _apart(p, n, q, m, ux, uy, shift):
    """The gap of two control polygons along the unit vector (ux, uy): a lower bound of their distance."""
    least, most = np.inf, -np.inf
    for k in range(n + 1):
        least = min(least, (p[k, 0] * ux + p[k, 1] * uy) / p[k, 2])
    for k in range(m + 1):
        most = max(most, (q[k, 0] * ux + q[k, 1] * uy) / q[k, 2])
    return least + shift - most


@inline
def _extent(p, n):
    """How far the control points are from the first, at the most, by the sum of both coordinates."""
    x, y, far = p[0, 0] / p[0, 2], p[0, 1] / p[0, 2], 0.0
    for k in range(1, n + 1):
        far = max(far, abs(p[k, 0] / p[k, 2] - x) + abs(p[k, 1] / p[k, 2] - y))
    return far


@inline
def _boxes_apart(a, i, b, j, shift_x, shift_y):
    dx = max(0.0, a[i, 0] + shift_x - b[j, 2], b[j, 0] - a[i, 2] - shift_x)
    dy = max(0.0, a[i, 1] + shift_y - b[j, 3], b[j, 1] - a[i, 3] - shift_y)
    return hypotenuse(dx, dy)


@inline
def _apart_at(pa, pb, i, t, j, s, shift_x, shift_y):
    a, b = jet(pa, i, t), jet(pb, j, s)
    return hypotenuse(a.x + shift_x - b.x, a.y + shift_y - b.y)


@kernel
def _closest_in(pa, pb, i, t0, t1, j, s0, s1, shift_x, shift_y):
    """A pair of parameters near the least distance of two parts, ends and corners of the cell among them.

    The direction of this pair is what separates the parts: where the least distance is at the cell's border,
    that of an inner pair leaves a gap of first order, and cells along the border would never end.
    """
    t, s = 0.5 * (t0 + t1), 0.5 * (s0 + s1)
    for _ in range(3):
        a = jet(pa, i, t)
        s = slide_to_foot(pb, j, a.x + shift_x, a.y + shift_y, s, s0, s1)
        b = jet(pb, j, s)
        t = slide_to_foot(pa, i, b.x - shift_x, b.y - shift_y, t, t0, t1)
    u, v = common_normal(pa, pb, i, t, t0, t1, j, s, shift_x, shift_y)
    v = min(s1, max(s0, v))
    here = _apart_at(pa, pb, i, t, j, s, shift_x, shift_y)
    if _apart_at(pa, pb, i, u, j, v, shift_x, shift_y) < here:
        return u, v
    return t, s


@kernel
def _descend(pa, pb, i, t0, t1, j, s0, s1, shift_x, shift_y, gap, best, work, rows):
    """Lowers `best` (distance, lower bound, piece, t, piece, s) by the least distance of two leaves.

    Where cells run alongside each other their arcs tell what directions do not, to rounding.
    """
    p, q, stack = work[0], work[1], work[2]
    stack[0, 0], stack[0, 1], stack[0, 2], stack[0, 3] = t0, t1, s0, s1
    top = 1
    while top > 0:
        top -= 1
        best[6] += 1.0
        t0, t1, s0, s1 = stack[top, 0], stack[top, 1], stack[top, 2], stack[top, 3]
        t, s = _closest_in(pa, pb, i, t0, t1, j, s0, s1, shift_x, shift_y)
        a, b = jet(pa, i, t), jet(pb, j, s)
        ex, ey = a.x + shift_x - b.x, a.y + shift_y - b.y
        distance = hypotenuse(ex, ey)
        if distance < best[0]:
            best[0], best[2], best[3], best[4], best[5] = distance, i, t, j, s
        if best[0] == 0.0:
            best[1] = 0.0
            return
        n, m = cut(pa, i, t0, t1, p), cut(pb, j, s0, s1, q)
        bound = 0.0
        if distance > 0.0:
            along = (shift_x * ex + shift_y * ey) / distance
            bound = max(0.0, _apart(p, n, q, m, ex / distance, ey / distance, along))
        slack = gap
        if bound < best[0] - gap:
            near, rounding = cells_apart(p, n, q, m, shift_x, shift_y, work[3], rows)
            bound, slack = max(bound, near), max(gap, min(rounding, WIDEST * best[0]))
        if (
            bound >= best[0] - slack
            or best[6] > BUDGET
            or top + 4 > stack.shape[0]
            or (t1 - t0 < 1e-15 and s1 - s0 < 1e-15)
        ):
            best[1] = min(best[1], max(bound, 0.0))
            continue
        t, s = 0.5 * (t0 + t1), 0.5 * (s0 + s1)
        long_a, long_b = _extent(p, n), _extent(q, m)
        cut_a, cut_b = 2.0 * long_a >= long_b, 2.0 * long_b >= long_a
        for k in range(4):
            if (k & 1 and not cut_a) or (k & 2 and not cut_b):
                continue
            stack[top, 0], stack[top, 1] = t0 if k & 1 or not cut_a else t, t if k & 1 else t1
            stack[top, 2], stack[top, 3] = s0 if k & 2 or not cut_b else s, s if k & 2 else s1
            top += 1


@kernel
def _polish(pa, la, pb, lb, shift_x, shift_y, best, work):
    """Lowers `best` from foot to foot, to and fro, to a local minimum: most leaves are then never opened."""
    for _ in range(12):
        there = jet(pb, int(best[4]), best[5])
        foot = nearest(pa, la, there.x - shift_x, there.y - shift_y, 0, np.inf, work)
        before = best[0]
        if foot.distance < best[0]:
            best[0], best[2], best[3] = foot.distance, foot.piece, foot.local
        here = jet(pa, int(best[2]), best[3])
        foot = nearest(pb, lb, here.x + shift_x, here.y + shift_y, 0, np.inf, work)
        if foot.distance < best[0]:
            best[0], best[4], best[5] = foot.distance, foot.piece, foot.local
        if not best[0] < before:
            return


@kernel
def least_distance(pa, la, pb, lb, shift_x, shift_y, gap):
    """The least distance of two curves: distance, proven lower bound, piece and parameter on A and on B."""
    best = np.array([np.inf, np.inf, 0.0, 0.0, 0.0, 0.0, 0.0])
    widest = 0
    for i in range(pa.first.shape[0] - 1):
        widest = max(widest, pa.first[i + 1] - pa.first[i])
    for i in range(pb.first.shape[0] - 1):
        widest = max(widest, pb.first[i + 1] - pb.first[i])
    work = np.empty((6, max(300, 4 * widest + 4), 4))
    rows = np.empty((2, WIDTH))
    n, m = la.arcs.shape[0], lb.arcs.shape[0]
    hint = 0
    for k in range(
        0, n, max(1, n // 16)
    ):  # a good bound first, so that most pairs are never opened
        start = jet(pa, la.piece[k], la.arcs[k, S0])
        foot = nearest(pb, lb, start.x + shift_x, start.y + shift_y, hint, np.inf, work)
        hint = foot.leaf
        if foot.distance < best[0]:
            best[0], best[2], best[3] = foot.distance, la.piece[k], la.arcs[k, S0]
            best[4], best[5] = foot.piece, foot.local
    _polish(pa, la, pb, lb, shift_x, shift_y, best, work)
    size_a, size_b = la.boxes.shape[0] // 2, lb.boxes.shape[0] // 2
    stack = np.empty((STACK, 2), np.int64)
    stack[0, 0], stack[0, 1] = 1, 1
    top = 1
    while top > 0:
        top -= 1
        i, j = stack[top, 0], stack[top, 1]
        if not _boxes_apart(la.boxes, i, lb.boxes, j, shift_x, shift_y) < best[0] - gap:
            continue
        if i >= size_a and j >= size_b:
            for k in range((i - size_a) * 4, min(n, (i - size_a) * 4 + 4)):
                for r in range((j - size_b) * 4, min(m, (j - size_b) * 4 + 4)):
                    a, b = la.arcs[k], lb.arcs[r]
                    _descend(
                        pa, pb, la.piece[k], a[S0], a[S1], lb.piece[r], b[S0], b[S1], shift_x, shift_y,
                        gap, best, work, rows,
                    )  # fmt: skip
            continue
        if j >= size_b or (i < size_a and i <= j):
            one, two = (2 * i, j), (2 * i + 1, j)
        else:
            one, two = (i, 2 * j), (i, 2 * j + 1)
        far = _boxes_apart(la.boxes, one[0], lb.boxes, one[1], shift_x, shift_y)
        if far < _boxes_apart(la.boxes, two[0], lb.boxes, two[1], shift_x, shift_y):
            one, two = two, one
        stack[top, 0], stack[top, 1] = one
        stack[top + 1, 0], stack[top + 1, 1] = two
        top += 2
    best[1] = min(best[0] - gap, best[1])
    return best

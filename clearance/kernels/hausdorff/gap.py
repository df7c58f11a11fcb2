"""Compiled least distance of two curves, certified.

Two parts are apart by at least the gap of their control polygons along any direction; along that of their
middle points this bound errs by the square of their length alone. Not for: the Hausdorff distance.
"""

from typing import Annotated, NamedTuple

import numpy as np

from clearance.compile.declared import ArrayOf
from clearance.compile.decorators import inline, kernel
from clearance.kernels.curve.arc import S0, S1, WIDTH
from clearance.kernels.curve.arc_fit import BUCKET, Leaves
from clearance.kernels.curve.arcs import lower_bound_cells
from clearance.kernels.curve.bezier import Pieces, cut, hypotenuse, jet
from clearance.kernels.curve.nearest import nearest, slide_to_foot
from clearance.kernels.curve.pair import CurvePart, Curves
from clearance.kernels.curve.scratch import new_scratch, widest
from clearance.kernels.hausdorff.roots import common_normal

MOST_OPEN = 4000  # pairs of nodes that may be open at once
CELL_ROWS = 300  # rows of scratch at least: cells of one pair of leaves that may be open at once
BUDGET = 200000  # cells after which the rest is given up with its bound
WIDEST = 1e-9  # of the distance: how much of a bound's lack may be the rounding of large radii
FIRST_FEET = (
    16  # arcs of A whose starts give a good bound first, so that most pairs are never opened
)
MOST_STEPS = 12  # from foot to foot
OF_A, OF_B, CELLS, BENDS = range(4)  # planes of scratch, in use while no nearest point is sought

LEAST_DISTANCE = np.dtype(
    (
        np.record,
        [
            ("distance", np.float64),  # of the closest points found
            ("lower", np.float64),  # proven lower bound of the least distance
            ("piece_a", np.int64),
            ("at_a", np.float64),
            ("piece_b", np.int64),
            ("at_b", np.float64),
            ("n_cells", np.int64),  # cells that were looked at
        ],
    )
)
LeastDistances = Annotated[np.ndarray, ArrayOf(LEAST_DISTANCE, 1)]


class LeafScratch(NamedTuple):
    """Planes of `curve.scratch`, and rows of two arcs (2, WIDTH)."""

    planes: np.ndarray
    arcs: np.ndarray


@inline
def _gap_along(p, n, q, m, ux, uy, shift):
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
def _boxes_distance(a, i, b, j, shift_x, shift_y):
    dx = max(0.0, a[i, 0] + shift_x - b[j, 2], b[j, 0] - a[i, 2] - shift_x)
    dy = max(0.0, a[i, 1] + shift_y - b[j, 3], b[j, 1] - a[i, 3] - shift_y)
    return hypotenuse(dx, dy)


@inline
def _distance_at(curves, i, t, j, s):
    a, b = jet(curves.a, i, t), jet(curves.b, j, s)
    return hypotenuse(a.x + curves.shift_x - b.x, a.y + curves.shift_y - b.y)


@inline
def _closest_in(curves, part, other):
    """A pair of parameters near the least distance of two parts, ends and corners of the cell among them.

    The direction of this pair is what separates the parts: where the least distance is at the cell's border,
    that of an inner pair leaves a gap of first order, and cells along the border would never end.
    """
    i, j, shift_x, shift_y = part.piece, other.piece, curves.shift_x, curves.shift_y
    t, s = 0.5 * (part.t0 + part.t1), 0.5 * (other.t0 + other.t1)
    for _ in range(3):
        a = jet(curves.a, i, t)
        s = slide_to_foot(curves.b, j, a.x + shift_x, a.y + shift_y, s, other.t0, other.t1)
        b = jet(curves.b, j, s)
        t = slide_to_foot(curves.a, i, b.x - shift_x, b.y - shift_y, t, part.t0, part.t1)
    u, v = common_normal(curves, part, t, j, s)
    v = min(other.t1, max(other.t0, v))
    if _distance_at(curves, i, u, j, v) < _distance_at(curves, i, t, j, s):
        return u, v
    return t, s


@inline
def _bound_of_cell(curves, p, n, q, m, ex, ey, distance):
    """The gap of two control polygons along the vector (ex, ey), whose length is `distance`; at least 0."""
    if not distance > 0.0:
        return 0.0
    along = (curves.shift_x * ex + curves.shift_y * ey) / distance
    return max(0.0, _gap_along(p, n, q, m, ex / distance, ey / distance, along))


@inline
def _push_quarters(cells, top, part, other, long_a, long_b):
    """Puts the halves of two parts, each against each, on the stack; the shorter part stays whole."""
    t, s = 0.5 * (part.t0 + part.t1), 0.5 * (other.t0 + other.t1)
    cut_a, cut_b = 2.0 * long_a >= long_b, 2.0 * long_b >= long_a
    for k in range(4):
        if (k & 1 and not cut_a) or (k & 2 and not cut_b):
            continue
        cells[top, 0] = part.t0 if k & 1 or not cut_a else t
        cells[top, 1] = t if k & 1 else part.t1
        cells[top, 2] = other.t0 if k & 2 or not cut_b else s
        cells[top, 3] = s if k & 2 else other.t1
        top += 1
    return top


@inline
def _search_leaves(curves, part, other, gap, best, scratch):
    """Lowers `best` by the least distance of the parts of two leaves.

    Where cells run alongside each other their arcs decide what directions do not, to rounding.
    """
    p, q, cells = scratch.planes[OF_A], scratch.planes[OF_B], scratch.planes[CELLS]
    shift_x, shift_y, i, j = curves.shift_x, curves.shift_y, part.piece, other.piece
    cells[0, 0], cells[0, 1], cells[0, 2], cells[0, 3] = part.t0, part.t1, other.t0, other.t1
    top = 1
    while top > 0:
        top -= 1
        best.n_cells += 1
        part = CurvePart(i, cells[top, 0], cells[top, 1])
        other = CurvePart(j, cells[top, 2], cells[top, 3])
        t, s = _closest_in(curves, part, other)
        a, b = jet(curves.a, i, t), jet(curves.b, j, s)
        ex, ey = a.x + shift_x - b.x, a.y + shift_y - b.y
        distance = hypotenuse(ex, ey)
        if distance < best.distance:
            best.distance = distance
            best.piece_a, best.at_a, best.piece_b, best.at_b = i, t, j, s
        if best.distance == 0.0:
            best.lower = 0.0
            return
        n, m = cut(curves.a, i, part.t0, part.t1, p), cut(curves.b, j, other.t0, other.t1, q)
        bound, slack = _bound_of_cell(curves, p, n, q, m, ex, ey, distance), gap
        if bound < best.distance - gap:
            near, rounding = lower_bound_cells(
                p, n, q, m, shift_x, shift_y, scratch.planes[BENDS], scratch.arcs
            )
            bound, slack = max(bound, near), max(gap, min(rounding, WIDEST * best.distance))
        is_point = part.t1 - part.t0 < 1e-15 and other.t1 - other.t0 < 1e-15
        given_up = best.n_cells > BUDGET or top + 4 > cells.shape[0] or is_point
        if bound >= best.distance - slack or given_up:
            best.lower = min(best.lower, max(bound, 0.0))
            continue
        top = _push_quarters(cells, top, part, other, _extent(p, n), _extent(q, m))


@inline
def _polish(curves, la, lb, best, work):
    """Lowers `best` from foot to foot, to and fro, to a local minimum: most leaves are then never opened."""
    shift_x, shift_y = curves.shift_x, curves.shift_y
    for _ in range(MOST_STEPS):
        there = jet(curves.b, best.piece_b, best.at_b)
        foot = nearest(curves.a, la, there.x - shift_x, there.y - shift_y, 0, np.inf, work)
        before = best.distance
        if foot.distance < best.distance:
            best.distance, best.piece_a, best.at_a = foot.distance, foot.piece, foot.local
        here = jet(curves.a, best.piece_a, best.at_a)
        foot = nearest(curves.b, lb, here.x + shift_x, here.y + shift_y, 0, np.inf, work)
        if foot.distance < best.distance:
            best.distance, best.piece_b, best.at_b = foot.distance, foot.piece, foot.local
        if not best.distance < before:
            return


@inline
def _begin(curves, la, lb, best, work):
    """Sets `best` from the starts of some arcs of A."""
    n, hint = la.arcs.shape[0], 0
    best.distance, best.lower = np.inf, np.inf
    for k in range(0, n, max(1, n // FIRST_FEET)):
        start = jet(curves.a, la.piece[k], la.arcs[k, S0])
        x, y = start.x + curves.shift_x, start.y + curves.shift_y
        foot = nearest(curves.b, lb, x, y, hint, np.inf, work)
        hint = foot.leaf
        if foot.distance < best.distance:
            best.distance, best.piece_a, best.at_a = foot.distance, la.piece[k], la.arcs[k, S0]
            best.piece_b, best.at_b = foot.piece, foot.local


@inline
def _search_buckets(curves, la, first_a, lb, first_b, gap, best, scratch):
    """Lowers `best` by the arcs of two leaves of the trees, each against each."""
    for k in range(first_a, min(la.arcs.shape[0], first_a + BUCKET)):
        for r in range(first_b, min(lb.arcs.shape[0], first_b + BUCKET)):
            part = CurvePart(la.piece[k], la.arcs[k, S0], la.arcs[k, S1])
            other = CurvePart(lb.piece[r], lb.arcs[r, S0], lb.arcs[r, S1])
            _search_leaves(curves, part, other, gap, best, scratch)


@kernel
def least_distance(
    pa: Pieces, la: Leaves, pb: Pieces, lb: Leaves, shift_x: float, shift_y: float, gap: float
) -> LeastDistances:
    """The least distance of two curves: (1,) LEAST_DISTANCE."""
    out, curves = np.zeros(1, LEAST_DISTANCE), Curves(pa, pb, shift_x, shift_y)
    best, planes = out[0], new_scratch(max(widest(pa), widest(pb)), CELL_ROWS)
    scratch = LeafScratch(planes, np.empty((2, WIDTH)))
    _begin(curves, la, lb, best, planes)
    _polish(curves, la, lb, best, planes)
    size_a, size_b = la.boxes.shape[0] // 2, lb.boxes.shape[0] // 2
    stack = np.empty((MOST_OPEN, 2), np.int64)
    stack[0, 0], stack[0, 1] = 1, 1
    top = 1
    while top > 0:
        top -= 1
        i, j = stack[top, 0], stack[top, 1]
        if not _boxes_distance(la.boxes, i, lb.boxes, j, shift_x, shift_y) < best.distance - gap:
            continue
        if i >= size_a and j >= size_b:
            first_a, first_b = (i - size_a) * BUCKET, (j - size_b) * BUCKET
            _search_buckets(curves, la, first_a, lb, first_b, gap, best, scratch)
            continue
        if j >= size_b or (i < size_a and i <= j):
            one, two = (2 * i, j), (2 * i + 1, j)
        else:
            one, two = (i, 2 * j), (i, 2 * j + 1)
        far = _boxes_distance(la.boxes, one[0], lb.boxes, one[1], shift_x, shift_y)
        if far < _boxes_distance(la.boxes, two[0], lb.boxes, two[1], shift_x, shift_y):
            one, two = two, one
        stack[top, 0], stack[top, 1] = one
        stack[top + 1, 0], stack[top + 1, 1] = two
        top += 2
    best.lower = min(best.distance - gap, best.lower)
    return out

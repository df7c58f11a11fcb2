"""Compiled solution of the systems (11), (12), (13): the multivariate solver of the paper, with proofs.

Source: Elber, Grandine, Hausdorff and minimal distances between parametric freeforms (2008). Every interval
T of curve A carries the cells of B that may hold a foot of its points, found by excluding the rest with
interval bounds; both are halved until each system in T has provably no root or one, which is then found by
Newton's method. A system that is settled on T is not asked again on T's halves; two feet in one cell are a
system of their own. No distance excludes anything, which is what trimming is measured against. At each root
the distance to the whole of B is taken, so that a superfluous root does no harm; a lost one would, and is
excluded by the proofs of `hausdorff.single_roots`.
"""

from typing import NamedTuple

import numpy as np

from clearance.compile.declared import Floats2
from clearance.compile.decorators import inline, kernel
from clearance.kernels.curve.bezier import Pieces, rough_joints
from clearance.kernels.curve.interval import dot, enclose, with_derivatives
from clearance.kernels.curve.pair import CurveArrays, CurvePair, CurvePart, Curves
from clearance.kernels.curve.scratch import SQUARES, new_scratch, widest
from clearance.kernels.hausdorff.bounds import consider, extent_bound, upper_bound
from clearance.kernels.hausdorff.cells import (
    DEEPEST,
    begin_table,
    keep_needed,
    new_table,
    put_child_cells,
)
from clearance.kernels.hausdorff.roots import slide_from
from clearance.kernels.hausdorff.single_roots import (
    OPEN,
    PIECE,
    S0,
    S1,
    gap_box,
    normal_is_single,
    same_foot,
)
from clearance.kernels.hausdorff.state import SearchStates
from clearance.kernels.hausdorff.system_roots import keep_root, try_bisector, try_normal

A_ROOT = 40.0  # what finding a root costs beside excluding a cell


class Systems(NamedTuple):
    """What is solved.

    Attributes:
        pair: two curves. a, b: their pieces `with_derivatives`.
        ends_a, ends_b: (n, 2) which of their ends are not smooth.
    """

    pair: CurvePair
    a: Pieces
    b: Pieces
    ends_a: np.ndarray
    ends_b: np.ndarray


class BoxScratch(NamedTuple):
    """Scratch: (4, 6) the boxes of A's part, (4,) one of a gap, (5, 6) for `same_foot`."""

    a: np.ndarray
    gap: np.ndarray
    scratch: np.ndarray


@inline
def _leave(pair, part, state, work):
    """Bounds an interval whose systems stay open: by its middle and extent, or side by side with B."""
    curves, i = pair.curves, part.piece
    foot = consider(pair, i, 0.5 * (part.t0 + part.t1), 0, state, work)
    s0, _ = slide_from(curves, i, part.t0, foot.piece, foot.local)
    s1, _ = slide_from(curves, i, part.t1, foot.piece, foot.local)
    bound, _ = upper_bound(curves, part, CurvePart(foot.piece, s0, s1), work)
    bound = min(bound, extent_bound(curves, part, foot.distance, work))
    state.upper = max(state.upper, bound)
    state.n_given_up += 1


@inline
def _settle_normals(systems, part, table, level, n, boxes, state, work):
    """Solves the open systems (12) of the new cells that have one root at most; returns what that cost."""
    cost, cells = 0.0, table.cells[level]
    for k in range(n):
        if cells[k, OPEN] == 0.0:
            continue
        gap_box(boxes.a[0], table.boxes[k, 0], systems.pair.curves, boxes.gap)
        low, high = dot(boxes.gap, boxes.a[1])
        cells[k, OPEN] = 0.0
        if low > 0.0 or high < 0.0:
            continue
        if normal_is_single(boxes.gap, boxes.a, table.boxes[k], cells[k, S0] == cells[k, S1]):
            try_normal(systems.pair, part, cells[k], state, work)
            cost += A_ROOT
        else:
            cells[k, OPEN] = 1.0
    return cost


@inline
def _pair_is_settled(systems, part, table, level, k, m, boxes, state, work):
    """Whether system (13) for two cells has no root in T, or one, which is then found; and what that cost.

    The same cell twice stands for two feet in it.

    Many arguments: what belongs together is in tuples already.
    """
    one, two = table.cells[level, k], table.cells[level, m]
    boxes_one, boxes_two, gap = table.boxes[k], table.boxes[m], boxes.scratch[4]
    if same_foot(systems, one, two, boxes.a, work[SQUARES], boxes.scratch):
        return True, 0.0
    if one[PIECE] == two[PIECE] and one[S0] == two[S0] and one[S1] == two[S1]:
        return False, 0.0
    for c in range(0, 4, 2):
        gap[c] = boxes_two[0, c] - boxes_one[0, c + 1]
        gap[c + 1] = boxes_two[0, c + 1] - boxes_one[0, c]
    low, high = dot(gap, boxes.a[1])
    if low > 0.0 or high < 0.0:  # the difference of both squares is monotone
        try_bisector(systems.pair, part, one, two, state, work)
        return True, A_ROOT
    return False, 0.0


@inline
def _settle_pairs(systems, part, table, level, boxes, state, work):
    """Settles the open systems (13) of the new cells: how many stay open, whether they fit, and the cost."""
    n_open, fits, cost = 0, True, 0.0
    old, new, ranges, child = table.pairs[level - 1], table.pairs[level], table.ranges, table.child
    for p in range(table.n_pairs[level - 1]):
        one, two = old[p, 0], old[p, 1]
        for half in range(4):
            k, m = child[one, half // 2], child[two, half % 2]
            if k < 0 or m < 0 or (one == two and half == 1):
                continue
            if ranges[k, 0] > ranges[m, 1] or ranges[m, 0] > ranges[k, 1]:
                continue
            settled, spent = _pair_is_settled(systems, part, table, level, m, k, boxes, state, work)
            cost += 1.0 + spent
            if not settled and n_open < new.shape[0]:
                new[n_open, 0], new[n_open, 1] = k, m
                n_open += 1
            elif not settled:
                fits = False
    return n_open, fits, cost


@inline
def _settle_level(systems, part, table, level, boxes, state, work):
    """Settles what can be of an interval's systems: whether any stays open, whether all fit, and the cost."""
    points = work[SQUARES]
    enclose(systems.a, part.piece, part.t0, part.t1, points, boxes.a)
    n = put_child_cells(systems, table, level, level > 1, boxes.a, points, boxes.gap)
    cost = 2.0 * table.n_cells[level - 1]
    cost += _settle_normals(systems, part, table, level, n, boxes, state, work)
    n_open, fits = 0, n >= 0
    if fits:
        n_open, fits, more = _settle_pairs(systems, part, table, level, boxes, state, work)
        cost += more
    n = keep_needed(table, level, max(n, 0), n_open)
    table.n_cells[level], table.n_pairs[level] = n, n_open
    return n > 0, fits, cost


@inline
def _solve_part(systems, b_parts, part, budget, table, boxes, state, work):
    """Finds all candidates on one part of A; see the module.

    What the budget, the depth or the capacity leaves open is bounded.

    Many arguments: what belongs together is in tuples already.
    """
    fits_first = begin_table(b_parts, systems.ends_b, table)
    stack = np.empty((2 * DEEPEST + 4, 3))  # of intervals: t0, t1, level
    stack[0, 0], stack[0, 1], stack[0, 2] = part.t0, part.t1, 1.0
    top, spent = 1, 0.0
    while top > 0:
        top -= 1
        here, level = CurvePart(part.piece, stack[top, 0], stack[top, 1]), int(stack[top, 2])
        state.n_cuts += 1
        if not fits_first or spent > budget:
            _leave(systems.pair, here, state, work)
            continue
        is_open, fits, cost = _settle_level(systems, here, table, level, boxes, state, work)
        spent += cost
        if not fits or (is_open and level >= DEEPEST):
            _leave(systems.pair, here, state, work)
        elif is_open:
            middle = 0.5 * (here.t0 + here.t1)
            stack[top, 0], stack[top, 1], stack[top, 2] = middle, here.t1, level + 1
            stack[top + 1, 0], stack[top + 1, 1], stack[top + 1, 2] = here.t0, middle, level + 1
            top += 2


@inline
def _consider_ends(pair, ends_a, a_part, state, work):
    """System (11): the ends and corners of A that one part of it holds."""
    i = int(a_part[0])
    for side in range(2):
        if ends_a[i, side] and a_part[1 + side] == side:
            state.n_ends += 1
            foot = consider(pair, i, float(side), 0, state, work)
            keep_root(foot.distance, i, float(side), foot.piece, foot.local, state)


@kernel
def solve_directed(
    one: CurveArrays,
    a_parts: Floats2,
    two: CurveArrays,
    b_parts: Floats2,
    shift_x: float,
    shift_y: float,
    budget: float,
    states: SearchStates,
):
    """Raises the first of `states` to the directed distance of parts of A, feet on parts of B.

    Its `upper` bounds the distance of the parts of A to B, `root` is the greatest distance of any root.

    Args:
        one, two: A and B, `CurveArrays`; a_parts, b_parts: (n, 3) piece, t0, t1; shift: from A's frame into B's.
    """
    state, work = states[0], new_scratch(max(widest(one.pieces), widest(two.pieces)), 0)
    pair = CurvePair(Curves(one.pieces, two.pieces, shift_x, shift_y), two.leaves)
    systems = Systems(
        pair,
        with_derivatives(one.pieces),
        with_derivatives(two.pieces),
        rough_joints(one.pieces, one.joints),
        rough_joints(two.pieces, two.joints),
    )
    table, boxes = new_table(), BoxScratch(np.empty((4, 6)), np.empty(4), np.empty((5, 6)))
    share = budget / max(1, a_parts.shape[0])
    for k in range(a_parts.shape[0]):
        _consider_ends(pair, systems.ends_a, a_parts[k], state, work)
        part = CurvePart(int(a_parts[k, 0]), a_parts[k, 1], a_parts[k, 2])
        _solve_part(systems, b_parts, part, share, table, boxes, state, work)
    if state.piece_a < 0:  # nothing to solve, and no end: any point for a witness
        consider(pair, 0, 0.5, 0, state, work)
    state.upper = max(state.upper, state.distance)

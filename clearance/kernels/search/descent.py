"""Nearest-first descent of two trees: the exact nearest faces of two bodies, or a proof that they are far.

A descent goes on from the front that the last one of the same pair has left, if there is one (`front`).
"""

import math
from typing import NamedTuple

import numpy as np

from clearance.compile.jit import inline
from clearance.compile.kernel_table import borrow
from clearance.kernels.arithmetic.lanes import (
    WIDTH,
    first_of,
    how_many,
    lane,
    least_of,
    marks_within,
)
from clearance.kernels.arithmetic.vec3 import Vec3
from clearance.kernels.features.bounds import lower_bound_boxes, lower_bound_faces_along_direction
from clearance.kernels.features.face_pair import (
    FacePairState,
    Hit,
    limit_of,
    may_own_nearest,
    nearest_of_faces,
)
from clearance.kernels.features.meeting import NO_MEETING, Meeting, meeting_of
from clearance.kernels.features.refine import (
    N_WAITING,
    NOTHING_REFINED,
    RefinedDistance,
    put,
    settle,
    shed,
)
from clearance.kernels.features.rounding_guard import sure_gap, told_apart
from clearance.kernels.mesh.surface import box_of, is_leaf
from clearance.kernels.search.front import KEPT_DOWN, LONGEST, OF_B, forget, keep
from clearance.kernels.search.node_pairs import (
    bounds_of_group,
    opened,
    pair_in_group,
    turned_away,
    views_of,
)
from clearance.kernels.search.scratch import STACK_DEPTH, swap, wait
from clearance.kernels.search.warm_start import warm_start


class Tally(NamedTuple):
    """Work done: node pairs bounded, face pairs measured, decisions that took exact arithmetic."""

    nodes: int
    faces: int
    exact_decisions: int


class DescentResult(NamedTuple):
    """The outcome of a descent.

    Attributes:
        meeting: whether and where the bodies have a common point, in the faces of `hit`.
        hit: the best pair of points in doubles, within the limit or not, no worse than what was given.
        lower_bound: [m] a lower bound on the distance of the face pairs that were not refined.
        refined: the answer in wide numbers, if there is one within the limit.
    """

    meeting: Meeting
    hit: Hit
    lower_bound: float
    refined: RefinedDistance
    tally: Tally


@inline
def nothing_yet(limit_sq):
    """The hit that any pair of points within the limit beats."""
    nowhere = Vec3(0.0, 0.0, 0.0)
    return Hit(limit_sq, 2**62, 2**62, nowhere, nowhere)


@inline(force=True)
def _wait_for_near(
    a, b, from_a, from_b, scratch, n_waiting, group, other, is_b, marks, bounds, slack, cut
):
    """Lets the marked nodes of a group wait that may hold nearest points with a node of the other body.

    Leaves stay marked, so that all of a group stay in one entry; what waits of them has ~a for a. What is turned
    away stays too. Returns (waiting, marks that stay, the least bound of those, that of those beyond `cut`).
    """
    near = marks & marks_within(bounds, cut)
    far = least_of(bounds, marks ^ near)
    first = n_waiting
    low = math.inf
    apart = near & ~marks_within(bounds, 0.0)
    if apart:
        away = apart & turned_away(a, b, from_a, from_b, group, other, is_b, slack)
        low = least_of(bounds, away)
        near ^= away
    while near:
        i = first_of(near)
        near &= near - 1
        bound = lane(bounds, i)
        node_a, node_b = pair_in_group(is_b, group, i, other)
        if is_leaf(a, node_a) and is_leaf(b, node_b):
            low = min(low, bound)
            node_a = ~node_a
        else:
            marks ^= 1 << i
        n_waiting = wait(scratch, n_waiting, node_a, node_b, bound, first)
    return n_waiting, marks, min(low, far), far


@inline(force=True)
def _leave(scratch, n_left, group, other, marks, lower_bound):
    """Notes an entry for the front; the number of them."""
    scratch.left[n_left, 0], scratch.left[n_left, 1], scratch.left[n_left, 2] = group, other, marks
    scratch.lower_bounds[n_left] = lower_bound
    return n_left + (n_left <= LONGEST)  # one too many says that not all are there


@inline
def margin_of(slack):
    """[m] the rounding of a distance between two points of the bodies, with room."""
    return 4.0 * slack


@inline(force=True)
def _nearest_last(scratch, n_waiting):
    """Puts the nearest of all node pairs that wait last."""
    bounds = scratch.bounds
    nearest = n_waiting - 1
    for k in range(n_waiting - 1):
        if max(0.0, bounds[k]) < max(0.0, bounds[nearest]):
            nearest = k
    swap(scratch, nearest, n_waiting - 1)


@inline(one_caller=True)
def _resume(a, b, from_a, from_b, slack, cut, fronts, pair, moved, scratch):
    """Splits the front of a pair: what is still far stays in it, the rest waits.

    Returns (kept, waiting, node pairs bounded, lower bound).
    """
    start = fronts.spans[pair, 0]
    n_kept = 0
    n_waiting = 0
    n_nodes = 0
    nearest = 0
    lower_bound = math.inf
    for i in range(start, start + fronts.spans[pair, 1]):
        group, other, marks = fronts.entries[i, 0], fronts.entries[i, 1], fronts.entries[i, 2]
        carried = fronts.lower_bounds[i]
        if carried - moved <= cut:
            is_b = marks >= OF_B
            marks %= OF_B
            n_nodes += how_many(marks)
            bounds = bounds_of_group(a, b, from_a, from_b, group, other, is_b, marks, slack, cut)
            n_before = n_waiting
            n_waiting, marks, low, far = _wait_for_near(
                a,
                b,
                from_a,
                from_b,
                scratch,
                n_waiting,
                group,
                other,
                is_b,
                marks,
                bounds,
                slack,
                cut,
            )
            if n_waiting > n_before and scratch.bounds[n_waiting - 1] < scratch.bounds[nearest]:
                nearest = n_waiting - 1
            lower_bound = min(lower_bound, far)
            if marks == 0:
                continue
            marks += OF_B if is_b else 0
            carried = (low + moved) * KEPT_DOWN
        else:
            lower_bound = min(lower_bound, carried - moved)
        kept = start + n_kept
        fronts.entries[kept, 0], fronts.entries[kept, 1], fronts.entries[kept, 2] = (
            group,
            other,
            marks,
        )
        fronts.lower_bounds[kept] = carried
        n_kept += 1
    if n_waiting > 0:  # nearest last
        swap(scratch, nearest, n_waiting - 1)
    return n_kept, n_waiting, n_nodes, lower_bound


@inline(one_caller=True)
def descend(
    lent_a, root_a, lent_b, root_b, frames, best, first, limit, wanted_gap, slack, effort, separating_planes,
    fronts, pair, moved, scratch, table,
):  # fmt: skip
    """All face pairs of two bodies that can be nearest within a limit, near node pairs first.

    Args:
        best: where to start: a hit, or none; its points say in which direction the bodies are seen apart, also
            where they are farther apart than the limit.
        first: the hit of two faces that are measured already, and what was seen of them.
        limit: [m] node pairs farther than this, or than the best, are not opened.
        wanted_gap: [m] face pairs farther apart are not refined.
        slack: [m] of `rounding_slack`.
        effort: node pairs after which it stops with what is within its limit so far, and proves nothing.
        separating_planes: if leaves wait already only these are looked at; nothing else is nearer than it says.
        fronts, pair: where the front of the pair is kept.
        moved: [m] what both bodies have moved in all.
        table: of `kernel_table`.

    A pair of nodes or faces is left only if a lower bound exceeds the best distance by more than its own
    error, so that every face pair that attains the minimum is refined, and the answer does not depend on
    the order of the search. It stops at the first contact.
    """
    a, b = borrow(lent_a), borrow(lent_b)
    m = frames.m
    margin = margin_of(slack)
    best_gap = min(limit, math.sqrt(best.gap_sq))
    cut = best_gap + margin
    from_a, from_b = views_of(best, m)
    refined = NOTHING_REFINED
    n_faces = 0
    n_exact = scratch.exact.count[0]
    n_pairs = 0
    met = NO_MEETING
    n_left = 0
    untold_wait = False
    if separating_planes.n_waiting > 0:
        n_kept, n_waiting, n_nodes, lower_bound = (
            0,
            separating_planes.n_waiting,
            0,
            separating_planes.beyond,
        )
    elif fronts.spans[pair, 1] > 0:
        n_kept, n_waiting, n_nodes, lower_bound = _resume(
            a, b, from_a, from_b, slack, cut, fronts, pair, moved, scratch
        )
    else:
        n_kept, n_waiting, n_nodes, lower_bound = 0, 1, 1, math.inf
        scratch.nodes[0, 0] = root_a
        scratch.nodes[0, 1] = root_b
        scratch.bounds[0] = lower_bound_boxes(box_of(a, root_a), box_of(b, root_b), m, slack)
        if best_gap == math.inf:
            n_waiting, n_nodes = warm_start(a, root_a, b, root_b, from_a, from_b, scratch)
    while n_waiting > 0:
        if n_nodes > effort and best_gap < math.inf:
            lower_bound = -math.inf
            break
        n_waiting -= 1
        node_a = scratch.nodes[n_waiting, 0]
        node_b = scratch.nodes[n_waiting, 1]
        bound = scratch.bounds[n_waiting]
        is_kept = node_a < 0  # leaves, which the front has
        if is_kept:
            node_a = ~node_a
        if bound > cut:
            lower_bound = min(lower_bound, bound)
            if not is_kept:
                mark = 1 << node_a % WIDTH
                n_left = _leave(
                    scratch, n_left, node_a // WIDTH, node_b, mark, (bound + moved) * KEPT_DOWN
                )
            continue
        if is_leaf(a, node_a) and is_leaf(b, node_b):
            face_a, face_b = np.int64(a.children[node_a, 0]), np.int64(b.children[node_b, 0])
            along_direction = (
                lower_bound_faces_along_direction(a, face_a, b, face_b, from_a.direction) - slack
            )
            if along_direction > cut:
                lower_bound = min(lower_bound, along_direction)
            elif best.gap_sq > limit * limit or may_own_nearest(
                a, face_a, b, face_b, from_a.direction, along_direction, best_gap, margin
            ):
                n_faces += 1
                before_sq, before_gap = best.gap_sq, best_gap
                if face_a == first.best.face_a and face_b == first.best.face_b:
                    near = FacePairState(best, first.seen)
                else:
                    near = nearest_of_faces(a, face_a, b, face_b, m, margin, best)
                best = near.best
                if best.gap_sq < before_sq:
                    best_gap = min(limit, math.sqrt(best.gap_sq))
                    cut = best_gap + margin
                    from_a, from_b = views_of(best, m)
                    along_direction = (
                        lower_bound_faces_along_direction(a, face_a, b, face_b, from_a.direction)
                        - slack
                    )
                gap = sure_gap(a, face_a, b, face_b, m, margin, along_direction)
                if bound <= 0.0 and gap <= 0.0:
                    met = meeting_of(table, lent_a, face_a, lent_b, face_b, frames, scratch.exact)
                    if met.found:
                        best = Hit(0.0, face_a, face_b, m.t, m.t)
                        break
                if n_waiting > 1 and best_gap < before_gap:
                    _nearest_last(scratch, n_waiting)
                least_sq = near.seen.near_sq
                is_told = told_apart(a, face_a, b, face_b, gap, margin)
                if not is_told:  # nearer ones may be hidden
                    least_sq = min(least_sq, max(0.0, gap) * max(0.0, gap))
                reach = limit_of(a, face_a, b, face_b, before_gap, margin)
                may_win = least_sq < math.inf and least_sq <= reach * reach
                if may_win:
                    if n_pairs == N_WAITING:
                        n_pairs = shed(a, b, best_gap, margin, scratch.waiting, n_pairs)
                        if n_pairs > N_WAITING // 2:
                            refined = settle(
                                lent_a,
                                lent_b,
                                frames,
                                min(best_gap, wanted_gap),
                                margin,
                                scratch.waiting,
                                n_pairs,
                                from_a.direction,
                                slack,
                                0.0,
                                refined,
                                table,
                            )
                            n_pairs = 0
                    put(scratch.waiting, n_pairs, face_a, face_b, near.seen, least_sq)
                    n_pairs += 1
                if may_win and not is_told:
                    untold_wait = True
                elif least_sq < math.inf:
                    gap = math.sqrt(least_sq)
                    lower_bound = min(
                        lower_bound, 2.0 * gap - limit_of(a, face_a, b, face_b, gap, margin)
                    )
                else:
                    lower_bound = min(lower_bound, math.sqrt(best.gap_sq) + margin)
            if not is_kept:  # the roots
                n_left = _leave(
                    scratch, n_left, node_a // WIDTH, node_b, 1, (bound + moved) * KEPT_DOWN
                )
            continue
        is_b, group, count, other = opened(a, node_a, b, node_b)
        marks = (1 << count) - 1
        bounds = bounds_of_group(a, b, from_a, from_b, group, other, is_b, marks, slack, cut)
        n_nodes += count
        assert n_waiting + WIDTH <= STACK_DEPTH
        n_waiting, marks, low, far = _wait_for_near(
            a, b, from_a, from_b, scratch, n_waiting, group, other, is_b, marks, bounds, slack, cut
        )
        lower_bound = min(lower_bound, far)
        if marks > 0:
            marks += OF_B if is_b else 0
            n_left = _leave(scratch, n_left, group, other, marks, (low + moved) * KEPT_DOWN)
    if not met.found:
        refined = settle(
            lent_a,
            lent_b,
            frames,
            min(best_gap, wanted_gap),
            margin,
            scratch.waiting,
            n_pairs,
            from_a.direction,
            slack,
            best_gap,
            refined,
            table,
        )
    if met.found or lower_bound == -math.inf:
        forget(fronts, pair)
    elif separating_planes.n_waiting == 0:
        keep(fronts, pair, n_kept, scratch.left, scratch.lower_bounds, n_left)
    if untold_wait:  # they are no nearer than what is wanted, or refined
        lower_bound = min(lower_bound, min(best_gap, wanted_gap))
    tally = Tally(n_nodes, n_faces, scratch.exact.count[0] - n_exact)
    return DescentResult(met, best, lower_bound, refined, tally)

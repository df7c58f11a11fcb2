"""Nearest-first descent of two trees: the exact nearest faces of two bodies, or a proof that they are far.

A descent goes on from the front that the last one of the same pair has left, if there is one (`front`).
"""

import math
from typing import NamedTuple

import numpy as np

from clearance.jit import inlined, merged, shared, spliced
from clearance.kernel_table import borrow
from clearance.kernels.bounds import (
    lower_bound_boxes,
    lower_bound_boxes_in_sight,
    lower_bound_faces_in_sight,
    sight_along,
)
from clearance.kernels.face_pair import Hit, limit_of, may_meet, nearest_of_faces
from clearance.kernels.front import KEPT_DOWN, LONGEST, forget, keep
from clearance.kernels.meeting import NO_MEETING, Meeting, meeting_of
from clearance.kernels.predicates import Exact, room_for_exact
from clearance.kernels.refine import (
    N_WAITING,
    NOTHING_REFINED,
    Refined,
    Waiting,
    put,
    room_for_waiting,
    settle,
    shed,
)
from clearance.kernels.surface import box_of
from clearance.kernels.vec3 import Vec3

STACK_DEPTH = 8192
"""Node pairs that can wait: each split adds one, so twice the depths of both trees and a front is enough;
trees of a million faces split at the mean are below 200 deep, and `descend` checks."""


class Scratch(NamedTuple):
    """Room for waiting node pairs and face pairs and for exact arithmetic, reused between queries."""

    nodes: np.ndarray  # (STACK_DEPTH, 2) int32
    bounds: np.ndarray  # (STACK_DEPTH,)
    left: np.ndarray  # (LONGEST + 2, 2) int32, node pairs that were left
    floors: np.ndarray  # (LONGEST + 2,)
    waiting: Waiting
    exact: Exact


class Tally(NamedTuple):
    """Work done: node pairs bounded, face pairs measured, decisions that took exact arithmetic."""

    nodes: int
    faces: int
    exact_decisions: int


class Found(NamedTuple):
    """The outcome of a descent.

    Attributes:
        meeting: whether and where the bodies have a common point, in the faces of `hit`.
        hit: the best pair of points in doubles, no worse than what was given.
        floor: [m] a lower bound on the distance of the face pairs that were not refined.
        refined: the answer in wide numbers, if there is one within the limit.
    """

    meeting: Meeting
    hit: Hit
    floor: float
    refined: Refined
    tally: Tally


@inlined
def nothing_yet(limit_sq):
    """The hit that any pair of points within the limit beats."""
    nowhere = Vec3(0.0, 0.0, 0.0)
    return Hit(limit_sq, 2**62, 2**62, nowhere, nowhere)


@merged
def breadth(box):
    """Sum of the two smaller half sizes: what splitting can make smaller, also where faces are long."""
    half = box.half
    return half.x + half.y + half.z - max(half.x, max(half.y, half.z))


@merged
def _bound(p, q, m, sight, slack, cut):
    """[m] a lower bound on the distance of two boxes: the cheap one in sight if that excludes them."""
    in_sight = lower_bound_boxes_in_sight(p, q, sight) - slack
    if in_sight > cut:
        return in_sight
    return lower_bound_boxes(p, q, m, slack)


@shared
def new_scratch():
    """Room for one search at a time."""
    return Scratch(
        np.empty((STACK_DEPTH, 2), dtype=np.int32),
        np.empty(STACK_DEPTH),
        np.empty((LONGEST + 2, 2), dtype=np.int32),
        np.empty(LONGEST + 2),
        room_for_waiting(),
        room_for_exact(),
    )


@inlined
def margin_of(slack):
    """[m] the rounding of a distance between two points of the bodies, with room."""
    return 4.0 * slack


@spliced
def _resume(a, b, m, sight, slack, cut, fronts, pair, moved, scratch):
    """Splits the front of a pair: what is still far stays in it, the rest waits. (kept, waiting, floor)"""
    start = fronts.spans[pair, 0]
    n_kept = 0
    n_waiting = 0
    nearest = 0
    least = math.inf
    floor = math.inf
    for i in range(start, start + fronts.spans[pair, 1]):
        node_a, node_b = fronts.nodes[i, 0], fronts.nodes[i, 1]
        carried = fronts.floors[i]
        if carried - moved <= cut:
            bound = _bound(box_of(a, node_a), box_of(b, node_b), m, sight, slack, cut)
            if bound <= cut:
                scratch.bounds[n_waiting] = bound
                scratch.nodes[n_waiting, 0], scratch.nodes[n_waiting, 1] = node_a, node_b
                if bound < least:
                    least = bound
                    nearest = n_waiting
                n_waiting += 1
                continue
            carried = (bound + moved) * KEPT_DOWN
        floor = min(floor, carried)
        fronts.nodes[start + n_kept, 0], fronts.nodes[start + n_kept, 1] = node_a, node_b
        fronts.floors[start + n_kept] = carried
        n_kept += 1
    if n_waiting > 0:  # nearest last
        last = n_waiting - 1
        nodes = scratch.nodes
        nodes[nearest, 0], nodes[last, 0] = nodes[last, 0], nodes[nearest, 0]
        nodes[nearest, 1], nodes[last, 1] = nodes[last, 1], nodes[nearest, 1]
        scratch.bounds[nearest], scratch.bounds[last] = scratch.bounds[last], least
    return n_kept, n_waiting, floor - moved


@spliced
def descend(
    lent_a, root_a, lent_b, root_b, frames, best, wanted_gap, slack, fronts, pair, moved, scratch, table
):
    """All face pairs of two bodies that can be nearest within the distance of `best`, near node pairs first.

    Args:
        best: where to start: a hit, or `nothing_yet(limit_sq)`; node pairs farther than it are not opened.
        wanted_gap: [m] face pairs farther apart are not refined.
        slack: [m] of `rounding_slack`.
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
    best_gap = math.sqrt(best.gap_sq)
    cut = best_gap + margin
    sight = sight_along(best.p, best.q, m)
    refined = NOTHING_REFINED
    n_nodes = 1
    n_faces = 0
    n_exact = scratch.exact.count[0]
    n_pairs = 0
    met = NO_MEETING
    n_left = 0
    measured = math.inf
    if fronts.spans[pair, 1] > 0:
        n_nodes = fronts.spans[pair, 1]
        n_kept, n_waiting, floor = _resume(a, b, m, sight, slack, cut, fronts, pair, moved, scratch)
        n_nodes -= n_kept
    else:
        n_kept, n_waiting, floor = 0, 1, math.inf
        scratch.nodes[0, 0] = root_a
        scratch.nodes[0, 1] = root_b
        scratch.bounds[0] = lower_bound_boxes(box_of(a, root_a), box_of(b, root_b), m, slack)
    while n_waiting > 0:
        n_waiting -= 1
        node_a = scratch.nodes[n_waiting, 0]
        node_b = scratch.nodes[n_waiting, 1]
        bound = scratch.bounds[n_waiting]
        leaf_a = a.children[node_a, 1] < 0
        leaf_b = b.children[node_b, 1] < 0
        is_left = bound > cut
        if not is_left and leaf_a and leaf_b:
            is_left = True
            face_a, face_b = np.int64(a.children[node_a, 0]), np.int64(b.children[node_b, 0])
            in_sight = lower_bound_faces_in_sight(a, face_a, b, face_b, sight) - slack
            if in_sight <= cut:
                n_faces += 1
                before_sq = best.gap_sq
                near = nearest_of_faces(a, face_a, b, face_b, m, margin, best)
                best = near.best
                if best.gap_sq < before_sq:
                    best_gap = math.sqrt(best.gap_sq)
                    cut = best_gap + margin
                    sight = sight_along(best.p, best.q, m)
                    in_sight = lower_bound_faces_in_sight(a, face_a, b, face_b, sight) - slack
                if bound == 0.0 and in_sight <= 0.0 and may_meet(a, face_a, b, face_b, m, margin):
                    met = meeting_of(table, a, face_a, b, face_b, frames, scratch.exact)
                    if met.found:
                        best = Hit(0.0, face_a, face_b, m.t, m.t)
                        break
                if near.seen.near_sq < math.inf:
                    if n_pairs == N_WAITING:
                        n_pairs = shed(a, b, best_gap, margin, scratch.waiting, n_pairs)
                        if n_pairs > N_WAITING // 2:
                            refined = settle(
                                lent_a, lent_b, frames, min(best_gap, wanted_gap), margin,
                                scratch.waiting, n_pairs, refined, table,
                            )
                            n_pairs = 0
                    put(scratch.waiting, n_pairs, face_a, face_b, near.seen)
                    n_pairs += 1
                    gap = math.sqrt(near.seen.near_sq)
                    measured = min(measured, 2.0 * gap - limit_of(a, face_a, b, face_b, gap, margin))
            else:
                floor = min(floor, in_sight)
            bound = max(bound, in_sight)
        elif is_left:
            floor = min(floor, bound)
        if is_left:
            scratch.left[n_left, 0], scratch.left[n_left, 1] = node_a, node_b
            scratch.floors[n_left] = (bound + moved) * KEPT_DOWN
            n_left += n_left <= LONGEST  # one too many says that not all are there
            continue
        a0, a1, b0, b1 = node_a, node_a, node_b, node_b
        if leaf_b or (not leaf_a and breadth(box_of(a, node_a)) >= breadth(box_of(b, node_b))):
            a0, a1 = a.children[node_a, 0], a.children[node_a, 1]
        else:
            b0, b1 = b.children[node_b, 0], b.children[node_b, 1]
        first = _bound(box_of(a, a0), box_of(b, b0), m, sight, slack, cut)
        second = _bound(box_of(a, a1), box_of(b, b1), m, sight, slack, cut)
        n_nodes += 2
        if first < second:
            a0, a1 = a1, a0
            b0, b1 = b1, b0
            first, second = second, first
        assert n_waiting + 2 <= STACK_DEPTH
        scratch.nodes[n_waiting, 0] = a0
        scratch.nodes[n_waiting, 1] = b0
        scratch.bounds[n_waiting] = first
        scratch.nodes[n_waiting + 1, 0] = a1
        scratch.nodes[n_waiting + 1, 1] = b1
        scratch.bounds[n_waiting + 1] = second
        n_waiting += 2
    if met.found:
        forget(fronts, pair)
    else:
        refined = settle(
            lent_a, lent_b, frames, min(best_gap, wanted_gap), margin,
            scratch.waiting, n_pairs, refined, table,
        )
        keep(fronts, pair, n_kept, scratch.left, scratch.floors, n_left)
    tally = Tally(n_nodes, n_faces, scratch.exact.count[0] - n_exact)
    return Found(met, best, min(floor, min(measured, cut)), refined, tally)

"""Nearest-first descent of two trees: the exact nearest faces of two bodies, or a proof that they are far."""

import math
from typing import NamedTuple

import numpy as np

from clearance.jit import inlined
from clearance.kernels.bounds import (
    lower_bound_boxes_in_sight,
    lower_bound_boxes_sq,
    lower_bound_faces_in_sight,
    sight_along,
)
from clearance.kernels.face_pair import Hit, may_meet, nearest_of_faces
from clearance.kernels.predicates import Exact, faces_meet, room_for_exact
from clearance.kernels.refine import Refined, nothing_refined, settle, shed
from clearance.kernels.vec3 import Vec3

STACK_DEPTH = 4096
"""Node pairs that can wait: each split adds one, so twice the depths of both trees is enough; trees of a
million faces split at the mean are below 200 deep, and `descend` checks."""


N_WAITING = 64
"""Face pairs that wait to be refined; where more are equally near, the waiting ones are refined first."""


class Scratch(NamedTuple):
    """Room for waiting node pairs and face pairs and for exact arithmetic, reused between queries."""

    nodes: np.ndarray  # (STACK_DEPTH, 2) int64
    bounds_sq: np.ndarray  # (STACK_DEPTH,)
    pairs: np.ndarray  # (N_WAITING, 2) int64
    near_sq: np.ndarray  # (N_WAITING,)
    exact: Exact


class Tally(NamedTuple):
    """Work done: node pairs bounded, face pairs measured, decisions that took exact arithmetic."""

    nodes: int
    faces: int
    exact_decisions: int


class Found(NamedTuple):
    """The outcome of a descent.

    Attributes:
        meet: True if the bodies have a common point, in the faces of `hit`.
        hit: the best pair of points in doubles, no worse than what was given.
        floor_sq: a lower bound on the squared distance of the face pairs that were left out [m^2].
        refined: the answer in wide numbers, if there is one within the limit.
    """

    meet: bool
    hit: Hit
    floor_sq: float
    refined: Refined
    tally: Tally


@inlined
def nothing_yet(limit_sq):
    """The hit that any pair of points within the limit beats."""
    nowhere = Vec3(0.0, 0.0, 0.0)
    return Hit(limit_sq, 2**62, 2**62, nowhere, nowhere)


@inlined
def breadth(surface, node):
    """Sum of the two smaller half sizes: what splitting can make smaller, also where faces are long."""
    x, y, z = surface.halves[node, 0], surface.halves[node, 1], surface.halves[node, 2]
    return x + y + z - max(x, max(y, z))


@inlined
def _bound_sq(a, node_a, b, node_b, m, sight, slack, cut):
    """A lower bound on the squared distance of two nodes: the cheap one in sight if that excludes them."""
    in_sight = lower_bound_boxes_in_sight(a, node_a, b, node_b, sight) - slack
    if in_sight > cut:
        return in_sight * in_sight
    return lower_bound_boxes_sq(a, node_a, b, node_b, m, slack)


@inlined
def new_scratch():
    """Room for one search at a time."""
    return Scratch(
        np.empty((STACK_DEPTH, 2), dtype=np.int64),
        np.empty(STACK_DEPTH),
        np.empty((N_WAITING, 2), dtype=np.int64),
        np.empty(N_WAITING),
        room_for_exact(),
    )


@inlined
def margin_of(slack):
    """[m] the rounding of a distance between two points of the bodies, with room."""
    return 4.0 * slack


@inlined
def descend(a, root_a, b, root_b, frames, best, slack, scratch):
    """All face pairs of two bodies that can be nearest within the distance of `best`, near node pairs first.

    Args:
        best: where to start: a hit, or `nothing_yet(limit_sq)`; node pairs farther than it are not opened.
        slack: [m] of `rounding_slack`.

    A pair of nodes or faces is left only if a lower bound exceeds the best distance by more than its own
    error, so that every face pair that attains the minimum is refined, and the answer does not depend on
    the order of the search. It stops at the first contact.
    """
    m = frames.m
    margin = margin_of(slack)
    best_gap = math.sqrt(best.gap_sq)
    cut = best_gap + margin
    sight = sight_along(best.p, best.q, m)
    floor_sq = np.inf
    refined = nothing_refined()
    n_nodes = 1
    n_faces = 0
    n_exact = scratch.exact.count[0]
    n_pairs = 0
    meet = False
    scratch.nodes[0, 0] = root_a
    scratch.nodes[0, 1] = root_b
    scratch.bounds_sq[0] = lower_bound_boxes_sq(a, root_a, b, root_b, m, slack)
    n_waiting = 1
    while n_waiting > 0:
        n_waiting -= 1
        node_a = scratch.nodes[n_waiting, 0]
        node_b = scratch.nodes[n_waiting, 1]
        bound_sq = scratch.bounds_sq[n_waiting]
        if bound_sq > cut * cut:
            floor_sq = min(floor_sq, bound_sq)
            continue
        leaf_a = a.children[node_a, 1] < 0
        leaf_b = b.children[node_b, 1] < 0
        if leaf_a and leaf_b:
            face_a, face_b = a.children[node_a, 0], b.children[node_b, 0]
            in_sight = lower_bound_faces_in_sight(a, face_a, b, face_b, sight) - slack
            if in_sight > cut:
                floor_sq = min(floor_sq, in_sight * in_sight)
                continue
            n_faces += 1
            before_sq = best.gap_sq
            near = nearest_of_faces(a, face_a, b, face_b, m, margin, best)
            best = near.best
            if best.gap_sq < before_sq:
                best_gap = math.sqrt(best.gap_sq)
                cut = best_gap + margin
                sight = sight_along(best.p, best.q, m)
                in_sight = lower_bound_faces_in_sight(a, face_a, b, face_b, sight) - slack
            if bound_sq == 0.0 and in_sight <= 0.0 and may_meet(a, face_a, b, face_b, m, margin):
                meet = faces_meet(a, face_a, b, face_b, frames, scratch.exact)
                if meet:
                    best = Hit(0.0, face_a, face_b, m.t, m.t)
                    break
            if near.near_sq < np.inf:
                if n_pairs == N_WAITING:
                    n_pairs = shed(a, b, best_gap, margin, scratch.pairs, scratch.near_sq, n_pairs)
                    if n_pairs > N_WAITING // 2:
                        refined = settle(
                            a, b, frames, best_gap, margin, scratch.pairs, scratch.near_sq, n_pairs, refined
                        )
                        n_pairs = 0
                scratch.pairs[n_pairs, 0], scratch.pairs[n_pairs, 1] = face_a, face_b
                scratch.near_sq[n_pairs] = near.near_sq
                n_pairs += 1
            continue
        if leaf_b or (not leaf_a and breadth(a, node_a) >= breadth(b, node_b)):
            a0, a1 = a.children[node_a, 0], a.children[node_a, 1]
            b0, b1 = node_b, node_b
        else:
            a0, a1 = node_a, node_a
            b0, b1 = b.children[node_b, 0], b.children[node_b, 1]
        first_sq = _bound_sq(a, a0, b, b0, m, sight, slack, cut)
        second_sq = _bound_sq(a, a1, b, b1, m, sight, slack, cut)
        n_nodes += 2
        if first_sq < second_sq:
            a0, a1 = a1, a0
            b0, b1 = b1, b0
            first_sq, second_sq = second_sq, first_sq
        assert n_waiting + 2 <= STACK_DEPTH
        scratch.nodes[n_waiting, 0] = a0
        scratch.nodes[n_waiting, 1] = b0
        scratch.bounds_sq[n_waiting] = first_sq
        scratch.nodes[n_waiting + 1, 0] = a1
        scratch.nodes[n_waiting + 1, 1] = b1
        scratch.bounds_sq[n_waiting + 1] = second_sq
        n_waiting += 2
    if not meet:
        refined = settle(
            a, b, frames, best_gap, margin, scratch.pairs, scratch.near_sq, n_pairs, refined
        )
    tally = Tally(n_nodes, n_faces, scratch.exact.count[0] - n_exact)
    return Found(meet, best, min(floor_sq, cut * cut), refined, tally)

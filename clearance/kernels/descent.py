"""Nearest-first descent of two trees: the exact nearest faces of two bodies, or a proof that they are far."""

import math
from typing import NamedTuple

import numpy as np

from clearance.jit import inlined
from clearance.kernels.bounds import (
    lower_bound_boxes_in_sight,
    lower_bound_boxes_sq,
    lower_bound_faces_in_sight,
    rounding_slack,
    sight_along,
)
from clearance.kernels.face_pair import Hit, nearest_of_faces
from clearance.kernels.vec3 import Vec3

STACK_DEPTH = 4096
"""Node pairs that can wait: each split adds one, so twice the depths of both trees is enough; trees of a
million faces split at the mean are below 200 deep, and `descend` checks."""


class Scratch(NamedTuple):
    """Room for waiting node pairs, reused between queries."""

    nodes: np.ndarray  # (STACK_DEPTH, 2) int64
    bounds_sq: np.ndarray  # (STACK_DEPTH,)


class Tally(NamedTuple):
    """Work done: node pairs bounded and face pairs measured."""

    nodes: int
    faces: int


class Found(NamedTuple):
    """The outcome of a descent.

    Attributes:
        hit: the best pair of points, no worse than what was given.
        floor_sq: a lower bound on the squared distance of the bodies [m^2].
    """

    hit: Hit
    floor_sq: float
    tally: Tally


@inlined
def nothing_yet(limit_sq):
    """The hit that any pair of points within the limit beats."""
    nowhere = Vec3(0.0, 0.0, 0.0)
    return Hit(limit_sq, 2**62, 2**62, nowhere, nowhere)


@inlined
def _breadth(surface, node):
    """Sum of the two smaller half sizes: what splitting can make smaller, also where faces are long."""
    x, y, z = surface.halves[node, 0], surface.halves[node, 1], surface.halves[node, 2]
    return x + y + z - max(x, max(y, z))


@inlined
def _bound_sq(a, node_a, b, node_b, m, sight, slack, best_gap):
    """A lower bound on the squared distance of two nodes: the cheap one in sight if that excludes them."""
    in_sight = lower_bound_boxes_in_sight(a, node_a, b, node_b, sight) - slack
    if in_sight > best_gap:
        return in_sight * in_sight
    return lower_bound_boxes_sq(a, node_a, b, node_b, m, slack)


@inlined
def descend(a, root_a, b, root_b, m, best, scratch):
    """The best hit of two bodies that beats or equals `best`, visiting near node pairs first.

    Args:
        m: `a_from_b`.
        best: where to start: a hit, or `nothing_yet(limit_sq)`; node pairs farther than it are not opened.

    A pair of nodes or faces is left only if a lower bound exceeds the best distance, so that every face
    pair that attains the minimum is measured, and the answer does not depend on the order of the search. It
    stops at the first contact.
    """
    slack = rounding_slack(a, root_a, b, root_b, m)
    best_gap = math.sqrt(best.gap_sq)
    sight = sight_along(best.p, best.q, m)
    floor_sq = np.inf
    n_nodes = 1
    n_faces = 0
    scratch.nodes[0, 0] = root_a
    scratch.nodes[0, 1] = root_b
    scratch.bounds_sq[0] = lower_bound_boxes_sq(a, root_a, b, root_b, m, slack)
    n_waiting = 1
    while n_waiting > 0:
        n_waiting -= 1
        node_a = scratch.nodes[n_waiting, 0]
        node_b = scratch.nodes[n_waiting, 1]
        bound_sq = scratch.bounds_sq[n_waiting]
        if bound_sq > best.gap_sq:
            floor_sq = min(floor_sq, bound_sq)
            continue
        leaf_a = a.children[node_a, 1] < 0
        leaf_b = b.children[node_b, 1] < 0
        if leaf_a and leaf_b:
            face_a, face_b = a.children[node_a, 0], b.children[node_b, 0]
            in_sight = lower_bound_faces_in_sight(a, face_a, b, face_b, sight) - slack
            if in_sight > best_gap:
                floor_sq = min(floor_sq, in_sight * in_sight)
                continue
            n_faces += 1
            before_sq = best.gap_sq
            best = nearest_of_faces(a, face_a, b, face_b, m, bound_sq == 0.0, best)
            if best.gap_sq == 0.0:
                break
            if best.gap_sq < before_sq:
                best_gap = math.sqrt(best.gap_sq)
                sight = sight_along(best.p, best.q, m)
            continue
        if leaf_b or (not leaf_a and _breadth(a, node_a) >= _breadth(b, node_b)):
            a0, a1 = a.children[node_a, 0], a.children[node_a, 1]
            b0, b1 = node_b, node_b
        else:
            a0, a1 = node_a, node_a
            b0, b1 = b.children[node_b, 0], b.children[node_b, 1]
        first_sq = _bound_sq(a, a0, b, b0, m, sight, slack, best_gap)
        second_sq = _bound_sq(a, a1, b, b1, m, sight, slack, best_gap)
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
    return Found(best, min(floor_sq, best.gap_sq), Tally(n_nodes, n_faces))

"""Nearest-first descent of two trees: the exact nearest faces of two bodies, or a proof that they are far.

A descent goes on from the front that the last one of the same pair has left, if there is one (`front`).
"""

import math
from typing import NamedTuple

import numpy as np

from clearance.compile.decorators import inline
from clearance.kernels.arithmetic.lanes import (
    WIDTH,
    first_of,
    how_many,
    lane,
    least_of,
    marks_within,
)
from clearance.kernels.features.bounds import (
    lower_bound_boxes,
)
from clearance.kernels.features.face_pair import (
    Hit,
)
from clearance.kernels.features.meeting import NO_MEETING, Meeting
from clearance.kernels.features.posed_pair import parts
from clearance.kernels.features.refine import (
    NOTHING_REFINED,
    RefinedDistance,
)
from clearance.kernels.mesh.surface import box_of, is_leaf
from clearance.kernels.search.face_search import (
    FaceSearch,
    RefineProgress,
    look_at_faces,
    nearest_so_far,
    settle_waiting,
)
from clearance.kernels.search.front import KEPT_DOWN, OF_B, forget, keep, leave
from clearance.kernels.search.node_pairs import (
    NodeGroup,
    bounds_of_group,
    opened,
    pair_in_group,
    turned_away,
)
from clearance.kernels.search.scratch import require_room, swap, wait
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
        refined: the answer in double-double, if there is one within the limit.
    """

    meeting: Meeting
    hit: Hit
    lower_bound: float
    refined: RefinedDistance
    tally: Tally


class NodeQueue(NamedTuple):
    """Node pairs that wait, in `Scratch`, when a search begins.

    Attributes:
        n_kept: entries of the front that stay in it. n_waiting: node pairs. n_bounded: those bounded for it.
        lower_bound: [m] of all that does not wait.
    """

    n_kept: int
    n_waiting: int
    n_bounded: int
    lower_bound: float


@inline(force=True)
def _wait_for_near(a, b, near, nodes, marks, bounds, slack, scratch, n_waiting):
    """Lets the marked nodes of a group wait that may hold nearest points with a node of the other body.

    Leaves stay marked, so that all of a group stay in one entry; what waits of them has ~a for a. What is turned
    away stays too. Returns (waiting, marks that stay, the least bound of those, that of those beyond the cut).

    Many arguments: it is inlined into the inner loop, whose locals they are.
    """
    within = marks & marks_within(bounds, near.cut)
    far = least_of(bounds, marks ^ within)
    first = n_waiting
    low = math.inf
    apart = within & ~marks_within(bounds, 0.0)
    if apart:
        away = apart & turned_away(a, b, near.views, nodes, slack)
        low = least_of(bounds, away)
        within ^= away
    while within:
        i = first_of(within)
        within &= within - 1
        bound = lane(bounds, i)
        node_a, node_b = pair_in_group(nodes, i)
        if is_leaf(a, node_a) and is_leaf(b, node_b):
            low = min(low, bound)
            node_a = ~node_a
        else:
            marks ^= 1 << i
        n_waiting = wait(scratch, n_waiting, node_a, node_b, bound, first)
    return n_waiting, marks, min(low, far), far


@inline(force=True)
def _leave_pair(scratch, n_left, node_a, node_b, kept):
    """`leave` of one node pair."""
    nodes = NodeGroup(False, node_a // WIDTH, node_b)
    return leave(scratch, n_left, nodes, 1 << node_a % WIDTH, kept)


@inline
def _resume(a, b, near, slack, front, scratch):
    """Splits the front of a pair: what is still far stays in it, the rest waits."""
    fronts, moved = front.fronts, front.moved
    start = fronts.spans[front.pair, 0]
    n_kept = 0
    n_waiting = 0
    n_nodes = 0
    nearest = 0
    lower_bound = math.inf
    for i in range(start, start + fronts.spans[front.pair, 1]):
        group, other, marks = (
            np.int64(fronts.entries[i, 0]),
            np.int64(fronts.entries[i, 1]),
            np.int64(fronts.entries[i, 2]),
        )
        carried = fronts.lower_bounds[i]
        if carried - moved <= near.cut:
            nodes = NodeGroup(marks >= OF_B, group, other)
            marks %= OF_B
            n_nodes += how_many(marks)
            bounds = bounds_of_group(a, b, near.views, nodes, marks, slack, near.cut)
            n_before = n_waiting
            n_waiting, marks, low, far = _wait_for_near(
                a, b, near, nodes, marks, bounds, slack, scratch, n_waiting
            )
            if n_waiting > n_before and scratch.bounds[n_waiting - 1] < scratch.bounds[nearest]:
                nearest = n_waiting - 1
            lower_bound = min(lower_bound, far)
            if marks == 0:
                continue
            marks += OF_B if nodes.is_of_b else 0
            carried = (low + moved) * KEPT_DOWN
        else:
            lower_bound = min(lower_bound, carried - moved)
        kept = start + n_kept
        fronts.entries[kept, 0], fronts.entries[kept, 1] = group, other
        fronts.entries[kept, 2] = marks
        fronts.lower_bounds[kept] = carried
        n_kept += 1
    if n_waiting > 0:  # nearest last
        swap(scratch, nearest, n_waiting - 1)
    return NodeQueue(n_kept, n_waiting, n_nodes, lower_bound)


@inline
def _begin(a, b, roots, near, slack, planes, front, scratch):
    """What waits first: what the separating planes or the front have left, or the roots."""
    if planes.n_waiting > 0:
        return NodeQueue(0, planes.n_waiting, 0, planes.beyond)
    if front.fronts.spans[front.pair, 1] > 0:
        return _resume(a, b, near, slack, front, scratch)
    scratch.nodes[0, 0], scratch.nodes[0, 1] = roots.a, roots.b
    scratch.bounds[0] = lower_bound_boxes(
        box_of(a, roots.a), box_of(b, roots.b), roots.frames.m, slack
    )
    n_waiting, n_nodes = 1, 1
    if near.gap == math.inf:
        n_waiting, n_nodes = warm_start(a, b, roots, near.views, scratch)
    return NodeQueue(0, n_waiting, n_nodes, math.inf)


@inline
def descend(roots, best, first, limits, planes, front, scratch):
    """All face pairs of two bodies that can be nearest within a limit, near node pairs first.

    Args:
        roots: of the bodies' trees.
        best: where to start: a hit, or none; its points say in which direction the bodies are seen apart, also
            where they are farther apart than the limit.
        first: the hit of two faces that are measured already, and what was seen of them.
        limits: of `SearchLimits`.
        planes: of `SeparatingPlanes`: if leaves wait already only these are looked at; nothing else is nearer than
            it says.
        front: of `PairFront`, where the front of the pair is kept.

    A pair of nodes or faces is left only if a lower bound exceeds the best distance by more than its own
    error, so that every face pair that attains the minimum is refined, and the answer does not depend on
    the order of the search. It stops at the first contact.
    """
    a, b = roots.surface_a, roots.surface_b
    slack, n_exact = limits.slack, scratch.exact.count[0]
    near = nearest_so_far(best, limits, roots.frames.m)
    queue = _begin(a, b, roots, near, slack, planes, front, scratch)
    n_waiting, n_nodes, n_left = queue.n_waiting, queue.n_bounded, 0
    nothing_waits = RefineProgress(0, NOTHING_REFINED, False)
    search = FaceSearch(near, nothing_waits, NO_MEETING, queue.lower_bound, 0)
    lower_bound = math.inf  # of the node pairs that are left
    while n_waiting > 0 and not search.meeting.found:
        near = search.near
        if n_nodes > limits.effort and near.gap < math.inf:
            lower_bound = -math.inf
            break
        n_waiting -= 1
        node_a, node_b = (
            np.int64(scratch.nodes[n_waiting, 0]),
            np.int64(scratch.nodes[n_waiting, 1]),
        )
        bound = scratch.bounds[n_waiting]
        is_kept = node_a < 0  # leaves, which the front has
        if is_kept:
            node_a = ~node_a
        if bound > near.cut:
            lower_bound = min(lower_bound, bound)
            if not is_kept:
                kept = (bound + front.moved) * KEPT_DOWN
                n_left = _leave_pair(scratch, n_left, node_a, node_b, kept)
        elif is_leaf(a, node_a) and is_leaf(b, node_b):
            faces = parts(roots, np.int64(a.children[node_a, 0]), np.int64(b.children[node_b, 0]))
            search = look_at_faces(faces, bound, first, search, limits, n_waiting, scratch)
            if not is_kept:  # the roots
                kept = (bound + front.moved) * KEPT_DOWN
                n_left = _leave_pair(scratch, n_left, node_a, node_b, kept)
        else:
            nodes, count = opened(a, node_a, b, node_b)
            marks = (1 << count) - 1
            bounds = bounds_of_group(a, b, near.views, nodes, marks, slack, near.cut)
            n_nodes += count
            require_room(n_waiting)
            n_waiting, marks, low, far = _wait_for_near(
                a, b, near, nodes, marks, bounds, slack, scratch, n_waiting
            )
            lower_bound = min(lower_bound, far)
            if marks > 0:
                kept = (low + front.moved) * KEPT_DOWN
                n_left = leave(scratch, n_left, nodes, marks, kept)
    lower_bound = min(lower_bound, search.lower_bound)
    met = search.meeting
    refined = search.progress.refined
    if not met.found:
        refined = settle_waiting(roots, search, limits, search.near.gap, scratch)
    if met.found or lower_bound == -math.inf:
        forget(front.fronts, front.pair)
    elif planes.n_waiting == 0:
        keep(front.fronts, front.pair, queue.n_kept, scratch.left, scratch.lower_bounds, n_left)
    if search.progress.hides:  # they are no nearer than what is wanted, or refined
        lower_bound = min(lower_bound, min(search.near.gap, limits.wanted))
    tally = Tally(n_nodes, search.n_measured, scratch.exact.count[0] - n_exact)
    return DescentResult(met, search.near.hit, lower_bound, refined, tally)

"""Nearest-first descent of two trees: the one search behind distance, certificate and tolerances.

Each node pair gets a lower bound on the distance of its faces under a displacement (`displacement`). A pair whose
bound exceeds the cut-off distance is skipped; any other is opened. Two leaves go to the search. Its type defines
the step at two faces: the exact minimum (`nearest`), or a proven bound (`proof`). A descent begins at the front of
the last descent of the same pair, if there is one (`front`).
"""

import math
from typing import Any, NamedTuple

import numpy as np

from clearance.compile.decorators import by_type, inline
from clearance.kernels.arithmetic.lanes import (
    WIDTH,
    first_of,
    how_many,
    lane,
    least_of,
    marks_within,
)
from clearance.kernels.features.posed_pair import parts
from clearance.kernels.mesh.surface import is_leaf
from clearance.kernels.search.front import LENGTH, OF_B, START, add_entry, carried_down
from clearance.kernels.search.node_pairs import (
    NodeGroup,
    bounds_of_group,
    opened,
    pair_in_group,
    turned_away,
)
from clearance.kernels.search.scratch import require_capacity, swap, wait


class NodeQueue(NamedTuple):
    """Node pairs that wait, in `Scratch`, when a descent begins.

    Attributes:
        n_retained: entries that stay in the front. n_waiting: node pairs. n_bounded: node pairs bounded so far.
        lower_bound: [m] of all node pairs that do not wait.
    """

    n_retained: int
    n_waiting: int
    n_bounded: int
    lower_bound: float


class Descent(NamedTuple):
    """The result of a descent.

    Attributes:
        search: in its last state. lower_bound: [m] of the node pairs that were skipped.
        is_complete: False if the search ended while node pairs waited; the bound then covers only some.
        n_nodes: node pairs bounded. n_fresh: new entries for the front, in `Scratch`.
    """

    search: Any
    lower_bound: float
    is_complete: bool
    n_nodes: int
    n_fresh: int


@by_type
def cut_of(search, goal, n_opened):
    """[m] the cut-off distance after so many openings: node pairs with a greater bound are skipped."""
    raise TypeError


@by_type
def is_over(search, goal, n_nodes):
    """True if the search ends here, after so many node pairs were bounded."""
    raise TypeError


@by_type
def with_faces(search, faces, bound, cut, displacement, goal, n_waiting, scratch):
    """The search after two faces with a lower bound [m], while so many node pairs wait.

    Args:
        faces: a `PosedPair` of faces.
    """
    raise TypeError


class _Group(NamedTuple):
    """The marked nodes of a group after a visit.

    Attributes:
        n_waiting: node pairs that wait now. marks: of the nodes that stay in the front.
        of_marked: [m] a bound on these. beyond: [m] a bound on the nodes beyond the cut-off distance.
    """

    n_waiting: int
    marks: int
    of_marked: float
    beyond: float


@inline(force=True)
def _wait_for_near(roots, views, nodes, marks, displacement, cut, scratch, n_waiting):
    """Queues the marked nodes of a group that may hold nearest points with a node of the other body.

    Leaves stay marked, so that a group stays in one entry; a queued leaf has ~a for a. Nodes that are turned away
    stay marked too.

    Many arguments: it is inlined into the inner loop, whose locals they are.
    """
    a, b = roots.surface_a, roots.surface_b
    bounds = bounds_of_group(a, b, views, nodes, marks, displacement, cut)
    within = marks & marks_within(bounds, cut)
    beyond = least_of(bounds, marks ^ within)
    away = turned_away(a, b, views, nodes, within, bounds, displacement)
    of_marked = min(beyond, least_of(bounds, away))
    within ^= away
    require_capacity(n_waiting)
    first = n_waiting
    while within:
        i = first_of(within)
        within &= within - 1
        bound = lane(bounds, i)
        node_a, node_b = pair_in_group(nodes, i)
        if is_leaf(a, node_a) and is_leaf(b, node_b):
            of_marked = min(of_marked, bound)
            node_a = ~node_a
        else:
            marks ^= 1 << i
        n_waiting = wait(scratch, n_waiting, node_a, node_b, bound, first)
    return _Group(n_waiting, marks, of_marked, beyond)


@inline
def from_front(roots, views, displacement, cut, front, scratch):
    """Splits the front of a pair: entries beyond the cut-off distance [m] stay in it, the rest waits."""
    fronts, moved = front.fronts, front.moved
    entries = fronts.entries
    start = fronts.spans[front.pair, START]
    n_retained, n_waiting, n_nodes, nearest = 0, 0, 0, 0
    lower_bound = math.inf
    for i in range(start, start + fronts.spans[front.pair, LENGTH]):
        group, other, marks = (
            np.int64(entries[i, 0]),
            np.int64(entries[i, 1]),
            np.int64(entries[i, 2]),
        )
        carried = fronts.lower_bounds[i]
        if carried - moved <= cut:
            nodes = NodeGroup(marks >= OF_B, group, other)
            marks %= OF_B
            n_nodes += how_many(marks)
            before = n_waiting
            found = _wait_for_near(
                roots, views, nodes, marks, displacement, cut, scratch, n_waiting
            )
            n_waiting = found.n_waiting
            if n_waiting > before and scratch.bounds[n_waiting - 1] < scratch.bounds[nearest]:
                nearest = n_waiting - 1
            lower_bound = min(lower_bound, found.beyond)
            if found.marks == 0:
                continue
            marks = found.marks + OF_B if nodes.is_of_b else found.marks
            carried = carried_down(found.of_marked, moved)
        else:
            lower_bound = min(lower_bound, carried - moved)
        to = start + n_retained
        entries[to, 0], entries[to, 1], entries[to, 2] = group, other, marks
        fronts.lower_bounds[to] = carried
        n_retained += 1
    if n_waiting > 0:  # nearest last
        swap(scratch, nearest, n_waiting - 1)
    return NodeQueue(n_retained, n_waiting, n_nodes, lower_bound)


@inline
def put_roots(roots, bound, scratch):
    """Queues the roots with a lower bound [m]."""
    scratch.nodes[0, 0], scratch.nodes[0, 1] = roots.a, roots.b
    scratch.bounds[0] = bound


@inline
def descend(roots, displacement, search, goal, queue, moved, scratch):
    """Visits all face pairs of two bodies that a search needs, near node pairs first.

    Args:
        roots: of the bodies' trees. displacement: see `displacement`. search: its initial state; its `views` give
            the direction along which boxes are bounded. goal: of the search. queue: a `NodeQueue`.
        moved: [m] the total motion of both bodies, for the front.
    """
    a, b = roots.surface_a, roots.surface_b
    n_waiting, n_nodes, n_fresh, n_opened = queue.n_waiting, queue.n_bounded, 0, 0
    lower_bound = queue.lower_bound
    while n_waiting > 0 and not is_over(search, goal, n_nodes):
        cut = cut_of(search, goal, n_opened)
        n_waiting -= 1
        node_a, node_b = (
            np.int64(scratch.nodes[n_waiting, 0]),
            np.int64(scratch.nodes[n_waiting, 1]),
        )
        bound = scratch.bounds[n_waiting]
        is_in_front = node_a < 0  # leaves
        if is_in_front:
            node_a = ~node_a
        are_leaves = is_leaf(a, node_a) and is_leaf(b, node_b)
        if not is_in_front and (are_leaves or bound > cut):
            one = NodeGroup(False, node_a // WIDTH, node_b)
            marks = 1 << node_a % WIDTH
            n_fresh = add_entry(scratch, n_fresh, one, marks, carried_down(bound, moved))
        if bound > cut:
            lower_bound = min(lower_bound, bound)
        elif are_leaves:
            faces = parts(roots, np.int64(a.children[node_a, 0]), np.int64(b.children[node_b, 0]))
            search = with_faces(search, faces, bound, cut, displacement, goal, n_waiting, scratch)
        else:
            nodes, count = opened(a, node_a, b, node_b)
            marks = (1 << count) - 1
            n_nodes += count
            n_opened += 1
            found = _wait_for_near(
                roots, search.views, nodes, marks, displacement, cut, scratch, n_waiting
            )
            n_waiting, lower_bound = found.n_waiting, min(lower_bound, found.beyond)
            if found.marks > 0:
                carried = carried_down(found.of_marked, moved)
                n_fresh = add_entry(scratch, n_fresh, nodes, found.marks, carried)
    return Descent(search, lower_bound, n_waiting == 0, n_nodes, n_fresh)

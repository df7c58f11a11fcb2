"""The least that errors leave of the distance of two bodies, proven: both trees are descended once.

A node pair is done if its distance, less what the errors move both nodes along the direction of the nearest points
seen so far, or less what they move both bodies at all, stays above the target. Not for: two faces (`face_left`),
and which pairs and steps are asked (`sweep`).
"""

import math
from typing import NamedTuple

import numpy as np

from clearance.compile.jit import inline
from clearance.compile.kernel_table import borrow
from clearance.kernels.arithmetic.lanes import WIDTH, lane, larger, marks_within
from clearance.kernels.arithmetic.vec3 import Vec3, dot, row, sub
from clearance.kernels.budget.errors import REACH, SURFACE, TURNED
from clearance.kernels.budget.face_left import (
    SearchState,
    look_at_both,
    look_at_faces,
    taken_at,
    target_of,
    turn_to,
    with_value,
)
from clearance.kernels.budget.pieces import TwoBodies, TwoFaces
from clearance.kernels.budget.tilted import kept_of_box, kept_of_point
from clearance.kernels.features.bounds import (
    direction_between,
    lower_bound_boxes,
    lower_bound_boxes_along_direction,
    rounding_slack,
)
from clearance.kernels.mesh.surface import box_of, group_of, is_leaf
from clearance.kernels.motion.certify_pair import CHAIN_SLACK, MOST_TURNED
from clearance.kernels.search.balls import radii_of
from clearance.kernels.search.node_pairs import opened, pair_in_group, turned_away_while
from clearance.kernels.search.scratch import STACK_DEPTH, wait

LOOK_AT_FACES = 8
"""As many looks at groups of nodes as one at two faces takes."""


class Start(NamedTuple):
    """Where a search begins (frame of a): nearest points that are known, or two that differ along a direction.

    Attributes:
        are_known: True where they are the nearest points of both bodies.
    """

    p: Vec3
    q: Vec3
    are_known: bool


class Left(NamedTuple):
    """What is left of a pair.

    Attributes:
        lower_bound: [m] proven, or `target` where all is above it. least: [m] the least seen to occur, or as
            asked. enough: [m] at a step, what is as good as that.
        completed: False where the target cannot be proven without a shorter interval.
        u: the direction of the nearest points seen (frame of a).
    """

    lower_bound: float
    least: float
    enough: float
    completed: bool
    u: Vec3


@inline(force=True)
def _node_bounds(p, q, side, view, kept, reach, slack, target):
    """[m] lower bounds on what is left of the distances of boxes in lanes, p of body `side`."""
    left = lower_bound_boxes_along_direction(p, q, view.direction) - slack
    left = left - kept_of_box(p, side, kept) - kept_of_box(q, 1 - side, kept)
    if marks_within(left, target) == 0:
        return left
    apart = lower_bound_boxes(p, q, view.m, slack) - slack - reach
    return larger(left, apart)


@inline(force=True)
def _group_bounds(a, b, nodes, views, kept, reach, slack, target):
    """[m] the same of the nodes of a group and a node of the other body."""
    if nodes.is_of_b:
        p, q = group_of(b, nodes.group), box_of(a, nodes.other)
        return _node_bounds(p, q, 1, views.b, kept, reach, slack, target)
    p, q = group_of(a, nodes.group), box_of(b, nodes.other)
    return _node_bounds(p, q, 0, views.a, kept, reach, slack, target)


@inline(force=True)
def _face_bound(a, face_a, b, face_b, direction, kept, slack):
    """[m] a lower bound on what is left of two faces, along the tilted direction."""
    far, near = -math.inf, math.inf
    for c in range(a.face_starts[face_a], a.face_starts[face_a + 1]):
        x = row(a.vertices, a.face_vertices[c])
        far = max(far, dot(direction.u, x) + kept_of_point(x, 0, kept))
    for c in range(b.face_starts[face_b], b.face_starts[face_b + 1]):
        x = row(b.vertices, b.face_vertices[c])
        near = min(near, dot(direction.v, x) - kept_of_point(x, 1, kept))
    return near + direction.offset - far - slack


class _Reaches(NamedTuple):
    """[m] the rounding of distances, and how far errors move and turn [rad] both bodies at most."""

    slack: float
    reach: float
    turn: float
    cos_turn: float
    sin_turn: float


@inline(force=True)
def _look_at_group(a, b, node_a, node_b, views, reaches, target, n_waiting, work, tally):
    """Lets those of the pairs below two nodes wait that are not above the target.

    Returns:
        how many wait, and [m] a bound on those that do not.
    """
    nodes, count = opened(a, node_a, b, node_b)
    slack, reach = reaches.slack, reaches.reach
    bounds = _group_bounds(a, b, nodes, views, work.kept, reach, slack, target)
    tally[2] += count
    away = 0
    if reaches.turn < MOST_TURNED and marks_within(bounds, target):
        away = turned_away_while(
            a, b, views, nodes, slack, reaches.cos_turn, reaches.sin_turn, reach
        )
    if n_waiting + WIDTH > STACK_DEPTH:
        raise AssertionError("no room for what waits")
    first, lower_bound = n_waiting, math.inf
    for k in range(count):
        if away >> k & 1:
            continue
        bound = lane(bounds, k)
        if bound >= target:
            lower_bound = min(lower_bound, bound)
            continue
        node_a, node_b = pair_in_group(nodes, k)
        n_waiting = wait(work.scratch, n_waiting, node_a, node_b, bound, first)
    return n_waiting, lower_bound


@inline(one_caller=True)
def _begin(lent, start, m, bodies, aim, thin):
    """A search that has seen nothing but its start."""
    direction = direction_between(start.p, start.q, m)
    look_at_both(lent, direction, bodies)
    views = turn_to(lent, direction, m, bodies)
    length = math.inf
    if start.are_known:
        d = sub(start.q, start.p)
        length = math.sqrt(dot(d, d))
    search = SearchState(
        views, direction.u, length, math.inf, aim.target + thin, aim.least + thin, math.inf
    )
    if not start.are_known:
        return search
    taken = taken_at(lent, start.p, start.q, direction, m, bodies, aim).taken
    return with_value(search, length - taken, taken, aim, thin)


@inline
def least_left(lent, body_a, body_b, frames, start, aim, tally):
    """What errors leave of a pair, where that is below the target.

    Args:
        lent: a `BudgetScene`, in which the rows of both bodies are filled. frames: how they lie. start: a `Start`.
    """
    scene = borrow(lent)
    a = b = scene.surface
    work, m = scene.state.work, frames.m
    found, scratch = work.found, work.scratch
    solid_a, solid_b = scene.world.solids[body_a], scene.world.solids[body_b]
    bodies = TwoBodies(body_a, body_b, a.roots[solid_a], b.roots[solid_b])
    slack = CHAIN_SLACK * rounding_slack(a, bodies.root_a, b, bodies.root_b, frames)
    sums_a, sums_b = found.sums[body_a], found.sums[body_b]
    thin = radii_of(a, solid_a, b, solid_b).both + sums_a[SURFACE] + sums_b[SURFACE]
    turn = max(sums_a[TURNED], sums_b[TURNED])
    reaches = _Reaches(slack, sums_a[REACH] + sums_b[REACH], turn, math.cos(turn), math.sin(turn))
    search = _begin(lent, start, m, bodies, aim, thin)
    lower_bound = math.inf
    scratch.nodes[0, 0], scratch.nodes[0, 1] = bodies.root_a, bodies.root_b
    scratch.bounds[0] = -math.inf
    n_waiting, n_looks = 1, 0
    while n_waiting > 0:
        n_waiting -= 1
        target = target_of(search, aim, n_looks)
        node_a, node_b = scratch.nodes[n_waiting, 0], scratch.nodes[n_waiting, 1]
        bound = scratch.bounds[n_waiting]
        if bound >= target:
            lower_bound = min(lower_bound, bound)
            continue
        if not (is_leaf(a, node_a) and is_leaf(b, node_b)):
            n_looks += 1
            n_waiting, passed = _look_at_group(
                a, b, node_a, node_b, search.views, reaches, target, n_waiting, work, tally
            )
            lower_bound = min(lower_bound, passed)
            continue
        face_a, face_b = np.int64(a.children[node_a, 0]), np.int64(b.children[node_b, 0])
        seen = _face_bound(a, face_a, b, face_b, search.views.a.direction, work.kept, slack)
        bound = max(bound, seen)
        if bound >= target:
            lower_bound = min(lower_bound, bound)
            continue
        n_looks += LOOK_AT_FACES
        looked = look_at_faces(
            lent, TwoFaces(face_a, face_b, m, bodies), bound, slack, search, aim, thin, tally
        )
        search = looked.search
        if looked.gives_up:
            return Left(-math.inf, search.least - thin, -math.inf, False, search.u)
    lower_bound = min(lower_bound, search.lower_bound)
    return Left(
        lower_bound - thin, search.least - thin, search.enough - thin, True, search.u
    )

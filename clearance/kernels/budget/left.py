"""The least that errors leave of the distance of two bodies, proven: both trees are descended once.

A node pair is done if its distance, less what the errors move both nodes along the direction of the nearest points
seen so far, or less what they move both bodies at all, stays above the target. Not for: two faces (`face_left`),
and which pairs and steps are asked (`sweep`).
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
    larger,
    least_of,
    marks_within,
)
from clearance.kernels.arithmetic.vec3 import Vec3, dot, sub
from clearance.kernels.budget.errors import BESIDE, REACH, SURFACE, TURNED
from clearance.kernels.budget.face_left import (
    SearchState,
    look_at_both,
    look_at_faces,
    look_beside,
    taken_at,
    target_of,
    turn_to,
    with_value,
)
from clearance.kernels.budget.pieces import TwoBodies, TwoFaces
from clearance.kernels.budget.reach import BodyReach, reach_of_body, reach_of_box
from clearance.kernels.budget.tilted import kept_of_box, kept_of_point
from clearance.kernels.features.bounds import (
    direction_between,
    lower_bound_boxes,
    lower_bound_boxes_along_direction,
    rounding_slack,
)
from clearance.kernels.mesh.corners import corners_at, greatest_in, least_in
from clearance.kernels.mesh.surface import box_of, group_of, is_leaf
from clearance.kernels.motion.certify_pair import CHAIN_SLACK, MOST_TURNED
from clearance.kernels.search.balls import radii_of
from clearance.kernels.search.front import OF_B, forget, keep, leave
from clearance.kernels.search.node_pairs import (
    NodeGroup,
    opened,
    pair_in_group,
    turned_away_while,
)
from clearance.kernels.search.scratch import STACK_DEPTH, swap, wait

KEPT = 1e-12
"""[m] Covers the rounding of a bound that is kept and taken up again."""

AS_NEAR = 0.9
"""Faces that are seen to be farther apart than this share of the nearest so far are not the nearest ones."""

FIRST_FACES = 3
"""Face pairs that a search looks at along their nearest points, whatever is seen beside: what occurs is below."""

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


class PairRemainder(NamedTuple):
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
def _node_bounds(p, q, side, view, kept, reaches, target):
    """[m] lower bounds on what is left of the distances of boxes in lanes, p of body `side`."""
    slack = reaches.slack
    left = lower_bound_boxes_along_direction(p, q, view.direction) - slack
    left = left - kept_of_box(p, side, kept) - kept_of_box(q, 1 - side, kept)
    if marks_within(left, target) == 0:
        return left
    apart = lower_bound_boxes(p, q, view.m, slack) - slack
    if not reaches.moves:
        return larger(left, apart - reaches.reach)
    own, across = (reaches.b, reaches.a) if side == 1 else (reaches.a, reaches.b)
    return larger(left, apart - reach_of_box(p, own) - reach_of_box(q, across))


@inline(force=True)
def _group_bounds(a, b, nodes, views, kept, reaches, target):
    """[m] the same of the nodes of a group and a node of the other body."""
    if nodes.is_of_b:
        p, q = group_of(b, nodes.group), box_of(a, nodes.other)
        return _node_bounds(p, q, 1, views.b, kept, reaches, target)
    p, q = group_of(a, nodes.group), box_of(b, nodes.other)
    return _node_bounds(p, q, 0, views.a, kept, reaches, target)


@inline(force=True)
def _face_bound(a, face_a, b, face_b, direction, kept, slack):
    """[m] a lower bound on what is left of two faces, along the tilted direction."""
    far, near = -math.inf, math.inf
    end = a.face_starts[face_a + 1]
    for c in range(a.face_starts[face_a], end, WIDTH):
        x = corners_at(a, c, end)
        far = max(far, greatest_in(dot(direction.u, x) + kept_of_point(x, 0, kept)))
    end = b.face_starts[face_b + 1]
    for c in range(b.face_starts[face_b], end, WIDTH):
        x = corners_at(b, c, end)
        near = min(near, least_in(dot(direction.v, x) - kept_of_point(x, 1, kept)))
    return near + direction.offset - far - slack


class _Reaches(NamedTuple):
    """[m] the rounding of distances, and how far errors move and turn [rad] both bodies at most.

    Attributes:
        moves: True where joints move: then nodes have a reach of their own, by that of each body.
    """

    slack: float
    reach: float
    moves: bool
    a: BodyReach
    b: BodyReach
    turn: float
    cos_turn: float
    sin_turn: float


class _GroupOutcome(NamedTuple):
    """What has become of the marked nodes of a group.

    Attributes:
        n_waiting: node pairs that wait now. marks: of the nodes that stay. low: [m] a bound on all that stay.
        passed: [m] a bound on those that are above the target.
    """

    n_waiting: int
    marks: int
    low: float
    passed: float


@inline(force=True)
def _let_wait(scene, nodes, marks, views, reaches, target, n_waiting, tally):
    """Lets those of a group wait that are not above the target; leaves stay as well and wait with ~a for a."""
    a = b = scene.surface
    work = scene.state.work
    slack, reach = reaches.slack, reaches.reach
    bounds = _group_bounds(a, b, nodes, views, work.kept, reaches, target)
    tally[2] += how_many(marks)
    within = marks & marks_within(bounds, target)
    passed = least_of(bounds, marks ^ within)
    low = passed
    if within and reaches.turn < MOST_TURNED:
        away = within & turned_away_while(
            a, b, views, nodes, slack, reaches.cos_turn, reaches.sin_turn, reach
        )
        low = min(low, least_of(bounds, away))
        within ^= away
    if n_waiting + WIDTH > STACK_DEPTH:
        raise AssertionError("no room for what waits")
    first = n_waiting
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
        n_waiting = wait(work.scratch, n_waiting, node_a, node_b, bound, first)
    return _GroupOutcome(n_waiting, marks, low, passed)


class _Queue(NamedTuple):
    """What waits when a search begins: entries of the front that stay, node pairs, [m] a bound on all else."""

    n_kept: int
    n_waiting: int
    lower_bound: float


@inline
def _resume(scene, pair, moved, views, reaches, target, tally):
    """Lets that part of a front wait that may have come near; the rest stays in it."""
    fronts, scratch = scene.state.fronts, scene.state.work.scratch
    start = fronts.spans[pair, 0]
    n_kept, n_waiting, nearest, lower_bound = 0, 0, 0, math.inf
    for i in range(start, start + fronts.spans[pair, 1]):
        carried = fronts.lower_bounds[i]
        if carried - moved >= target and i == start + n_kept:  # it lies there already
            lower_bound = min(lower_bound, carried - moved)
            n_kept += 1
            continue
        group, other, marks = (
            np.int64(fronts.entries[i, 0]),
            np.int64(fronts.entries[i, 1]),
            np.int64(fronts.entries[i, 2]),
        )
        if carried - moved < target:
            nodes = NodeGroup(marks >= OF_B, group, other)
            before = n_waiting
            found = _let_wait(scene, nodes, marks % OF_B, views, reaches, target, n_waiting, tally)
            n_waiting = found.n_waiting
            if n_waiting > before and scratch.bounds[n_waiting - 1] < scratch.bounds[nearest]:
                nearest = n_waiting - 1
            lower_bound = min(lower_bound, found.passed)
            if found.marks == 0:
                continue
            marks = found.marks + OF_B if nodes.is_of_b else found.marks
            carried = found.low + moved - KEPT
        else:
            lower_bound = min(lower_bound, carried - moved)
        to = start + n_kept
        fronts.entries[to, 0], fronts.entries[to, 1], fronts.entries[to, 2] = group, other, marks
        fronts.lower_bounds[to] = carried
        n_kept += 1
    if n_waiting > 0:  # nearest last
        swap(scratch, nearest, n_waiting - 1)
    return _Queue(n_kept, n_waiting, lower_bound)


@inline
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


@inline(force=True)
def _reaches_of(scene, bodies, solid_a, solid_b, slack):
    """([m] surfaces and balls of two bodies, how far errors move and turn both)."""
    surface, found = scene.surface, scene.state.work.found
    one, other = found.sums[bodies.a], found.sums[bodies.b]
    thin = radii_of(surface, solid_a, surface, solid_b).both + one[SURFACE] + other[SURFACE]
    turn = max(one[TURNED], other[TURNED])
    reach = one[REACH] + other[REACH]
    moves = one[BESIDE] >= 0.0 or other[BESIDE] >= 0.0
    own, across = reach_of_body(found, bodies.a), reach_of_body(found, bodies.b)
    return thin, _Reaches(slack, reach, moves, own, across, turn, math.cos(turn), math.sin(turn))


@inline
def _first(scene, pair, moved, bodies, search, reaches, aim, tally):
    """What waits first: what the front of the pair has left, or the roots."""
    if moved < math.inf and scene.state.fronts.spans[pair, 1] > 0:
        target = target_of(search, aim, 0)
        return _resume(scene, pair, moved, search.views, reaches, target, tally)
    scratch = scene.state.work.scratch
    scratch.nodes[0, 0], scratch.nodes[0, 1] = bodies.root_a, bodies.root_b
    scratch.bounds[0] = -math.inf
    return _Queue(0, 1, math.inf)


@inline
def least_left(lent, pair, moved, frames, start, aim, tally):
    """What errors leave of a pair, where that is below the target.

    Args:
        lent: a `BudgetScene`, in which the rows of both bodies are filled. frames: how they lie. start: a `Start`.
        moved: [m] what both bodies have moved in all; infinite where the front of the pair is not gone on from.
    """
    scene = lent
    a = b = scene.surface
    scratch, kept, m = scene.state.work.scratch, scene.state.work.kept, frames.m
    body_a, body_b = scene.world.pairs[pair, 0], scene.world.pairs[pair, 1]
    solid_a, solid_b = scene.world.solids[body_a], scene.world.solids[body_b]
    bodies = TwoBodies(body_a, body_b, a.roots[solid_a], b.roots[solid_b])
    slack = CHAIN_SLACK * rounding_slack(a, bodies.root_a, b, bodies.root_b, frames)
    thin, reaches = _reaches_of(scene, bodies, solid_a, solid_b, slack)
    search = _begin(lent, start, m, bodies, aim, thin)
    n_looks, n_left, n_faces = 0, 0, 0
    first = _first(scene, pair, moved, bodies, search, reaches, aim, tally)
    n_waiting, lower_bound = first.n_waiting, first.lower_bound
    while n_waiting > 0:
        n_waiting -= 1
        target = target_of(search, aim, n_looks)
        node_a = np.int64(scratch.nodes[n_waiting, 0])
        node_b = np.int64(scratch.nodes[n_waiting, 1])
        bound = scratch.bounds[n_waiting]
        is_kept = node_a < 0  # leaves, which the front has
        node_a = ~node_a if is_kept else node_a
        is_face = is_leaf(a, node_a) and is_leaf(b, node_b)
        if not is_kept and (is_face or bound >= target):
            one = NodeGroup(False, node_a // WIDTH, node_b)
            n_left = leave(scratch, n_left, one, 1 << node_a % WIDTH, bound + moved - KEPT)
        if bound >= target:
            lower_bound = min(lower_bound, bound)
            continue
        if not is_face:
            n_looks += 1
            nodes, count = opened(a, node_a, b, node_b)
            found = _let_wait(
                scene, nodes, (1 << count) - 1, search.views, reaches, target, n_waiting, tally
            )
            n_waiting, lower_bound = found.n_waiting, min(lower_bound, found.passed)
            if found.marks > 0:
                n_left = leave(scratch, n_left, nodes, found.marks, found.low + moved - KEPT)
            continue
        face_a, face_b = np.int64(a.children[node_a, 0]), np.int64(b.children[node_b, 0])
        bound = max(bound, _face_bound(a, face_a, b, face_b, search.views.a.direction, kept, slack))
        faces = TwoFaces(face_a, face_b, m, bodies)
        is_nearest = False
        if bound < target and n_faces >= FIRST_FACES:
            back, near = search.views.b.m, AS_NEAR * search.nearest
            beside = look_beside(lent, faces, back, slack, bound, near)
            bound, is_nearest = beside.bound, beside.is_nearest
        if bound >= target and not is_nearest:
            lower_bound = min(lower_bound, bound)
            continue
        n_looks += LOOK_AT_FACES
        n_faces += 1
        looked = look_at_faces(lent, faces, bound, slack, search, aim, thin, tally)
        search = looked.search
        if looked.gives_up:
            forget(scene.state.fronts, pair)
            return PairRemainder(-math.inf, search.least - thin, -math.inf, False, search.u)
    if moved < math.inf:
        keep(scene.state.fronts, pair, first.n_kept, scratch.left, scratch.lower_bounds, n_left)
    lower_bound = min(lower_bound, search.lower_bound) - thin
    return PairRemainder(lower_bound, search.least - thin, search.enough - thin, True, search.u)

"""The least that errors leave of the distance of two bodies, proven: both trees are descended once.

A node pair is done if its distance, less what the errors move both nodes along the direction of the nearest points
seen so far, or less what they move both bodies at all, stays above the target. A face pair is bounded along the
direction of its own nearest points, and in pieces where that is far below what occurs. Not for: which pairs and
steps are asked (`steps`, `intervals`).
"""

import math
from typing import NamedTuple

import numpy as np

from clearance.compile.jit import inline
from clearance.compile.kernel_table import borrow
from clearance.kernels.arithmetic.lanes import WIDTH, lane, larger, marks_within
from clearance.kernels.arithmetic.vec3 import dot, move, move_back, row
from clearance.kernels.budget.errors import REACH, SURFACE, TURNED, BodyRows
from clearance.kernels.budget.pieces import Pieces, TwoFaces, bound_of_pieces
from clearance.kernels.budget.reach import along_at_rest, reach_of_point
from clearance.kernels.budget.view import AlongRows, look_along, moved_of_box, moved_of_point
from clearance.kernels.features.bounds import (
    direction_between,
    lower_bound_boxes,
    lower_bound_boxes_along_direction,
    margin_of,
    rounding_slack,
)
from clearance.kernels.features.face_pair import nearest_of_faces, nothing_yet
from clearance.kernels.features.posed_pair import parts
from clearance.kernels.mesh.surface import box_of, group_of, is_leaf
from clearance.kernels.motion.certify_pair import CHAIN_SLACK, MOST_TURNED, STILL, allowed_gap
from clearance.kernels.search.balls import radii_of
from clearance.kernels.search.node_pairs import (
    Views,
    opened,
    pair_in_group,
    turned_away_while,
    views_along,
)
from clearance.kernels.search.scratch import STACK_DEPTH, Scratch, wait

REFINED = 0.05
"""The share of what errors take at the nearest points that a bound may stay below what it could be: that of a face
pair, and after `EXACT_LOOKS` groups of nodes that of the rest."""

EXACT_LOOKS = 48

FINEST = 1e-9
"""[m] No face pair is cut for less."""


class Aim(NamedTuple):
    """What is to be proven of a pair.

    Attributes:
        target: [m] what stays above it needs no look. least: [m] the least that is known to occur.
        gap: [m] how far the bound over an interval may stay below what occurs, 0 at a step. fail: [m] the limit.
        is_step: True where all stands: then the bound is as good as it can be made, and never given up.
    """

    target: float
    least: float
    gap: float
    fail: float
    is_step: bool


class Left(NamedTuple):
    """What is left of a pair.

    Attributes:
        lower_bound: [m] proven, or `target` where all is above it. least: [m] the least seen to occur, or as
            asked.
        completed: False where the target cannot be proven without a shorter interval.
        face_a, face_b: the faces that decide it, or -1.
    """

    lower_bound: float
    least: float
    completed: bool
    face_a: int
    face_b: int


class LeftScratch(NamedTuple):
    """What a search is made with: rows of errors, how they are seen along two directions, and scratch."""

    found: BodyRows
    seen: AlongRows
    own: AlongRows
    pieces: Pieces
    scratch: Scratch


class _Search(NamedTuple):
    """What a search has come to, of rigid bodies without balls and surfaces.

    Attributes:
        views: along the direction of the nearest points. nearest: [m] their distance.
        taken: [m] what errors take of that.
        lower_bound, target, least: as in `Left` and `Aim`. face_a, face_b: which decide the bound.
    """

    views: Views
    nearest: float
    taken: float
    lower_bound: float
    target: float
    least: float
    face_a: int
    face_b: int


@inline(force=True)
def _node_bounds(p, q, side, view, seen, reach, slack, target):
    """[m] lower bounds on what is left of the distances of boxes in lanes, p of body `side`."""
    direction = view.direction
    along = lower_bound_boxes_along_direction(p, q, direction) - slack
    if marks_within(along - reach, target) == 0:
        return along - reach
    moved = moved_of_box(q, 1 - side, direction.v, seen)
    left = along - moved - moved_of_box(p, side, direction.u, seen)
    if marks_within(left, target) == 0:
        return left
    apart = lower_bound_boxes(p, q, view.m, slack) - slack - reach
    return larger(left, apart)


@inline(force=True)
def _group_bounds(a, b, nodes, views, seen, reach, slack, target):
    """[m] the same of the nodes of a group and a node of the other body."""
    if nodes.is_of_b:
        p, q = group_of(b, nodes.group), box_of(a, nodes.other)
        return _node_bounds(p, q, 1, views.b, seen, reach, slack, target)
    p, q = group_of(a, nodes.group), box_of(b, nodes.other)
    return _node_bounds(p, q, 0, views.a, seen, reach, slack, target)


class _Faces(NamedTuple):
    """Two faces whole: [m] a bound on what is left, and their distance, along one direction."""

    bound: float
    apart: float


@inline(force=True)
def _along(a, face_a, b, face_b, direction, seen, slack):
    """What is left of two faces along a direction, in which the errors are seen."""
    u, v = direction.u, direction.v
    far = beyond = -math.inf
    for c in range(a.face_starts[face_a], a.face_starts[face_a + 1]):
        x = row(a.vertices, a.face_vertices[c])
        height = dot(u, x)
        far, beyond = max(far, height + moved_of_point(x, 0, u, seen)), max(beyond, height)
    first = before = math.inf
    for c in range(b.face_starts[face_b], b.face_starts[face_b + 1]):
        x = row(b.vertices, b.face_vertices[c])
        height = dot(v, x)
        first, before = min(first, height - moved_of_point(x, 1, v, seen)), min(before, height)
    return _Faces(
        first + direction.offset - far - slack, before + direction.offset - beyond - slack
    )


@inline(force=True)
def _reach_of_face(surface, face, found, body):
    """[m] how far the errors can move any point of a face."""
    reach = 0.0
    for c in range(surface.face_starts[face], surface.face_starts[face + 1]):
        x = row(surface.vertices, surface.face_vertices[c])
        reach = max(reach, reach_of_point(found, body, x))
    return reach


@inline(force=True)
def _turn_to(direction, m, body_a, body_b, work):
    """The views along a direction, and how errors are seen along it."""
    look_along(work.found, body_a, 0, direction.u, work.seen)
    look_along(work.found, body_b, 1, direction.v, work.seen)
    return views_along(direction, m)


class _Point(NamedTuple):
    """The nearest points of two faces: [m] what errors take there, and what motion takes beside them."""

    taken: float
    motion: float


@inline
def _at_points(near, direction, m, body_a, body_b, aim, work):
    """What is taken at the nearest points, along their direction."""
    u, v, q = direction.u, direction.v, move_back(m, near.q)
    whole = moved_of_point(near.p, 0, u, work.own) + moved_of_point(q, 1, v, work.own)
    if aim.is_step:
        return _Point(whole, 0.0)
    taken = along_at_rest(work.found, body_a, u, near.p) + along_at_rest(work.found, body_b, v, q)
    return _Point(taken, max(0.0, whole - taken))


@inline(one_caller=True)
def _look_at_faces(a, b, faces, body_a, body_b, bound, slack, search, aim, thin, work, tally):
    """(what a search has come to after two faces, True where it must be given up)."""
    m, found = faces.frames.m, work.found
    tally[3] += 1
    near = nearest_of_faces(a, faces.a, b, faces.b, m, margin_of(slack), nothing_yet(math.inf)).best
    direction = direction_between(near.p, near.q, m)
    look_along(found, body_a, 0, direction.u, work.own)
    look_along(found, body_b, 1, direction.v, work.own)
    whole = _along(a, faces.a, b, faces.b, direction, work.own, slack)
    length = math.sqrt(near.gap_sq)
    if whole.apart <= 0.0:  # they may touch
        reach = _reach_of_face(a, faces.a, found, body_a) + _reach_of_face(
            b, faces.b, found, body_b
        )
        search = _with_point(
            search, search.views, min(length, search.nearest), reach, -reach, aim, thin
        )
        return _with_bound(search, max(bound, -reach), faces, aim), False
    bound = max(bound, whole.bound)
    point = _at_points(near, direction, m, body_a, body_b, aim, work)
    value = length - point.taken
    views, nearest, taken = search.views, search.nearest, search.taken
    if length < nearest:
        nearest, taken = length, point.taken
        views = _turn_to(direction, m, body_a, body_b, work)
    search = _with_point(search, views, nearest, taken, value, aim, thin)
    near_by = max(FINEST, REFINED * point.taken)
    wanted = min(search.target, value - near_by) if aim.is_step else search.target
    if bound < search.target:
        reach = _reach_of_face(a, faces.a, found, body_a) + _reach_of_face(
            b, faces.b, found, body_b
        )
        bound = max(bound, whole.apart - reach)
    gives_up = False
    if bound < wanted:
        allowed = near_by if aim.is_step else allowed_gap(search.least - thin, aim.gap, aim.fail)
        still = aim.is_step or point.motion < STILL * allowed
        if still or value - point.motion >= wanted:
            both = TwoFaces(a, faces.a, b, faces.b, m, body_a, body_b)
            cut = bound_of_pieces(both, bound, found, work.own, slack, wanted, allowed, work.pieces)
            bound = max(bound, cut.lower_bound)
            search = _with_point(search, views, nearest, taken, cut.least, aim, thin)
        gives_up = bound < search.target and not still
    return _with_bound(search, bound, faces, aim), gives_up


@inline(force=True)
def _with_point(search, views, nearest, taken, value, aim, thin):
    """A search that has seen what occurs [m]; over an interval that moves the target."""
    least, target = search.least, search.target
    if not aim.is_step and value < least:
        least = value
        target = min(target, least - allowed_gap(least - thin, aim.gap, aim.fail))
    return _Search(
        views, nearest, taken, search.lower_bound, target, least, search.face_a, search.face_b
    )


@inline(force=True)
def _with_bound(search, bound, faces, aim):
    """A search that has a bound [m] on two faces; of a step that moves the target."""
    face_a, face_b = search.face_a, search.face_b
    if bound < search.lower_bound:
        face_a, face_b = faces.a, faces.b
    return _Search(
        search.views, search.nearest, search.taken, min(search.lower_bound, bound),
        min(search.target, bound) if aim.is_step else search.target, search.least, face_a, face_b,
    )  # fmt: skip


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
    bounds = _group_bounds(a, b, nodes, views, work.seen, reach, slack, target)
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


@inline
def least_left(bodies, body_a, body_b, witness_faces, aim, work, tally):
    """What errors leave of a pair, where that is below the target.

    Args:
        bodies: a `PosedPair` of solids, of surfaces in which every face owns all its features.
        body_a, body_b: their rows in `work.found`, a `LeftScratch`. witness_faces: (2,) to begin with, or -1.
    """
    a, b = borrow(bodies.surface_a), borrow(bodies.surface_b)
    found, scratch, m = work.found, work.scratch, bodies.frames.m
    roots = parts(bodies, a.roots[bodies.a], b.roots[bodies.b])
    slack = CHAIN_SLACK * rounding_slack(a, roots.a, b, roots.b, bodies.frames)
    sums_a, sums_b = found.sums[body_a], found.sums[body_b]
    thin = radii_of(a, bodies.a, b, bodies.b).both + sums_a[SURFACE] + sums_b[SURFACE]
    turn = max(sums_a[TURNED], sums_b[TURNED])
    reaches = _Reaches(slack, sums_a[REACH] + sums_b[REACH], turn, math.cos(turn), math.sin(turn))
    centres = direction_between(box_of(a, roots.a).centre, move(m, box_of(b, roots.b).centre), m)
    search = _Search(
        _turn_to(centres, m, body_a, body_b, work), math.inf, 0.0, math.inf,
        aim.target + thin, aim.least + thin, -1, -1,
    )  # fmt: skip
    first_a, first_b = witness_faces[0], witness_faces[1]
    lower_bound = math.inf
    scratch.nodes[0, 0], scratch.nodes[0, 1] = roots.a, roots.b
    scratch.bounds[0] = -math.inf
    n_waiting, n_looks = 1, 0
    if first_a >= 0:  # looked at before all nodes
        scratch.nodes[1, 0] = scratch.nodes[1, 1] = -1
        scratch.bounds[1] = -math.inf
        n_waiting = 2
    while n_waiting > 0:
        n_waiting -= 1
        target = search.target
        if aim.is_step and n_looks > EXACT_LOOKS:
            target -= REFINED * search.taken
        node_a, node_b = scratch.nodes[n_waiting, 0], scratch.nodes[n_waiting, 1]
        bound = scratch.bounds[n_waiting]
        if bound >= target:
            lower_bound = min(lower_bound, bound)
            continue
        is_first = node_a < 0
        if is_first or (is_leaf(a, node_a) and is_leaf(b, node_b)):
            face_a, face_b = np.int64(first_a), np.int64(first_b)
            if not is_first:
                face_a, face_b = np.int64(a.children[node_a, 0]), np.int64(b.children[node_b, 0])
                if face_a == first_a and face_b == first_b:
                    continue
                seen = _along(a, face_a, b, face_b, search.views.a.direction, work.seen, slack)
                bound = max(bound, seen.bound)
                if bound >= target:
                    lower_bound = min(lower_bound, bound)
                    continue
            faces = parts(bodies, face_a, face_b)
            search, gives_up = _look_at_faces(
                a, b, faces, body_a, body_b, bound, slack, search, aim, thin, work, tally
            )
            if gives_up:
                return Left(-math.inf, search.least - thin, False, face_a, face_b)
            continue
        n_looks += 1
        n_waiting, passed = _look_at_group(
            a, b, node_a, node_b, search.views, reaches, target, n_waiting, work, tally
        )
        lower_bound = min(lower_bound, passed)
    lower_bound = min(lower_bound, search.lower_bound)
    return Left(lower_bound - thin, search.least - thin, True, search.face_a, search.face_b)

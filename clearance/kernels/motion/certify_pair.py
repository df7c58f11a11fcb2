"""A proven lower bound on the distance of one pair while its bodies move about the middle of an interval.

Not for: which pairs and intervals are asked, and halving them (`certify`).
"""

import math
from typing import NamedTuple

import numpy as np

from clearance.compile.decorators import inline
from clearance.kernels.arithmetic.lanes import larger, marks_within
from clearance.kernels.features.bounds import (
    direction_beside,
    direction_between,
    lower_bound_boxes,
    lower_bound_boxes_along_direction,
    lower_bound_faces_along_direction,
    margin_of,
    rounding_slack,
)
from clearance.kernels.features.face_pair import may_meet, nearest_of_faces, nothing_yet
from clearance.kernels.features.meeting import meeting
from clearance.kernels.features.posed_pair import parts
from clearance.kernels.mesh.surface import box_of, group_of, is_leaf
from clearance.kernels.motion.joint_motion_bound import (
    PairMotion,
    motion_bound_of_box,
    motion_bound_of_box_along,
    motion_bound_of_face_along,
)
from clearance.kernels.search.balls import radii_of
from clearance.kernels.search.front import KEPT_DOWN
from clearance.kernels.search.node_pairs import (
    Views,
    opened,
    turned_away_while,
    views_along,
    wait_for_near,
)

FINEST = 1e-3
"""The share of the asked gap beyond which a limit that is touched is left undecided."""

STILL = 0.25
"""Where a body moves less than this share of the gap and the target is missed, rounding is to blame: halving
cannot help, and the bound stands as it is."""

CHAIN_SLACK = 8.0
"""Rounding slacks of a body pair that cover poses computed along a chain of links as well."""

MOST_TURNED = 0.25
"""[rad] Where a body turns farther in half an interval, its normals say little: cones stay below a right angle."""


class PairProof(NamedTuple):
    """What is known of a pair over an interval.

    Attributes:
        lower_bound: [m] proven lower bound over the interval, if the search was completed.
        least: [m] the least distance that was asked about, or one that was found in the middle.
        completed: False if the search was given up, because the target cannot be proven.
        face_a, face_b: the faces of those points, or -1.
    """

    lower_bound: float
    least: float
    completed: bool
    face_a: int
    face_b: int


class IntervalSearch(NamedTuple):
    """What a search has seen in the middle of an interval.

    Attributes:
        face_a, face_b: the nearest faces, or -1. nearest: [m] their distance. views: of the bodies along it.
        least: [m] what was asked about or seen. allowed: [m] how far below it the bound may stay.
    """

    face_a: int
    face_b: int
    nearest: float
    views: Views
    least: float
    allowed: float


class MovingPair(NamedTuple):
    """A pair of bodies that move.

    Attributes:
        motion: of both about the middle. slack: [m] what rounding can raise a bound by.
        balls: [m] the radii of the balls of both bodies; what is seen and bounded here is of their centres.
    """

    motion: PairMotion
    slack: float
    balls: float


@inline
def _moved(p, q, motion):
    """[m] how far two boxes move at most, added up."""
    moved = motion_bound_of_box(p, motion.a)
    if motion.b_moves:
        moved += motion_bound_of_box(q, motion.b)
    return moved


@inline
def _faces_moved_along(a, b, faces, direction, motion):
    """[m] how far two faces come towards one another along a direction at most."""
    moved = motion_bound_of_face_along(a, faces.a, direction.u, motion.a)
    if motion.b_moves:
        return moved + motion_bound_of_face_along(b, faces.b, direction.v, motion.b)
    return moved


@inline
def _node_lower_bounds(p, q, view, moving, target):
    """[m] lower bounds on the distances of boxes in lanes over the interval."""
    motion, slack = moving.motion, moving.slack
    direction = view.direction
    along_direction = (
        lower_bound_boxes_along_direction(p, q, direction)
        - slack
        - motion_bound_of_box_along(p, direction.u, motion.a)
    )
    if motion.b_moves:
        along_direction = along_direction - motion_bound_of_box_along(q, direction.v, motion.b)
    if marks_within(along_direction, target) == 0:
        return along_direction
    apart = lower_bound_boxes(p, q, view.m, slack) - slack - motion_bound_of_box(p, motion.a)
    if motion.b_moves:
        apart = apart - motion_bound_of_box(q, motion.b)
    return larger(along_direction, apart)


@inline
def _lower_bounds_of_group(a, b, nodes, view, moving, target):
    """[m] lower bounds on the distances of the nodes of a group to a node of the other body over the interval."""
    group, other = nodes.group, nodes.other
    if nodes.is_of_b:
        return _node_lower_bounds(box_of(a, other), group_of(b, group), view, moving, target)
    return _node_lower_bounds(group_of(a, group), box_of(b, other), view, moving, target)


@inline
def allowed_gap(least, gap, fail):
    """[m] how far below the least distance seen the bound may stay: less where that leaves `fail` undecided."""
    if least < fail:
        return gap
    return max(min(gap, 0.5 * (least - fail)), gap * FINEST)


@inline
def _begin(a, b, faces, least, aim, moving):
    """What is seen first: the faces that were nearest before, if any were."""
    m, margin = faces.frames.m, margin_of(moving.slack)
    best = nothing_yet(math.inf)
    if faces.a >= 0:
        best = nearest_of_faces(a, faces.a, b, faces.b, m, margin, best).best
        least = min(least, math.sqrt(best.gap_sq) + margin)
    views = views_along(direction_between(best.p, best.q, m), m)
    allowed = allowed_gap(least - moving.balls, aim.gap, aim.fail)
    return IntervalSearch(faces.a, faces.b, math.sqrt(best.gap_sq), views, least, allowed)


@inline
def _meet(a, b, faces, margin, scratch):
    """True if two faces have a point in common, by exact signs."""
    if not may_meet(a, faces.a, b, faces.b, faces.frames.m, margin):
        return False
    return meeting(faces, scratch.exact).found


@inline
def _face_lower_bound(a, b, faces, direction, moving):
    """[m] a lower bound on the distance of two faces over the interval, seen along one direction."""
    apart = lower_bound_faces_along_direction(a, faces.a, b, faces.b, direction) - moving.slack
    return apart - _faces_moved_along(a, b, faces, direction, moving.motion)


@inline
def _look_at_faces(a, b, faces, bound, moving, search, aim, scratch, tally):
    """([m] a lower bound on the faces' distance over the interval, what is seen then, True if they touch).

    Many arguments: it is inlined into its one caller, whose locals they are.
    """
    face_a, face_b, m = faces.a, faces.b, faces.frames.m
    slack, margin, views = moving.slack, margin_of(moving.slack), search.views
    target = search.least - search.allowed
    touches = False
    bound = max(bound, _face_lower_bound(a, b, faces, views.a.direction, moving))
    if bound < target:
        beside = direction_beside(a, face_a, b, face_b, m, views.b.m)
        apart = _face_lower_bound(a, b, faces, beside, moving)
        if apart > 0.0:  # exact signs below decide what may touch
            bound = max(bound, apart)
    if bound < target:
        tally[3] += 1
        near = nearest_of_faces(a, face_a, b, face_b, m, margin, nothing_yet(math.inf)).best
        own = direction_between(near.p, near.q, m)
        apart = lower_bound_faces_along_direction(a, face_a, b, face_b, own) - slack
        if apart <= 0.0 and _meet(a, b, faces, margin, scratch):
            touches = True
        else:
            bound = max(bound, apart - _faces_moved_along(a, b, faces, own, moving.motion))
            least, allowed, seen = search.least, search.allowed, math.sqrt(near.gap_sq)
            if seen + margin < least:
                least = seen + margin
                allowed = allowed_gap(least - moving.balls, aim.gap, aim.fail)
            if seen < search.nearest:
                search = IntervalSearch(face_a, face_b, seen, views_along(own, m), least, allowed)
            else:
                search = IntervalSearch(
                    search.face_a, search.face_b, search.nearest, views, least, allowed
                )
    return bound, search, touches


@inline
def _balls_touch(search, balls):
    """True if centres of balls were seen so near that nothing is left to prove."""
    return balls > 0.0 and search.least <= balls


@inline
def _seen_of_balls(search, asked, balls):
    """[m] the least distance that was asked about, or that of balls whose centres were seen nearer."""
    return search.least - balls if search.least < asked + balls else asked


@inline
def hold(bodies, witness_faces, motion, least, aim, scratch, tally):
    """A lower bound over the interval for one pair, within the allowed gap below `least` or what is found.

    The search is given up where that cannot be proven, unless the bodies stand still.

    Args:
        bodies: of surfaces in which every face owns all its features, so that a face pair is seen whole.
        witness_faces: (2,) the faces that were nearest before, or -1.
        motion: a `PairMotion`. least: [m] asked about. aim: a `CertificateGoal`.
    """
    a, b = bodies.surface_a, bodies.surface_b
    roots = parts(bodies, a.roots[bodies.a], b.roots[bodies.b])
    slack = CHAIN_SLACK * rounding_slack(a, roots.a, b, roots.b, bodies.frames)
    balls = radii_of(a, bodies.a, b, bodies.b).both
    moving = MovingPair(motion, slack, balls)
    moved = _moved(box_of(a, roots.a), box_of(b, roots.b), motion)
    turn = max(motion.a.turn, motion.b.turn)  # by which the normals of either turn at most
    cos_turn, sin_turn = math.cos(turn), math.sin(turn)
    near = parts(bodies, witness_faces[0], witness_faces[1])
    search = _begin(a, b, near, least + balls, aim, moving)
    lower_bound = math.inf
    scratch.nodes[0, 0], scratch.nodes[0, 1] = roots.a, roots.b
    scratch.bounds[0] = -math.inf
    n_waiting = 1
    while n_waiting > 0:
        if _balls_touch(search, balls):
            return PairProof(0.0, 0.0, True, search.face_a, search.face_b)
        n_waiting -= 1
        target = search.least - search.allowed
        node_a, node_b = (
            np.int64(scratch.nodes[n_waiting, 0]),
            np.int64(scratch.nodes[n_waiting, 1]),
        )
        bound = scratch.bounds[n_waiting]
        if bound >= target:
            lower_bound = min(lower_bound, bound)
            continue
        if is_leaf(a, node_a) and is_leaf(b, node_b):
            faces = parts(bodies, np.int64(a.children[node_a, 0]), np.int64(b.children[node_b, 0]))
            bound, search, touches = _look_at_faces(
                a, b, faces, bound, moving, search, aim, scratch, tally
            )
            if touches or _balls_touch(search, balls):
                return PairProof(0.0, 0.0, True, faces.a, faces.b)
            lower_bound = min(lower_bound, bound)
            if bound < search.least - search.allowed and moved >= STILL * search.allowed:
                seen = _seen_of_balls(search, least, balls)
                return PairProof(0.0, seen, False, search.face_a, search.face_b)
            continue
        nodes, count = opened(a, node_a, b, node_b)
        bounds = _lower_bounds_of_group(a, b, nodes, search.views.a, moving, target)
        tally[2] += count
        away = 0
        if turn < MOST_TURNED and marks_within(bounds, target):
            away = turned_away_while(a, b, search.views, nodes, slack, cos_turn, sin_turn, moved)
        marks = ((1 << count) - 1) & ~away
        n_waiting, passed = wait_for_near(scratch, n_waiting, nodes, bounds, marks, target)
        lower_bound = min(lower_bound, passed)
    if balls > 0.0:
        lower_bound = max(0.0, (lower_bound - balls) * KEPT_DOWN)
    seen = _seen_of_balls(search, least, balls)
    return PairProof(lower_bound, seen, True, search.face_a, search.face_b)

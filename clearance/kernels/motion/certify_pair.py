"""A proven lower bound on the distance of one pair while its link moves about the middle of an interval.

Not for: which pairs and intervals are asked, and halving them (`certify`).
"""

import math
from typing import NamedTuple

import numpy as np

from clearance.compile.jit import inline
from clearance.compile.kernel_table import lend
from clearance.kernels.arithmetic.lanes import WIDTH, lane, larger, marks_within
from clearance.kernels.arithmetic.vec3 import inverse
from clearance.kernels.features.bounds import (
    direction_beside,
    direction_between,
    lower_bound_boxes,
    lower_bound_boxes_along_direction,
    lower_bound_faces_along_direction,
    rounding_slack,
)
from clearance.kernels.features.face_pair import may_meet, nearest_of_faces
from clearance.kernels.features.meeting import meeting_of
from clearance.kernels.mesh.surface import box_of, group_of, is_leaf
from clearance.kernels.motion.joint_motion_bound import (
    motion_bound_of_box,
    motion_bound_of_box_along,
    motion_bound_of_face_along,
)
from clearance.kernels.search.descent import margin_of, nothing_yet
from clearance.kernels.search.node_pairs import (
    opened,
    pair_in_group,
    turned_away_while,
    views_along,
)
from clearance.kernels.search.scratch import STACK_DEPTH, wait

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


@inline
def _node_lower_bounds(p, q, m, direction, slack, motion_bound, target):
    """[m] lower bounds on the distances of boxes in lanes over the interval."""
    along_direction = (
        lower_bound_boxes_along_direction(p, q, direction)
        - slack
        - motion_bound_of_box_along(p, direction.u, motion_bound)
    )
    if marks_within(along_direction, target) == 0:
        return along_direction
    apart = lower_bound_boxes(p, q, m, slack) - slack
    return larger(along_direction, apart - motion_bound_of_box(p, motion_bound))


@inline
def _lower_bounds_of_group(a, b, group, other, is_b, m, direction, slack, motion_bound, target):
    """[m] lower bounds on the distances of the nodes of a group to a node of the other body over the interval."""
    if is_b:
        return _node_lower_bounds(
            box_of(a, other), group_of(b, group), m, direction, slack, motion_bound, target
        )
    return _node_lower_bounds(
        group_of(a, group), box_of(b, other), m, direction, slack, motion_bound, target
    )


@inline
def allowed_gap(least, gap, fail):
    """[m] how far below the least distance seen the bound may stay: less where that leaves `fail` undecided."""
    if least < fail:
        return gap
    return max(min(gap, 0.5 * (least - fail)), gap * FINEST)


@inline
def hold(
    a,
    body_a,
    b,
    body_b,
    frames,
    motion_bound,
    least,
    gap,
    fail,
    witness_face_a,
    witness_face_b,
    scratch,
    tally,
    table,
):
    """A lower bound over the interval for one pair, within the allowed gap below `least` or what is found.

    The search is given up where that cannot be proven, unless the body stands still.

    `a` and `b` are surfaces in which every face owns all its features, so that a face pair is seen whole.
    """
    m = frames.m
    m_back = inverse(m)
    root_a, root_b = a.roots[body_a], b.roots[body_b]
    slack = CHAIN_SLACK * rounding_slack(a, root_a, b, root_b, frames)
    margin = margin_of(slack)
    moved = motion_bound_of_box(box_of(a, root_a), motion_bound)
    cos_turn, sin_turn = math.cos(motion_bound.turn), math.sin(motion_bound.turn)
    near_a, near_b = witness_face_a, witness_face_b
    best = nothing_yet(math.inf)
    if witness_face_a >= 0:
        best = nearest_of_faces(a, witness_face_a, b, witness_face_b, m, margin, best).best
        least = min(least, math.sqrt(best.gap_sq) + margin)
    nearest = math.sqrt(best.gap_sq)
    allowed = allowed_gap(least, gap, fail)
    target = least - allowed
    direction = direction_between(best.p, best.q, m)
    from_a, from_b = views_along(direction, m)
    lower_bound = math.inf
    scratch.nodes[0, 0], scratch.nodes[0, 1] = root_a, root_b
    scratch.bounds[0] = -math.inf
    n_waiting = 1
    while n_waiting > 0:
        n_waiting -= 1
        node_a, node_b = scratch.nodes[n_waiting, 0], scratch.nodes[n_waiting, 1]
        bound = scratch.bounds[n_waiting]
        if bound >= target:
            lower_bound = min(lower_bound, bound)
            continue
        if is_leaf(a, node_a) and is_leaf(b, node_b):
            face_a, face_b = np.int64(a.children[node_a, 0]), np.int64(b.children[node_b, 0])
            bound = max(
                bound, _face_lower_bound(a, face_a, b, face_b, direction, slack, motion_bound)
            )
            if bound < target:
                beside = direction_beside(a, face_a, b, face_b, m, m_back)
                apart = _face_lower_bound(a, face_a, b, face_b, beside, slack, motion_bound)
                bound = (
                    max(bound, apart) if apart > 0.0 else bound
                )  # what may touch is told by exact signs below
            if bound < target:
                tally[3] += 1
                near = nearest_of_faces(a, face_a, b, face_b, m, margin, nothing_yet(math.inf)).best
                own = direction_between(near.p, near.q, m)
                apart = lower_bound_faces_along_direction(a, face_a, b, face_b, own) - slack
                if apart <= 0.0 and _meet(a, face_a, b, face_b, frames, margin, scratch, table):
                    return PairProof(0.0, 0.0, True, face_a, face_b)
                bound = max(
                    bound, apart - motion_bound_of_face_along(a, face_a, own.u, motion_bound)
                )
                seen = math.sqrt(near.gap_sq)
                if seen < nearest:
                    nearest, near_a, near_b, direction = seen, face_a, face_b, own
                    from_a, from_b = views_along(direction, m)
                if seen + margin < least:
                    least = seen + margin
                    allowed = allowed_gap(least, gap, fail)
                    target = least - allowed
            lower_bound = min(lower_bound, bound)
            if bound < target and moved >= STILL * allowed:
                return PairProof(0.0, least, False, near_a, near_b)
            continue
        is_b, group, count, other = opened(a, node_a, b, node_b)
        lower_bounds = _lower_bounds_of_group(
            a, b, group, other, is_b, m, direction, slack, motion_bound, target
        )
        tally[2] += count
        away = 0
        if motion_bound.turn < MOST_TURNED and marks_within(lower_bounds, target):
            away = turned_away_while(
                a, b, from_a, from_b, group, other, is_b, slack, cos_turn, sin_turn, moved
            )
        assert n_waiting + WIDTH <= STACK_DEPTH
        first = n_waiting
        for k in range(count):
            if away >> k & 1:
                continue
            bound = lane(lower_bounds, k)
            if bound >= target:
                lower_bound = min(lower_bound, bound)
                continue
            node_a, node_b = pair_in_group(is_b, group, k, other)
            n_waiting = wait(scratch, n_waiting, node_a, node_b, bound, first)
    return PairProof(lower_bound, least, True, near_a, near_b)


@inline
def _meet(a, face_a, b, face_b, frames, margin, scratch, table):
    """True if two faces have a point in common, by exact signs."""
    if not may_meet(a, face_a, b, face_b, frames.m, margin):
        return False
    return meeting_of(table, lend(a), face_a, lend(b), face_b, frames, scratch.exact).found


@inline
def _face_lower_bound(a, face_a, b, face_b, direction, slack, motion_bound):
    """[m] a lower bound on the distance of two faces over the interval, seen along one direction."""
    apart = lower_bound_faces_along_direction(a, face_a, b, face_b, direction) - slack
    return apart - motion_bound_of_face_along(a, face_a, direction.u, motion_bound)

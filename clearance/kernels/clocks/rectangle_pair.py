"""One pair over one rectangle of two clocks' times: a lower bound, and how far either body moves there.

Where both sides are whole nodes, boxes come first; over spans of several intervals, corners and separating planes
come next; the search about the middle (`twist`) comes last. Not for: which rectangles and pairs are
looked at, and halving them (`unsynchronised`).
"""

from typing import NamedTuple

import numpy as np

from clearance.compile.decorators import inline
from clearance.kernels.arithmetic.double_double import frames_of
from clearance.kernels.arithmetic.vec3 import rigid
from clearance.kernels.clocks.clock_rectangles import RectangleStack, is_whole
from clearance.kernels.clocks.clock_tree import is_leaf_of_clock, motion_of_node, row_in_middle
from clearance.kernels.clocks.two_clocks import apart_by_planes, corners_apart
from clearance.kernels.features.posed_pair import PosedPair
from clearance.kernels.mesh.surface import box_of
from clearance.kernels.motion.body_boxes import bound_between
from clearance.kernels.motion.interval_middle import (
    IntervalMiddle,
    begin_arcs,
    loosened_motion_bound_in,
)
from clearance.kernels.motion.joint_motion_bound import PairMotion, motion_bound_of_box
from clearance.kernels.motion.placed import GROWTH
from clearance.kernels.motion.twist import CertificateGoal, prove_while_moving
from clearance.kernels.search.carried import Carried, no_front
from clearance.kernels.search.proof import CHAIN_SLACK
from clearance.kernels.search.scratch import Scratch

OUTWARD = 1.0 + 1e-12
"""Covers the rounding of a sum of a few lengths."""


class RectangleState(NamedTuple):
    """What a search over rectangles knows, and scratch.

    Attributes:
        gaps: (m,) [m] allowed in each interval. n_looked_at: (m,) rectangles that were.
        lower_bounds: (nodes,) [m] proven for all that was closed at a node of clock a.
        carried: the faces of all pairs that were nearest.
        part_a, part_b: the middle of a part of an interval. at: (2, 3) which: leaf, low, high.
        tally: (5,) counts, as in `certify_unsynchronised`.
    """

    waiting: RectangleStack
    gaps: np.ndarray
    n_looked_at: np.ndarray
    lower_bounds: np.ndarray
    carried: Carried
    part_a: IntervalMiddle
    part_b: IntervalMiddle
    at: np.ndarray
    scratch: Scratch
    tally: np.ndarray


class RectangleGoal(NamedTuple):
    """What is asked of a rectangle.

    Attributes:
        least: [m] the least distance seen in its intervals of clock a, the greatest of these.
        target: [m] what is to be proven.
        aim: with the gap that is allowed below `least` here.
        is_fine: True if neither side is of several intervals.
        counts: True if a distance in the middle is one of an only interval of clock a, at times in the band.
    """

    least: float
    target: float
    aim: CertificateGoal
    is_fine: bool
    counts: bool


class PairLook(NamedTuple):
    """What a look at a pair in a rectangle comes to: a bound and the least distance [m], True if that is enough,
    and how far either body moves from the middle [m]."""

    lower_bound: float
    least: float
    is_done: bool
    moved_a: float
    moved_b: float


@inline
def _side_of(surface, clocks, tree, body, node, whole, part):
    """(where a body is in the middle of a side of a rectangle, its motion bound, [m] how far it moves)."""
    world, column = clocks.world, clocks.columns[body]
    if whole:
        pose = rigid(tree.poses[row_in_middle(tree, node, column)])
        return pose, motion_of_node(tree, node, column), tree.moved[node, column]
    balls = clocks.path.balls
    begin_arcs(
        world.links, balls, tree.start + tree.first[node]
    )  # the other side may have had them
    motion = loosened_motion_bound_in(surface, world, balls, body, part)
    box = box_of(surface, surface.roots[world.solids[body]])
    return rigid(part.poses[world.frames[body]]), motion, GROWTH * motion_bound_of_box(box, motion)


@inline
def _bound_by_boxes(clocks, rectangle, pair, target):
    """[m] a lower bound on the distance of a pair over a rectangle of whole nodes; one of `target` will do."""
    tree_a, tree_b, pairs = clocks.tree_a, clocks.tree_b, clocks.world.pairs
    column_a, column_b = clocks.columns[pairs[pair, 0]], clocks.columns[pairs[pair, 1]]
    row_a = row_in_middle(tree_a, rectangle.node_a, column_a)
    row_b = row_in_middle(tree_b, rectangle.node_b, column_b)
    moved = tree_a.moved[rectangle.node_a, column_a] + tree_b.moved[rectangle.node_b, column_b]
    moved += CHAIN_SLACK * (tree_a.boxes.slacks[row_a] + tree_b.boxes.slacks[row_b])
    return bound_between(tree_a.boxes, row_a, tree_b.boxes, row_b, target + moved) - moved


@inline
def _settled_coarsely(surface, bodies, faces, moved, target, scratch):
    """(a bound [m], True if it is enough or none can be) of a pair over spans of several intervals.

    Args:
        moved: [m] how far both bodies move from where they are.
    """
    limit = (target + moved) * OUTWARD
    a, b = bodies.frames.a, bodies.frames.b
    if corners_apart(surface, faces, a, b) < limit:
        return 0.0, True
    planes = apart_by_planes(surface, bodies, faces, limit, scratch)
    if planes > limit:
        return planes - moved, True
    return 0.0, corners_apart(surface, faces, a, b) < limit


@inline
def look_at_pair(lent, surface, clocks, rectangle, pair, goal, state):
    """What holds of a pair over a rectangle, as a `PairLook`; `lent` is `surface`, lent."""
    r, world, tally = rectangle, clocks.world, state.tally
    body_a, body_b = world.pairs[pair, 0], world.pairs[pair, 1]
    whole_a, whole_b = is_whole(r.low_a, r.high_a), is_whole(r.low_b, r.high_b)
    if whole_a and whole_b:
        bound = _bound_by_boxes(clocks, r, pair, goal.target)
        if bound >= goal.target:
            tally[1] += 1
            return PairLook(bound, goal.least, True, 0.0, 0.0)
    pose_a, motion_a, moved_a = _side_of(
        surface, clocks, clocks.tree_a, body_a, r.node_a, whole_a, state.part_a
    )
    pose_b, motion_b, moved_b = _side_of(
        surface, clocks, clocks.tree_b, body_b, r.node_b, whole_b, state.part_b
    )
    bodies = PosedPair(
        lent, world.solids[body_a], lent, world.solids[body_b], frames_of(pose_a, pose_b)
    )
    faces = state.carried.faces[pair]
    one_a = is_leaf_of_clock(clocks.tree_a, r.node_a)
    if not goal.is_fine and (moved_b > moved_a or not one_a):  # else it may be halved for ever
        bound, settled = _settled_coarsely(
            surface, bodies, faces, moved_a + moved_b, goal.target, state.scratch
        )
        if settled:
            return PairLook(bound, goal.least, bound >= goal.target, moved_a, moved_b)
    tally[2] += 1
    motion = PairMotion(motion_a, motion_b, True)
    front = no_front(state.carried)
    proof = prove_while_moving(bodies, faces, motion, goal.least, goal.aim, front, state.scratch)
    tally[3] += proof.n_nodes
    tally[4] += proof.n_faces
    is_done = proof.is_complete and (goal.counts or proof.lower_bound >= goal.target)
    return PairLook(proof.lower_bound, proof.least, is_done, moved_a, moved_b)

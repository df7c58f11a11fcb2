"""One pair over one rectangle of two clocks' times: a lower bound, and the motion of either body there.

Where both sides are whole nodes, boxes come first; over spans of several intervals, corners and separating planes
come next; the search about the middle (`twist`) comes last. Not for: choosing rectangles and pairs, and halving
them (`unsynchronised`).
"""

from typing import NamedTuple

import numpy as np

from clearance.compile.decorators import inline
from clearance.kernels.arithmetic.double_double import frames_of
from clearance.kernels.arithmetic.vec3 import rigid
from clearance.kernels.clocks.clock_rectangles import RectangleStack, is_whole
from clearance.kernels.clocks.clock_tree import is_leaf_of_clock, motion_of_node, row_in_middle
from clearance.kernels.clocks.two_clocks import bound_coarsely
from clearance.kernels.features.posed_pair import PosedPair
from clearance.kernels.mesh.surface import box_of
from clearance.kernels.motion.body_boxes import bound_between
from clearance.kernels.motion.interval_middle import (
    IntervalMiddle,
    begin_arcs,
    motion_bound_in,
)
from clearance.kernels.motion.joint_motion_bound import PairMotion, motion_bound_of_box
from clearance.kernels.motion.placed import GROWTH
from clearance.kernels.motion.twist import CertificateGoal, prove_while_moving
from clearance.kernels.motion.world import pose_of
from clearance.kernels.search.carried import Carried, no_front
from clearance.kernels.search.proof import CHAIN_SLACK
from clearance.kernels.search.scratch import Scratch

OUTWARD = 1.0 + 1e-12
"""Covers the rounding of a sum of a few lengths."""


class RectangleState(NamedTuple):
    """The state of a search over rectangles, and scratch.

    Attributes:
        gaps: (m,) [m] allowed in each interval. n_visits: (m,) visited rectangles.
        lower_bounds: (nodes,) [m] proven at each node of clock a.
        carried: the witness faces of all pairs.
        part_a, part_b: the middle of a part of an interval. at: (2, 3) its leaf, low, high.
        tally: (5,) counts, as in `certify_unsynchronised`.
    """

    waiting: RectangleStack
    gaps: np.ndarray
    n_visits: np.ndarray
    lower_bounds: np.ndarray
    carried: Carried
    part_a: IntervalMiddle
    part_b: IntervalMiddle
    at: np.ndarray
    scratch: Scratch
    tally: np.ndarray


class RectangleGoal(NamedTuple):
    """The bound to prove in a rectangle.

    Attributes:
        least: [m] the least distance seen in each of its intervals of clock a, the greatest of these.
        target: [m] the bound to prove.
        aim: with the gap allowed below `least` here.
        is_fine: True if neither side has several intervals.
        counts: True if the middle is in one interval of clock a, at times in the band: its distance occurs.
    """

    least: float
    target: float
    aim: CertificateGoal
    is_fine: bool
    counts: bool


class PairInRectangle(NamedTuple):
    """The result for a pair in a rectangle: a bound and the least distance [m], True if the bound is enough, and
    the motion of either body from the middle [m]."""

    lower_bound: float
    least: float
    is_done: bool
    moved_a: float
    moved_b: float


@inline
def _side_of(surface, clocks, tree, body, span, part):
    """(the pose of a body in the middle of a side of a rectangle, its motion bound, [m] its greatest motion)."""
    world, column, node = clocks.world, clocks.columns[body], span.node
    if is_whole(span):
        pose = rigid(tree.poses[row_in_middle(tree, node, column)])
        return pose, motion_of_node(tree, node, column), tree.moved[node, column]
    balls = clocks.path.balls
    begin_arcs(
        world.links, balls, tree.start + tree.first[node]
    )  # the other side may have overwritten them
    motion = motion_bound_in(surface, world, balls, body, part)
    box = box_of(surface, surface.roots[world.solids[body]])
    return pose_of(world, body, part.poses), motion, GROWTH * motion_bound_of_box(box, motion)


@inline
def _bound_by_boxes(clocks, rectangle, pair, target):
    """[m] a lower bound on the distance of a pair over a rectangle of whole nodes; `target` is enough."""
    tree_a, tree_b, pairs = clocks.tree_a, clocks.tree_b, clocks.world.pairs
    column_a, column_b = clocks.columns[pairs[pair, 0]], clocks.columns[pairs[pair, 1]]
    node_a, node_b = rectangle.a.node, rectangle.b.node
    row_a, row_b = row_in_middle(tree_a, node_a, column_a), row_in_middle(tree_b, node_b, column_b)
    moved = tree_a.moved[node_a, column_a] + tree_b.moved[node_b, column_b]
    moved += CHAIN_SLACK * (tree_a.boxes.slacks[row_a] + tree_b.boxes.slacks[row_b])
    return bound_between(tree_a.boxes, row_a, tree_b.boxes, row_b, target + moved) - moved


@inline
def prove_in_rectangle(surface, clocks, rectangle, pair, goal, state):
    """The `PairInRectangle` of a pair; `surface` is lent."""
    r, world, tally = rectangle, clocks.world, state.tally
    body_a, body_b = world.pairs[pair, 0], world.pairs[pair, 1]
    if is_whole(r.a) and is_whole(r.b):
        bound = _bound_by_boxes(clocks, r, pair, goal.target)
        if bound >= goal.target:
            tally[1] += 1
            return PairInRectangle(bound, goal.least, True, 0.0, 0.0)
    pose_a, motion_a, moved_a = _side_of(surface, clocks, clocks.tree_a, body_a, r.a, state.part_a)
    pose_b, motion_b, moved_b = _side_of(surface, clocks, clocks.tree_b, body_b, r.b, state.part_b)
    bodies = PosedPair(
        surface, world.solids[body_a], surface, world.solids[body_b], frames_of(pose_a, pose_b)
    )
    faces = state.carried.faces[pair]
    one_a = is_leaf_of_clock(clocks.tree_a, r.a.node)
    if not goal.is_fine and (moved_b > moved_a or not one_a):  # else halving might never end
        moved = moved_a + moved_b
        limit = (goal.target + moved) * OUTWARD
        planes, is_near = bound_coarsely(surface, bodies, faces, limit, -1.0, state.scratch)
        if planes > limit or is_near:  # no bound beyond the distance of corners can be
            bound = 0.0 if is_near else planes - moved
            return PairInRectangle(bound, goal.least, bound >= goal.target, moved_a, moved_b)
    tally[2] += 1
    motion = PairMotion(motion_a, motion_b, True)
    front = no_front(state.carried)
    proof = prove_while_moving(bodies, faces, motion, goal.least, goal.aim, front, state.scratch)
    tally[3] += proof.n_nodes
    tally[4] += proof.n_faces
    is_done = proof.is_complete and (goal.counts or proof.lower_bound >= goal.target)
    return PairInRectangle(proof.lower_bound, proof.least, is_done, moved_a, moved_b)

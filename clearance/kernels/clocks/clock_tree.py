"""A tree of motion bounds over the time of one clock, in spans that are halved again and again.

A leaf is a step, or the interval between two steps; a node is a span of leaves. A node has the pose of each body
in its middle leaf, and the greatest motion of the body's points from there over the whole span. The tree is made
once. A search over the times of two clocks (`unsynchronised`) reads the motion of both bodies of a pair from it.
Not for: parts of an interval (`interval_middle`).
"""

import math
from typing import NamedTuple

import numpy as np

from clearance.compile.declared import Floats, Floats2, Floats3, Integers
from clearance.compile.decorators import inline, kernel
from clearance.kernels.arithmetic.vec3 import Vec3, rigid
from clearance.kernels.features.bounds import displacement
from clearance.kernels.mesh.surface import Surface, box_of
from clearance.kernels.motion.body_boxes import BodyBoxes, new_body_boxes, place_box
from clearance.kernels.motion.interval_middle import (
    begin_arcs,
    go_to_middle,
    motion_bound_at,
    motion_bound_in,
    new_middle,
    note_motion_bound,
)
from clearance.kernels.motion.joint_motion_bound import MotionBound, motion_bound_of_box
from clearance.kernels.motion.joint_path import JointPath
from clearance.kernels.motion.kinematics import copy_pose
from clearance.kernels.motion.placed import GROWTH
from clearance.kernels.motion.world import World

ANY_TURN = math.pi
"""[rad] The greatest turn that there is."""


class ClockTree(NamedTuple):
    """Spans of one clock's time, the root first, both halves of a span one after the other.

    Attributes:
        start: the step or interval that is leaf 0.
        first, last: (nodes,) the leaves of each node are those from `first` to before `last`.
        earlier: (nodes,) its earlier half; the later one follows it. -1 for a leaf.
        low, high: (nodes,) [s] when it begins and ends. middle: (nodes,) [s] the time of its middle leaf: the
            step, or the middle of the interval.
        moved: (nodes, k) [m] the greatest motion of each of the k bodies of the clock from its pose in the middle
            leaf.
        poses: (leaves * k, 4, 4) `world_from_body` [m] at the step or in the middle of the interval.
        motion_bounds: (leaves * k, 8) numbers of the `MotionBound` about it; zeros for a step.
        boxes: (leaves * k) of the bodies there.
    """

    start: int
    first: Integers
    last: Integers
    earlier: Integers
    low: Floats
    high: Floats
    middle: Floats
    moved: Floats2
    poses: Floats3
    motion_bounds: Floats2
    boxes: BodyBoxes


@inline
def new_clock_tree(start, n_leaves, n_bodies):
    """An empty tree of so many leaves."""
    n_nodes, n_rows = 2 * n_leaves - 1, n_leaves * n_bodies
    return ClockTree(
        start, np.empty(n_nodes, dtype=np.int64), np.empty(n_nodes, dtype=np.int64),
        np.empty(n_nodes, dtype=np.int64), np.empty(n_nodes), np.empty(n_nodes), np.empty(n_nodes),
        np.empty((n_nodes, n_bodies)),
        np.empty((n_rows, 4, 4)), np.zeros((n_rows, 8)), new_body_boxes(n_rows),
    )  # fmt: skip


@inline(force=True)
def n_leaves_of(tree):
    """The number of its steps or intervals."""
    return (len(tree.first) + 1) // 2


@inline(force=True)
def is_leaf_of_clock(tree, node):
    """True if a node is one step or one interval."""
    return tree.earlier[node] < 0


@inline(force=True)
def middle_leaf(tree, node):
    """The leaf whose pose represents a node."""
    return (tree.first[node] + tree.last[node]) // 2


@inline(force=True)
def row_in_middle(tree, node, column):
    """The row of a body in the middle leaf of a node."""
    return middle_leaf(tree, node) * tree.moved.shape[1] + column


@inline
def motion_of_node(tree, node, column):
    """The `MotionBound` of a body over a node, about its pose in the middle leaf."""
    if is_leaf_of_clock(tree, node):
        return motion_bound_at(tree.motion_bounds, row_in_middle(tree, node, column))
    still = Vec3(0.0, 0.0, 0.0)
    return MotionBound(still, still, tree.moved[node, column], ANY_TURN)


@inline
def _halve(tree, n_leaves):
    """Fills the leaves of each node, level by level."""
    tree.first[0], tree.last[0] = 0, n_leaves
    n_nodes = 1
    for node in range(len(tree.first)):
        first, last = tree.first[node], tree.last[node]
        tree.earlier[node] = -1
        if last - first > 1:
            tree.earlier[node] = n_nodes
            middle = (first + last) // 2
            tree.first[n_nodes], tree.last[n_nodes] = first, middle
            tree.first[n_nodes + 1], tree.last[n_nodes + 1] = middle, last
            n_nodes += 2


@inline
def _fill_moved(surface, world, bodies, tree):
    """Fills the motion of each body from the middle of each node: to the middle of a leaf, and within it."""
    k = len(bodies)
    for node in range(len(tree.first)):
        for column in range(k):
            root = surface.roots[world.solids[bodies[column]]]
            box = box_of(surface, root)
            before = tree.poses[row_in_middle(tree, node, column)]
            most = 0.0
            for leaf in range(tree.first[node], tree.last[node]):
                row = leaf * k + column
                moved = motion_bound_of_box(box, motion_bound_at(tree.motion_bounds, row))
                if not is_leaf_of_clock(tree, node):
                    moved += displacement(surface, root, before, tree.poses[row])
                most = max(most, moved)
            tree.moved[node, column] = most * GROWTH


@kernel
def fill_clock_tree(
    surface: Surface,
    world: World,
    path: JointPath,
    bodies: Integers,
    of_steps: bool,
    tree: ClockTree,
):
    """Fills a tree whose leaves are steps, or the intervals between steps.

    Args:
        world: with links of its own, since ball joints are overwritten.
        path: a `JointPath` of all steps, and for a tree of steps one more, so that the last has an arc.
        bodies: (k,) of the clock; a part that is not carried stands still.
    """
    k = len(bodies)
    middle, high = new_middle(len(world.links.parents)), 0.0 if of_steps else 1.0
    _halve(tree, len(tree.poses) // k)
    for leaf in range(len(tree.poses) // k):
        begin_arcs(world.links, path.balls, tree.start + leaf)
        go_to_middle(world.links, path, tree.start + leaf, 0.0, high, middle)
        for column in range(k):
            body, row = bodies[column], leaf * k + column
            frame = world.frames[body]
            copy_pose(middle.poses[frame] if frame >= 0 else world.standing[body], tree.poses[row])
            root = surface.roots[world.solids[body]]
            place_box(surface, root, row, rigid(tree.poses[row]), tree.boxes)
            if not of_steps:
                bound = motion_bound_in(surface, world, path.balls, body, middle)
                note_motion_bound(bound, tree.motion_bounds[row])
    _fill_moved(surface, world, bodies, tree)
    for node in range(len(tree.first)):
        leaf, last = tree.start + middle_leaf(tree, node), tree.start + tree.last[node]
        tree.low[node] = path.times[tree.start + tree.first[node]]
        tree.high[node] = path.times[last - 1 if of_steps else last]
        tree.middle[node] = path.times[leaf]
        if not of_steps:
            tree.middle[node] = 0.5 * (path.times[leaf] + path.times[leaf + 1])

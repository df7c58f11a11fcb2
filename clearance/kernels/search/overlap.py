"""The contact of two bodies that overlap: the first two faces found to meet, whatever was asked before.

Nodes that are apart are left, so nothing is measured; of those that overlap the deepest in one another come first.
Which contact is found depends on the bodies and their poses alone, so that a row in contact is the same wherever a
sweep starts. Not for: bodies that are apart (`descent`), of which it says nothing.
"""

from typing import NamedTuple

import numpy as np

from clearance.compile.jit import inline
from clearance.compile.kernel_table import OVERLAP, apart, at_address, borrow, table_like
from clearance.kernels.arithmetic.lanes import WIDTH, first_of, lane, marks_within
from clearance.kernels.arithmetic.vec3 import inverse
from clearance.kernels.features.bounds import lower_bound_boxes
from clearance.kernels.features.meeting import NO_MEETING, Meeting, meeting_of
from clearance.kernels.features.posed_pair import parts, posed_pair_like
from clearance.kernels.mesh.surface import is_leaf
from clearance.kernels.search.node_pairs import boxes_of_group, opened, pair_in_group
from clearance.kernels.search.scratch import STACK_DEPTH, new_scratch, wait


class Overlap(NamedTuple):
    """Two faces that meet, if any do, and the work of finding them."""

    meeting: Meeting
    face_a: int
    face_b: int
    n_nodes: int
    n_faces: int


NO_OVERLAP = Overlap(NO_MEETING, -1, -1, 0, 0)


@apart(OVERLAP, lambda: (posed_pair_like(), 0.0, new_scratch(), table_like()))
def overlap(roots, slack, scratch, table):
    """The first two faces found to have a point in common, exactly; all that can are looked at.

    Args:
        roots: of the bodies' trees.
        slack: [m] of `rounding_slack`, by which nodes may seem to be apart.
    """
    a, b = borrow(roots.surface_a), borrow(roots.surface_b)
    m = roots.frames.m
    back = inverse(m)
    n_nodes, n_faces, n_waiting = 1, 0, 1
    scratch.nodes[0, 0], scratch.nodes[0, 1], scratch.bounds[0] = roots.a, roots.b, 0.0
    while n_waiting > 0:
        n_waiting -= 1
        node_a, node_b = (
            np.int64(scratch.nodes[n_waiting, 0]),
            np.int64(scratch.nodes[n_waiting, 1]),
        )
        if is_leaf(a, node_a) and is_leaf(b, node_b):
            face_a, face_b = np.int64(a.children[node_a, 0]), np.int64(b.children[node_b, 0])
            n_faces += 1
            met = meeting_of(table, parts(roots, face_a, face_b), scratch.exact)
            if met.found:
                return Overlap(met, face_a, face_b, n_nodes, n_faces)
            continue
        nodes, count = opened(a, node_a, b, node_b)
        n_nodes += count
        p, q = boxes_of_group(a, b, nodes)
        bounds = lower_bound_boxes(p, q, back if nodes.is_of_b else m, slack)
        near = ((1 << count) - 1) & marks_within(bounds, 0.0)
        if n_waiting + WIDTH > STACK_DEPTH:
            raise AssertionError("no room for what waits")
        first = n_waiting
        while near:
            i = first_of(near)
            near &= near - 1
            node_a, node_b = pair_in_group(nodes, i)
            n_waiting = wait(scratch, n_waiting, node_a, node_b, lane(bounds, i), first)
    return Overlap(NO_MEETING, np.int64(-1), np.int64(-1), n_nodes, n_faces)


@inline(one_caller=True)
def overlap_of(table, roots, slack, scratch):
    """The same by address."""
    return at_address(table, OVERLAP, NO_OVERLAP, (roots, slack, scratch, table))

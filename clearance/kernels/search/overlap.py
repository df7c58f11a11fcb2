"""The contact of two bodies that overlap: the first two faces found to meet, whatever was asked before.

Separate nodes are skipped and nothing is measured. Nodes with the deepest overlap come first. A ball meets a face
where its centre comes within the radius, by more than rounding. A search for the nearest centre would visit all
centres inside the body. The contact found depends on the bodies and their poses alone, so a row in contact is the
same wherever a sweep starts. Not for: separate bodies (`descent`).
"""

from typing import NamedTuple

import numpy as np

from clearance.compile.decorators import kernel
from clearance.kernels.arithmetic.lanes import first_of, lane, marks_within
from clearance.kernels.arithmetic.vec3 import Vec3, inverse
from clearance.kernels.features.bounds import lower_bound_boxes, margin_of
from clearance.kernels.features.face_pair import Hit, nearest_of_faces, nothing_yet
from clearance.kernels.features.meeting import NO_MEETING, Meeting, meeting
from clearance.kernels.features.posed_pair import PosedPair, parts
from clearance.kernels.mesh.surface import is_leaf
from clearance.kernels.search.node_pairs import boxes_of_group, opened, pair_in_group
from clearance.kernels.search.scratch import Scratch, require_capacity, wait


class Overlap(NamedTuple):
    """Two faces that meet, or -1, and the work of finding them.

    Attributes:
        meeting: of faces. hit: of a ball and a face within its radius, or of two balls, in the frame of a.
    """

    meeting: Meeting
    hit: Hit
    face_a: int
    face_b: int
    n_nodes: int
    n_faces: int


NO_HIT = Hit(np.inf, 2**62, 2**62, Vec3(0.0, 0.0, 0.0), Vec3(0.0, 0.0, 0.0))


@kernel
def overlap(roots: PosedPair, slack: float, reach: float, scratch: Scratch) -> Overlap:
    """The first two faces found to have a point in common, decided exactly; all candidates are visited.

    Args:
        roots: of the bodies' trees.
        slack: [m] of `rounding_slack`: the greatest gap that rounding can feign.
        reach: [m] the sum of the radii of both bodies; 0 where neither is a cloud.
    """
    a, b = roots.surface_a, roots.surface_b
    m = roots.frames.m
    back = inverse(m)
    margin = margin_of(slack)
    within = max(0.0, reach - 4.0 * margin)
    within_sq = within * within
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
            if reach > 0.0:
                near = nearest_of_faces(a, face_a, b, face_b, m, margin, nothing_yet(within_sq))
                if near.best.face_a != 2**62:
                    return Overlap(NO_MEETING, near.best, face_a, face_b, n_nodes, n_faces)
                continue
            met = meeting(parts(roots, face_a, face_b), scratch.exact)
            if met.found:
                return Overlap(met, NO_HIT, face_a, face_b, n_nodes, n_faces)
            continue
        nodes, count = opened(a, node_a, b, node_b)
        n_nodes += count
        p, q = boxes_of_group(a, b, nodes)
        bounds = lower_bound_boxes(p, q, back if nodes.is_of_b else m, slack)
        marks = ((1 << count) - 1) & marks_within(bounds, reach)
        require_capacity(n_waiting)
        first = n_waiting
        while marks:
            k = first_of(marks)
            marks &= marks - 1
            node_a, node_b = pair_in_group(nodes, k)
            n_waiting = wait(scratch, n_waiting, node_a, node_b, lane(bounds, k), first)
    return Overlap(NO_MEETING, NO_HIT, np.int64(-1), np.int64(-1), n_nodes, n_faces)

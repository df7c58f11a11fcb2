"""The bodies of two clocks, and quick bounds on a pair at a time of each.

Not for: searches over both times (`unsynchronised`, `unsynchronised_steps`).
"""

import math
from typing import NamedTuple

import numpy as np

from clearance.compile.declared import Integers
from clearance.compile.decorators import inline
from clearance.kernels.arithmetic.vec3 import dot, move, row, sub
from clearance.kernels.clocks.clock_rectangles import Band
from clearance.kernels.clocks.clock_tree import ClockTree
from clearance.kernels.features.bounds import margin_of, rounding_slack
from clearance.kernels.features.face_pair import Hit
from clearance.kernels.features.posed_pair import parts
from clearance.kernels.mesh.surface import box_of
from clearance.kernels.motion.joint_path import JointPath
from clearance.kernels.motion.sweep_state import NOT_LESS
from clearance.kernels.motion.world import World
from clearance.kernels.search.balls import radii_of
from clearance.kernels.search.proof import CHAIN_SLACK
from clearance.kernels.search.separating_planes import separate

FEW = 4
"""Corners of a face to visit."""


class TwoClocks(NamedTuple):
    """The bodies and motions of two clocks.

    Attributes:
        world: the bodies; the first of each pair moves by clock a, the second by clock b.
        path: of all joints: first from step to step of clock b, then of clock a.
        tree_a, tree_b: motion bounds over the spans of either clock.
        columns: (bodies,) the place of each body among those of its clock.
        band: the times that occur together.
    """

    world: World
    path: JointPath
    tree_a: ClockTree
    tree_b: ClockTree
    columns: Integers
    band: Band


@inline
def bound_coarsely(surface, bodies, faces, limit, known, scratch):
    """([m] a lower bound on a pair beyond `limit`, or -inf, True if it is nearer than that), without a search.

    Args:
        bodies: a `PosedPair`. faces: (2,) where to begin, or -1; overwritten by those that touch the planes.
        known: [m] a pair that may be as near as this needs a search, so it is not said to be within the limit.
    """
    planes, is_near = -math.inf, known < _corner_distance(surface, faces, bodies.frames) < limit
    if not is_near:
        planes = _bound_by_planes(surface, bodies, faces, limit, scratch)
        if not planes > limit:
            is_near = known < _corner_distance(surface, faces, bodies.frames) < limit
    return planes, is_near


@inline
def _corner_distance(surface, faces, frames):
    """[m] the distance of two faces' nearest corners, of the first few of each; infinite without faces.

    The distance of the bodies is no greater, so a bound beyond it needs no search.
    """
    if faces[0] < 0:
        return math.inf
    starts, corners, vertices = surface.face_starts, surface.face_vertices, surface.vertices
    first_a, first_b = starts[faces[0]], starts[faces[1]]
    end_a = min(first_a + FEW, starts[faces[0] + 1])
    end_b = min(first_b + FEW, starts[faces[1] + 1])
    least_sq = math.inf
    for i in range(first_a, end_a):
        x = move(frames.a, row(vertices, corners[i]))
        for k in range(first_b, end_b):
            d = sub(x, move(frames.b, row(vertices, corners[k])))
            least_sq = min(least_sq, dot(d, d))
    return math.sqrt(least_sq) * NOT_LESS


@inline
def _bound_by_planes(surface, bodies, faces, limit, scratch):
    """[m] a lower bound beyond `limit` by two planes between the bodies' hulls, or -inf if there are none.

    Each tree is searched by itself: a few dozen nodes, where pairs of nodes take hundreds to thousands.
    """
    roots = parts(bodies, surface.roots[bodies.a], surface.roots[bodies.b])
    m = bodies.frames.m
    slack = CHAIN_SLACK * rounding_slack(surface, roots.a, surface, roots.b, bodies.frames)
    rest = 3.0 * margin_of(slack) + radii_of(surface, bodies.a, surface, bodies.b).both
    if faces[0] >= 0:
        p = row(surface.vertices, surface.face_vertices[surface.face_starts[faces[0]]])
        q = move(m, row(surface.vertices, surface.face_vertices[surface.face_starts[faces[1]]]))
        d = sub(p, q)
        best = Hit(dot(d, d), faces[0], faces[1], p, q)
    else:
        p, q = box_of(surface, roots.a).centre, move(m, box_of(surface, roots.b).centre)
        best = Hit(math.inf, np.int64(2**62), np.int64(2**62), p, q)
    planes = separate(roots, best, limit + rest, slack, scratch)
    if planes.face_a >= 0 and planes.face_b >= 0:
        faces[0], faces[1] = planes.face_a, planes.face_b
    return planes.lower_bound - rest if planes.lower_bound > limit + rest else -math.inf

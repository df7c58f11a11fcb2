"""The bodies of a sweep: the links that carry them, the pairs to measure, and their poses."""

from typing import NamedTuple

from clearance.compile.declared import Floats3, Integers, Integers2
from clearance.compile.decorators import inline
from clearance.kernels.arithmetic.double_double import frames_of
from clearance.kernels.arithmetic.vec3 import rigid
from clearance.kernels.motion.body_boxes import bound_of_bodies, place_box
from clearance.kernels.motion.kinematics import Links


class World(NamedTuple):
    """The bodies and the links that carry them.

    A body is a solid in a place. Two links of one robot are measured in the frame of the nearest link above both,
    so that only the joints between move them. So a solid may have several bodies, one for each such frame.

    Attributes:
        solids: (bodies,) the number of each in the surface.
        frames: (bodies,) link that carries the body, or -1 for a standing body.
        groups: (bodies,) numbers from 0; bodies of one group are visited together. Two moving bodies of a pair
            are of one group.
        standing: (bodies, 4, 4) poses of the standing bodies [m].
        pairs: (p, 2) bodies to measure against each other; a link carries the first, and perhaps the second.
        links: of all robots.
    """

    solids: Integers
    frames: Integers
    groups: Integers
    standing: Floats3
    pairs: Integers2
    links: Links


@inline(force=True)
def pose_of(world, body, poses):
    """The pose of a body as `RigidMotion`, with the links at `poses` (links, 4, 4)."""
    frame = world.frames[body]
    return rigid(poses[frame] if frame >= 0 else world.standing[body])


@inline(force=True)
def pair_frames(world, pair, poses):
    """The frames of both bodies of a pair, of `poses` (bodies, 4, 4)."""
    return frames_of(rigid(poses[world.pairs[pair, 0]]), rigid(poses[world.pairs[pair, 1]]))


@inline(force=True)
def box_bound(surface, world, pair, placed, boxes, enough):
    """[m] a lower bound on the distance of a pair by the boxes of both bodies; one above `enough` will do."""
    body_a, body_b = world.pairs[pair, 0], world.pairs[pair, 1]
    for body in (body_a, body_b):
        if boxes.moves[body] != placed.moves[body]:
            root = surface.roots[world.solids[body]]
            place_box(surface, root, body, rigid(placed.poses[body]), boxes)
            boxes.moves[body] = placed.moves[body]
    return bound_of_bodies(boxes, body_a, body_b, enough)

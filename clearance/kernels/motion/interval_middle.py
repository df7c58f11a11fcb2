"""The middle of an interval, or of a part of it: the poses of the links, and the motion of bodies about them.

Not for: proofs (`certify`, `unsynchronised`), and the bounds themselves (`joint_motion_bound`).
"""

from typing import NamedTuple

import numpy as np

from clearance.compile.declared import Floats, Floats3
from clearance.compile.decorators import inline
from clearance.kernels.arithmetic.vec3 import Vec3
from clearance.kernels.mesh.surface import box_of
from clearance.kernels.motion.joint_motion_bound import (
    AT_REST,
    MotionBound,
    loosened,
    motion_bound_of,
    orientation_rounding,
)
from clearance.kernels.motion.joint_path import part_of, part_of_arc
from clearance.kernels.motion.kinematics import orient, place_by_link


class IntervalMiddle(NamedTuple):
    """The state in the middle of an interval or of a part of it.

    Attributes:
        positions: (links,) [rad or m] of the joint above each link.
        swing: (links,) [rad or m] half of its motion in the interval, to first order.
        bend: (links,) [rad or m] the greatest deviation from that; 0 for linear motion.
        poses: (links, 4, 4) `world_from_link` [m].
    """

    positions: Floats
    swing: Floats
    bend: Floats
    poses: Floats3


@inline
def begin_arcs(links, balls, step):
    """Gives ball joints their orientation at `step` as a fixed part, and their axis in the interval after it."""
    for ball in range(len(balls.links)):
        link, arc = balls.links[ball], balls.arcs[step, ball]
        orient(balls.parent_from_joint[ball], arc, links.parent_from_joint[link])
        for k in range(3):
            links.axes[link, k] = arc[4 + k]


@inline
def go_to_middle(links, path, step, low, high, middle):
    """Puts `middle` in the middle of the part `low` to `high` (0 to 1) of the interval after `step`."""
    for link in range(path.positions.shape[1]):
        part = part_of(path, step, link, low, high)
        middle.positions[link] = part.middle
        middle.swing[link] = part.swing
        middle.bend[link] = part.bend
    for ball in range(len(path.balls.links)):
        link = path.balls.links[ball]
        arc = part_of_arc(path.balls, step, ball, low, high)
        middle.positions[link], middle.swing[link] = arc.middle, arc.swing
    place_by_link(links, middle.positions, middle.poses)


@inline
def new_middle(n_links):
    return IntervalMiddle(
        np.empty(n_links), np.empty(n_links), np.empty(n_links), np.empty((n_links, 4, 4))
    )


@inline
def motion_bound_in(surface, world, balls, body, middle):
    """The motion bound of a body about `middle`; ball joints must have the arcs of the interval."""
    link = world.frames[body]
    if link < 0:
        return AT_REST
    box = box_of(surface, surface.roots[world.solids[body]])
    bound = motion_bound_of(box, world.links, link, middle)
    if len(balls.links) == 0:
        return bound
    return loosened(bound, orientation_rounding(box, world.links, link, balls, middle))


@inline
def note_motion_bound(bound, numbers):
    """Writes a motion bound as eight numbers."""
    v, w = bound.velocity, bound.spin
    numbers[0], numbers[1], numbers[2] = v.x, v.y, v.z
    numbers[3], numbers[4], numbers[5] = w.x, w.y, w.z
    numbers[6], numbers[7] = bound.rest, bound.turn


@inline
def motion_bound_at(motion_bounds, body):
    d = motion_bounds[body]
    return MotionBound(Vec3(d[0], d[1], d[2]), Vec3(d[3], d[4], d[5]), d[6], d[7])

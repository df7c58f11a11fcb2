"""Lower bounds on the distance of whole bodies by their boxes alone, before any search.

The box of a body is placed in the world once for all its pairs. A ball about it separates most of them, in a third
of the time of two boxes. Not for: nodes of trees (`bounds`, `node_pairs`).
"""

import math
from typing import NamedTuple

import numpy as np

from clearance.compile.declared import Floats, Floats2, Floats3, Integers
from clearance.compile.decorators import inline
from clearance.kernels.arithmetic.double_double import defect_of
from clearance.kernels.arithmetic.vec3 import dot, move, row, sub, turn
from clearance.kernels.features.bounds import LEAN, SLACK, between_boxes, lower_bound_between
from clearance.kernels.mesh.surface import Box, box_of

OUTWARD = 1.0 + 2.0**-20
"""Covers, in the radius of a ball, the rounding of a box's axes to single precision."""


class BodyBoxes(NamedTuple):
    """The boxes of all bodies in the world, and balls about them.

    Attributes:
        axes: (bodies, 3, 3) of each box, a row an axis. centres, halves: (bodies, 3) [m], in the world.
        radii: (bodies,) [m] of the balls about the centres.
        slacks: (bodies,) [m] the most that rounding and rotations off orthonormal can raise a bound.
        moves: (bodies,) the moves of each body when its box was placed, or -1.
    """

    axes: Floats3
    centres: Floats2
    halves: Floats2
    radii: Floats
    slacks: Floats
    moves: Integers


@inline
def new_body_boxes(n_bodies):
    """Boxes, none of them placed yet."""
    return BodyBoxes(
        np.empty((n_bodies, 3, 3)), np.empty((n_bodies, 3)), np.empty((n_bodies, 3)), np.empty(n_bodies),
        np.empty(n_bodies), np.full(n_bodies, -1),
    )  # fmt: skip


@inline
def place_box(surface, root, body, pose, boxes):
    """Places the box of a body, that of the root of its tree, at the pose of the body, a `RigidMotion`."""
    box = box_of(surface, root)
    centre, x, y, z = (
        move(pose, box.centre),
        turn(pose, box.x),
        turn(pose, box.y),
        turn(pose, box.z),
    )
    for k in range(3):
        boxes.axes[body, 0, k], boxes.axes[body, 1, k], boxes.axes[body, 2, k] = x[k], y[k], z[k]
        boxes.centres[body, k], boxes.halves[body, k] = centre[k], box.half[k]
    c, h, t = box.centre, box.half, pose.t
    reach = (
        abs(t.x) + abs(t.y) + abs(t.z) + abs(c.x) + abs(c.y) + abs(c.z) + 2.0 * (h.x + h.y + h.z)
    )
    boxes.slacks[body] = (SLACK + 8.0 * defect_of(pose)) * reach
    boxes.radii[body] = math.sqrt(dot(h, h)) * OUTWARD


@inline(force=True)
def _box(boxes, body):
    axes = boxes.axes[body]
    return Box(
        row(axes, 0), row(axes, 1), row(axes, 2), row(boxes.centres, body), row(boxes.halves, body)
    )


@inline(force=True)
def _beyond(box, d, slack):
    """[m] a lower bound on the distance of a box from a point at `d` from its centre."""
    x = max(0.0, abs(dot(box.x, d)) - box.half.x - slack)
    y = max(0.0, abs(dot(box.y, d)) - box.half.y - slack)
    z = max(0.0, abs(dot(box.z, d)) - box.half.z - slack)
    return math.sqrt(x * x + y * y + z * z)


@inline(force=True)
def bound_of_bodies(boxes, a, b, enough):
    """[m] a lower bound on the distance of two bodies; one above `enough` is not made tighter."""
    return bound_between(boxes, a, boxes, b, enough)


@inline(force=True)
def bound_between(boxes, a, others, b, enough):
    """[m] the same for body `a` of some boxes and body `b` of others.

    First the box of each against the ball about the other; where that is not enough, both boxes.
    """
    p, q = _box(boxes, a), _box(others, b)
    d = sub(q.centre, p.centre)
    slack = boxes.slacks[a] + others.slacks[b]
    lean = slack + LEAN * (abs(d.x) + abs(d.y) + abs(d.z))
    by_balls = (
        max(_beyond(p, d, lean) - others.radii[b], _beyond(q, d, lean) - boxes.radii[a])
        - 2.0 * slack
    )
    if by_balls > enough:
        return by_balls
    by_boxes = (
        lower_bound_between(p.half, q.half, between_boxes(p, q.x, q.y, q.z, d), slack) - slack
    )
    return max(0.0, max(by_balls, by_boxes))

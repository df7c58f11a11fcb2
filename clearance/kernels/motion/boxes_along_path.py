"""Steps at which two bodies on a path may overlap, by their bounding boxes: for most pairs none.

Not for: bounds of the distance (`sweep`), and which body is inside another (`search.doubt`).
"""

import math
from typing import NamedTuple

import numpy as np

from clearance.compile.declared import Floats2, Floats3, Floats4, Integers, Integers2
from clearance.compile.decorators import inline, kernel
from clearance.kernels.arithmetic.double_double import size
from clearance.kernels.arithmetic.vec3 import (
    Vec3,
    add,
    dot,
    gap_sq,
    move,
    relative,
    rigid,
    row,
    sub,
)
from clearance.kernels.features.bounds import lower_bound_boxes
from clearance.kernels.mesh.surface import Box
from clearance.kernels.motion.kinematics import Links, place_each

ROUNDING = 1e-4
"""[-] Least gap that counts, as a share of the coordinates: rotations may be off orthonormal by 1e-6."""


class CarriedBoxes(NamedTuple):
    """The boxes of bodies, and the links that carry them.

    Attributes:
        bounds: (b, 2, 3) [m] of each body, in its own frame.
        links: (b,) the link that carries each, at the link's own pose, or -1 for a standing body.
        standing: (b, 4, 4) [m] poses of standing bodies.
    """

    bounds: Floats3
    links: Integers
    standing: Floats3


@inline(force=True)
def _pose(boxes, body, poses, step):
    link = boxes.links[body]
    return rigid(boxes.standing[body] if link < 0 else poses[step, link])


@inline
def _box(bounds):
    d = sub(row(bounds, 1), row(bounds, 0))
    half = Vec3(0.5 * d.x, 0.5 * d.y, 0.5 * d.z)
    x, y, z = Vec3(1.0, 0.0, 0.0), Vec3(0.0, 1.0, 0.0), Vec3(0.0, 0.0, 1.0)
    return Box(x, y, z, add(row(bounds, 0), half), half)


@inline
def _place_balls(boxes, poses, step, middles, radii, rounding):
    """Fills the ball round each box at a step, its radius with what rounding may be, and that alone."""
    for body in range(len(radii)):
        box, frame = _box(boxes.bounds[body]), _pose(boxes, body, poses, step)
        middle = move(frame, box.centre)
        middles[body, 0], middles[body, 1], middles[body, 2] = middle.x, middle.y, middle.z
        rounding[body] = ROUNDING * (size(frame.t) + size(box.centre) + size(box.half))
        radii[body] = math.sqrt(dot(box.half, box.half)) + rounding[body]


@inline
def _balls_overlap(middles, radii, a, b):
    """False only if two balls have a gap: most pairs are far from each other."""
    reach = radii[a] + radii[b]
    return gap_sq(row(middles, a), row(middles, b)) <= reach * reach


@kernel
def steps_together(boxes: CarriedBoxes, pairs: Integers2, poses: Floats4, spans: Integers2):
    """Fills the first step at which the boxes of each pair may overlap, and the one after the last; 0, 0 if none.

    Args:
        boxes: a `CarriedBoxes`. pairs: (p, 2) of its bodies.
        poses: (n, links, 4, 4) [m] of the links at each of n steps.
        spans: (p, 2), overwritten.
    """
    n_bodies = len(boxes.links)
    middles, radii, rounding = np.empty((n_bodies, 3)), np.empty(n_bodies), np.empty(n_bodies)
    spans[:] = 0
    for step in range(len(poses)):
        _place_balls(boxes, poses, step, middles, radii, rounding)
        for pair in range(len(pairs)):
            a, b = pairs[pair, 0], pairs[pair, 1]
            if not _balls_overlap(middles, radii, a, b):
                continue
            m = relative(_pose(boxes, a, poses, step), _pose(boxes, b, poses, step))
            box_a, box_b = _box(boxes.bounds[a]), _box(boxes.bounds[b])
            if not lower_bound_boxes(box_a, box_b, m, rounding[a] + rounding[b]) > 0.0:
                if spans[pair, 1] == 0:
                    spans[pair, 0] = step
                spans[pair, 1] = step + 1


@kernel
def overlaps_at_positions(
    links: Links,
    boxes: CarriedBoxes,
    pairs: Integers2,
    positions: Floats2,
    poses: Floats4,
    spans: Integers2,
) -> int:
    """The number of pairs whose boxes may overlap at one of n positions: one call, since two cost more than that.

    Args:
        links: a `Links`. boxes, pairs, spans: as of `steps_together`.
        positions: (n, columns) [rad or m]. poses: (n, links, 4, 4) [m] of the links, overwritten.
    """
    place_each(links, positions, poses)
    steps_together(boxes, pairs, poses, spans)
    n_pairs = 0
    for pair in range(len(pairs)):
        if spans[pair, 1] > 0:
            n_pairs += 1
    return n_pairs

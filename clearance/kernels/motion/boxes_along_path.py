"""Steps at which two bodies on a path may overlap, by their bounding boxes: for most pairs none.

Not for: bounds of the distance (`sweep`), and which body is inside another (`search.doubt`).
"""

from typing import NamedTuple

from clearance.compile.declared import Floats2, Floats3, Floats4, Integers, Integers2
from clearance.compile.decorators import inline, kernel
from clearance.kernels.arithmetic.double_double import size
from clearance.kernels.arithmetic.vec3 import Vec3, add, move, relative, rigid, row, sub
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


@inline(force=True)
def _half(bounds):
    d = sub(row(bounds, 1), row(bounds, 0))
    return Vec3(0.5 * d.x, 0.5 * d.y, 0.5 * d.z)


@inline(force=True)
def _separation(m, middle, half, middle_of_other, half_of_other):
    """[m] the greatest gap along the axes of a box to another one, `m` from the frame of the other."""
    away = sub(move(m, middle_of_other), middle)
    x = abs(m.xx) * half_of_other.x + abs(m.xy) * half_of_other.y + abs(m.xz) * half_of_other.z
    y = abs(m.yx) * half_of_other.x + abs(m.yy) * half_of_other.y + abs(m.yz) * half_of_other.z
    z = abs(m.zx) * half_of_other.x + abs(m.zy) * half_of_other.y + abs(m.zz) * half_of_other.z
    by_x, by_y, by_z = abs(away.x) - half.x - x, abs(away.y) - half.y - y, abs(away.z) - half.z - z
    return max(by_x, max(by_y, by_z))


@inline
def _may_overlap(bounds_a, bounds_b, frame_a, frame_b):
    """False only if two boxes have a gap along an axis of either, beyond rounding."""
    half_a, half_b = _half(bounds_a), _half(bounds_b)
    middle_a, middle_b = add(row(bounds_a, 0), half_a), add(row(bounds_b, 0), half_b)
    rounding = ROUNDING * (
        size(frame_a.t) + size(frame_b.t) + size(middle_a) + size(middle_b)
        + size(half_a) + size(half_b)
    )  # fmt: skip
    if _separation(relative(frame_a, frame_b), middle_a, half_a, middle_b, half_b) > rounding:
        return False
    return not (
        _separation(relative(frame_b, frame_a), middle_b, half_b, middle_a, half_a) > rounding
    )


@kernel
def steps_together(boxes: CarriedBoxes, pairs: Integers2, poses: Floats4, spans: Integers2):
    """Fills the first step at which the boxes of each pair may overlap, and the one after the last; 0, 0 if none.

    Args:
        boxes: a `CarriedBoxes`. pairs: (p, 2) of its bodies.
        poses: (n, links, 4, 4) [m] of the links at each of n steps.
        spans: (p, 2), overwritten.
    """
    for pair in range(len(pairs)):
        a, b = pairs[pair, 0], pairs[pair, 1]
        spans[pair, 0] = spans[pair, 1] = 0
        for step in range(len(poses)):
            frame_a, frame_b = _pose(boxes, a, poses, step), _pose(boxes, b, poses, step)
            if _may_overlap(boxes.bounds[a], boxes.bounds[b], frame_a, frame_b):
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

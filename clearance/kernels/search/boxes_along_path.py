"""Steps at which two bodies on a path may overlap, by their bounding boxes: for most pairs none.

Boxes with a gap along an axis of either stay separate until their relative motion has used up the gap. So most
steps are skipped. Not for: bounds of the distance (`motion.sweep`), and which body is inside another (`doubt`).
"""

from typing import NamedTuple

import numpy as np

from clearance.compile.declared import Floats3, Floats4, Integers, Integers2
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


class BoxDisplacements(NamedTuple):
    """How far boxes have moved in all up to each step, (b, n).

    Attributes:
        middles: [m] their middles. turns: [-] by the norm of the change of their rotation.
    """

    middles: np.ndarray
    turns: np.ndarray


class BoxGap(NamedTuple):
    """Two boxes at a step, each seen from the other.

    Attributes:
        of_a, of_b: [m] their greatest gap along the axes of either; negative where they overlap.
        between: [m] distance of their middles. half_a, half_b: [m] half of their diagonals.
    """

    of_a: float
    of_b: float
    between: float
    half_a: float
    half_b: float


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


@inline(force=True)
def _gap_between(bounds_a, bounds_b, frame_a, frame_b):
    half_a, half_b = _half(bounds_a), _half(bounds_b)
    middle_a, middle_b = add(row(bounds_a, 0), half_a), add(row(bounds_b, 0), half_b)
    rounding = ROUNDING * (
        size(frame_a.t) + size(frame_b.t) + size(middle_a) + size(middle_b)
        + size(half_a) + size(half_b)
    )  # fmt: skip
    return BoxGap(
        _separation(relative(frame_a, frame_b), middle_a, half_a, middle_b, half_b) - rounding,
        _separation(relative(frame_b, frame_a), middle_b, half_b, middle_a, half_a) - rounding,
        np.sqrt(gap_sq(move(frame_a, middle_a), move(frame_b, middle_b))) + rounding,
        np.sqrt(dot(half_a, half_a)),
        np.sqrt(dot(half_b, half_b)),
    )


@inline(force=True)
def _stay_separate(found, moved, turned_a, turned_b):
    """True if two boxes still have a gap along the axes of the same box as before.

    A point of one box moves in the frame of the other by three parts: the motion of both middles, the turn of its
    own box about its middle, and the turn of the other box about the other middle.

    Args:
        moved: [m] both middles since. turned_a, turned_b: [-] since.
    """
    between = found.between + moved
    of_a = moved + turned_b * found.half_b + turned_a * (between + found.half_b)
    of_b = moved + turned_a * found.half_a + turned_b * (between + found.half_a)
    return of_a < found.of_a or of_b < found.of_b


@inline(force=True)
def _are_separate(found, displacements, a, b, here, step):
    """True if two boxes that have a gap `here` still have one at a later step."""
    middles, turns = displacements.middles, displacements.turns
    return _stay_separate(
        found,
        middles[a, step] - middles[a, here] + middles[b, step] - middles[b, here],
        turns[a, step] - turns[a, here],
        turns[b, step] - turns[b, here],
    )


@inline
def _next_visit(found, displacements, a, b, here, n_steps):
    """The first step after `here` at which boxes may have no gap any more, or `n_steps`.

    Bisection is right: the accumulated motion only grows, also in rounded numbers.
    """
    if n_steps - here > 1 and _are_separate(found, displacements, a, b, here, n_steps - 1):
        return n_steps
    low, high = here, here + 1
    while high < n_steps and _are_separate(found, displacements, a, b, here, high):
        low, high = high, high + 2 * (high - here)
    high = min(high, n_steps)
    while high - low > 1:
        middle = (low + high) // 2
        if _are_separate(found, displacements, a, b, here, middle):
            low = middle
        else:
            high = middle
    return high


@inline(force=True)
def _turned(before, after):
    """[-] the norm of the change of a rotation. A point moves by at most this times its distance."""
    return np.sqrt(
        (after.xx - before.xx) ** 2 + (after.xy - before.xy) ** 2 + (after.xz - before.xz) ** 2
        + (after.yx - before.yx) ** 2 + (after.yy - before.yy) ** 2 + (after.yz - before.yz) ** 2
        + (after.zx - before.zx) ** 2 + (after.zy - before.zy) ** 2 + (after.zz - before.zz) ** 2
    )  # fmt: skip


@inline
def _fill_displacements(boxes, poses, displacements):
    for body in range(len(boxes.links)):
        if boxes.links[body] < 0:
            continue
        middle = add(row(boxes.bounds[body], 0), _half(boxes.bounds[body]))
        before = _pose(boxes, body, poses, 0)
        for step in range(1, len(poses)):
            after = _pose(boxes, body, poses, step)
            moved = np.sqrt(gap_sq(move(before, middle), move(after, middle)))
            displacements.middles[body, step] = displacements.middles[body, step - 1] + moved
            displacements.turns[body, step] = displacements.turns[body, step - 1] + _turned(
                before, after
            )
            before = after


@kernel
def steps_together(boxes: CarriedBoxes, pairs: Integers2, poses: Floats4, spans: Integers2):
    """Fills the first step at which the boxes of each pair may overlap, and the one after the last; 0, 0 if none.

    Args:
        boxes: a `CarriedBoxes`. pairs: (p, 2) of its bodies.
        poses: (n, links, 4, 4) [m] of the links at each of n steps.
        spans: (p, 2), overwritten.
    """
    n_steps, n_bodies = len(poses), len(boxes.links)
    displacements = BoxDisplacements(np.zeros((n_bodies, n_steps)), np.zeros((n_bodies, n_steps)))
    _fill_displacements(boxes, poses, displacements)
    for pair in range(len(pairs)):
        a, b = pairs[pair, 0], pairs[pair, 1]
        spans[pair, 0] = spans[pair, 1] = 0
        step = 0
        while step < n_steps:
            found = _gap_between(
                boxes.bounds[a],
                boxes.bounds[b],
                _pose(boxes, a, poses, step),
                _pose(boxes, b, poses, step),
            )
            if not max(found.of_a, found.of_b) > 0.0:
                if spans[pair, 1] == 0:
                    spans[pair, 0] = step
                spans[pair, 1] = step + 1
            step = _next_visit(found, displacements, a, b, step, n_steps)

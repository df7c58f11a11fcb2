"""The position of a joint between two samples, and its motion from the middle of a part of the interval.

Without velocities the motion is linear. With velocities it is the Hermite cubic, which has them at both samples.
The cubic is the linear motion plus an excess, which vanishes if the velocities equal the mean velocity:

    q(s) = q0 + s D + s (1 - s) ((1 - s) e0 - s e1),  D = q1 - q0,  e0 = T v0 - D,  e1 = T v1 - D.

Not for: what that does to the points of a link (`joint_motion_bound`).
"""

from typing import NamedTuple

import numpy as np

from clearance.compile.declared import Flags, Floats, Floats2, Floats3, Integers
from clearance.compile.decorators import inline

OUTWARD = 1.0 + 1e-12
"""Covers the rounding of a bound that is a sum of a few positive terms."""

PATH_ROUNDING = 2.0**-48
"""Rounding of a cubic's position and slope, relative to |T v0| + |T v1| + |D|: sixteen operations, doubled."""


BALL_ROUNDING = 2.0**-45
"""[rad] Rounding of the orientation of a ball joint between steps: 111 u, doubled; `CERTIFY.md` has the sum."""


class BallPath(NamedTuple):
    """The motion of the ball joints: between two steps each turns about one axis at constant speed.

    Attributes:
        links: (b,) below them.
        parent_from_joint: (b, 4, 4) the fixed parts of the joints [m].
        arcs: (n - 1, b, 8) the orientation before as a quaternion (x, y, z, w); a unit axis in that orientation;
            the angle [rad].
    """

    links: Integers
    parent_from_joint: Floats3
    arcs: Floats3


ANGLE = 7
"""The place of the angle in an arc."""

NO_BALLS = BallPath(np.empty(0, dtype=np.int64), np.empty((0, 4, 4)), np.empty((0, 0, 8)))
"""The path of links without ball joints."""


class JointPath(NamedTuple):
    """The motion of the joints above all links.

    Attributes:
        times: (n,) [s].
        positions: (n, n_links) [rad or m].
        velocities: (n, n_links) [rad/s or m/s], or (0, n_links) where all joints move linearly.
        is_cubic: (n_links,) False for a joint that moves linearly even so.
        balls: of the ball joints, which have no positions or velocities of their own.
    """

    times: Floats
    positions: Floats2
    velocities: Floats2
    is_cubic: Flags
    balls: BallPath = NO_BALLS


class JointInterval(NamedTuple):
    """A joint over a part of an interval: from `middle` it moves by t swing + r, |t| <= 1, |r| <= bend."""

    middle: float
    swing: float
    bend: float


@inline(force=True)
def linear_part(before, after, low, high):
    """The part `low` to `high` (0 to 1) of a linear motion; its bend is 0."""
    step = after - before
    swing = 0.5 * (high - low) * step * OUTWARD
    return JointInterval(before + 0.5 * (low + high) * step, swing, 0.0)


@inline
def cubic_part(before, after, slope_before, slope_after, low, high):
    """The part `low` to `high` (0 to 1) of a cubic; slopes are velocities times the length of the interval.

    Exactness: q(a + h t) - q(a) = t h q'(a) + (h t)^2 (q''(a) / 2 + c h t) with c = e0 + e1, so that for |t| <= 1
        the bend is at most h^2 (|q''(a)| / 2 + |c| h), and what rounding does to q(a) and h q'(a).
    """
    at = 0.5 * (low + high)
    half = 0.5 * (high - low)
    rest = 1.0 - at
    step = after - before
    e0, e1 = slope_before - step, slope_after - step
    middle = before + at * step + at * rest * (rest * e0 - at * e1)
    slope = step + rest * (1.0 - 3.0 * at) * e0 + at * (3.0 * at - 2.0) * e1
    curve = abs((3.0 * at - 2.0) * e0 + (3.0 * at - 1.0) * e1)
    bend = half * half * (curve + abs(e0 + e1) * half) * OUTWARD
    bend += PATH_ROUNDING * (abs(slope_before) + abs(slope_after) + abs(step))
    return JointInterval(middle, half * slope * OUTWARD, bend)


@inline(force=True)
def part_of(path, step, link, low, high):
    """The part `low` to `high` of the motion of a link's joint from `step` to the next."""
    before, after = path.positions[step, link], path.positions[step + 1, link]
    if len(path.velocities) == 0 or not path.is_cubic[link]:
        return linear_part(before, after, low, high)
    length = path.times[step + 1] - path.times[step]
    return cubic_part(
        before, after, length * path.velocities[step, link],
        length * path.velocities[step + 1, link], low, high,
    )  # fmt: skip


@inline(force=True)
def part_of_arc(balls, step, ball, low, high):
    """The part `low` to `high` of the turn of a ball joint from its orientation at `step` to the next [rad]."""
    return linear_part(0.0, balls.arcs[step, ball, ANGLE], low, high)

"""The joint motion bound: how far the points of a link can move while its joints move; first order exactly.

About the middle of an interval, where joint k moves by s swing_k + b_k with |s| <= 1 and |b_k| <= bend_k, a point
x moves by s v(x) + r: v is the link's twist by the swings, an affine map of x. |r| is at most half the greatest
second derivative over all joint motions of |swing_k| + bend_k, plus the first-order motion by the bends.
In an interval a ball joint turns about one axis; only the rounding of its orientation is added.
Source: the product of exponentials differentiated twice; joints nearer to the link come first, since only they
move the link about an axis.
"""

import math
from typing import NamedTuple

from clearance.compile.decorators import inline
from clearance.kernels.arithmetic.lanes import square_root
from clearance.kernels.arithmetic.vec3 import (
    Vec3,
    add,
    along,
    cross,
    dot,
    move,
    rigid,
    sub,
    turn_back,
)
from clearance.kernels.features.bounds import LEAN, box_reach
from clearance.kernels.mesh.surface import corner_of
from clearance.kernels.motion.joint_path import BALL_ROUNDING
from clearance.kernels.motion.kinematics import NO_PARENT, SLIDING, TURNING, world_axis


class MotionBound(NamedTuple):
    """The motion of a body over half an interval, to either side, in the body's frame in the middle.

    Attributes:
        velocity, spin: a point x moves by s (velocity + spin x x) + r, |s| <= 1 [m], [rad].
        rest: [m] a bound on |r| over the body.
        turn: [rad] a bound on the angle that the body turns by.
    """

    velocity: Vec3
    spin: Vec3
    rest: float
    turn: float


AT_REST = MotionBound(Vec3(0.0, 0.0, 0.0), Vec3(0.0, 0.0, 0.0), 0.0, 0.0)
"""The bound of a standing body."""


class PairMotion(NamedTuple):
    """The motion bounds of both bodies of a pair.

    Attributes:
        b_moves: False if b stands; that saves half of the work.
    """

    a: MotionBound
    b: MotionBound
    b_moves: bool


@inline
def _farthest_from_axis(box, pose, origin, axis):
    """[m] an upper bound on the distance of the body's points from a line, by the corners of its box."""
    far_sq = 0.0
    for corner in range(8):
        away = cross(sub(move(pose, corner_of(box, corner)), origin), axis)
        far_sq = max(far_sq, dot(away, away))
    return math.sqrt(far_sq)


@inline
def motion_bound_of(box, links, link, middle):
    """The motion bound of a body with a box, fixed to `link`, about the `IntervalMiddle` of an interval."""
    poses, swing, bend = middle.poses, middle.swing, middle.bend
    world_from_body = rigid(poses[link])
    shallower = 0.0  # sum of the motions of the turning joints between here and the base
    i = link
    while links.parents[i] != NO_PARENT:
        if links.kinds[i] == TURNING:
            shallower += abs(swing[i]) + bend[i]
        i = links.parents[i]
    turn = shallower
    spin, velocity = Vec3(0.0, 0.0, 0.0), Vec3(0.0, 0.0, 0.0)
    rest = 0.0
    moved = 0.0  # the greatest motion of a point of the body by the joints up to here
    i = link
    while links.parents[i] != NO_PARENT:
        size = abs(swing[i]) + bend[i]
        if size > 0.0 and links.kinds[i] == TURNING:
            shallower = max(0.0, shallower - size)
            axis = world_axis(links, poses, i)
            origin = Vec3(poses[i, 0, 3], poses[i, 1, 3], poses[i, 2, 3])
            arm = _farthest_from_axis(box, world_from_body, origin, axis) + moved
            rest += 0.5 * size * arm * (size + 2.0 * shallower) + bend[i] * arm
            moved += size * arm
            spin = along(spin, swing[i], axis)
            velocity = along(velocity, swing[i], cross(origin, axis))
        elif size > 0.0 and links.kinds[i] == SLIDING:
            rest += size * shallower + bend[i]
            moved += size
            velocity = along(velocity, swing[i], world_axis(links, poses, i))
        i = links.parents[i]
    at_origin = add(velocity, cross(spin, world_from_body.t))
    return MotionBound(
        turn_back(world_from_body, at_origin),
        turn_back(world_from_body, spin),
        rest * (1.0 + 1e-12),
        turn,
    )


@inline
def orientation_rounding(box, links, link, balls, middle):
    """[m] the greatest motion of a point of a body fixed to `link` by rounding of the orientations of ball joints.

    The rounding is a turn about any axis, so it is multiplied by the body's greatest distance from the joint.

    Args:
        balls: a `BallPath`. middle: of an interval, with `positions`, `swing` and `bend`.
    """
    reach = math.sqrt(dot(box.centre, box.centre)) + math.sqrt(dot(box.half, box.half))
    distance = 0.0
    while links.parents[link] != NO_PARENT:
        for ball in range(len(balls.links)):
            if balls.links[ball] == link:
                distance += BALL_ROUNDING * reach
        if links.kinds[link] == SLIDING:
            reach += abs(middle.positions[link]) + abs(middle.swing[link]) + middle.bend[link]
        t = rigid(links.parent_from_joint[link]).t
        reach += math.sqrt(dot(t, t))
        link = links.parents[link]
    return distance * (1.0 + LEAN)


@inline
def loosened(motion_bound, distance):
    """The motion bound with a greater rest, by a distance [m]."""
    return MotionBound(
        motion_bound.velocity, motion_bound.spin, motion_bound.rest + distance, motion_bound.turn
    )


@inline
def velocity_at(motion_bound, x):
    """The first-order motion of a point of the body over half the interval [m]."""
    return add(motion_bound.velocity, cross(motion_bound.spin, x))


@inline
def motion_bound_of_box(box, motion_bound):
    """[m] an upper bound on the motion of any point of a box from the middle."""
    v = velocity_at(motion_bound, box.centre)
    radius = square_root(dot(box.half, box.half)) * (1.0 + LEAN)
    turning = math.sqrt(dot(motion_bound.spin, motion_bound.spin)) * radius
    return square_root(dot(v, v)) + turning + motion_bound.rest


@inline
def motion_bound_of_box_along(box, direction, motion_bound):
    """[m] an upper bound on the motion of any point of a box along a unit direction, in either sense."""
    first = abs(dot(direction, velocity_at(motion_bound, box.centre)))
    return first + box_reach(box, cross(direction, motion_bound.spin)) + motion_bound.rest

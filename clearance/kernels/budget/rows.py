"""The errors that move a body, one row each from its tip to its base, in the body's frame.

A row is a turn about an axis, a slide, a turn of a frame about any axis with an offset of its origin, or the
motion that all joints of one clock make together. `NOTES.md` in `clearance/budget` has the proofs. Not for: the
distance under the rows (`error_rows`), and the sizes of errors (`errors`).
"""

import math
from typing import NamedTuple

from clearance.compile.decorators import inline
from clearance.kernels.arithmetic.vec3 import (
    Vec3,
    along,
    cross,
    dot,
    move,
    move_back,
    rigid,
    row,
    sub,
    turn,
    turn_back,
)
from clearance.kernels.budget.errors import (
    CHORD,
    FIRST,
    FIRST_AT_REST,
    FRAME,
    KIND,
    OFFSET,
    OFFSETS,
    REACH,
    RESIDUAL,
    REST,
    REST_AT_REST,
    SLIDE,
    SLIDE_LENGTH,
    SURFACE,
    TOGETHER,
    TURN,
    TURNED,
)
from clearance.kernels.budget.reach import Ball, from_axis, reach_of_ball, residual_of_velocity
from clearance.kernels.features.bounds import LEAN
from clearance.kernels.mesh.surface import box_of
from clearance.kernels.motion.joint_path import OUTWARD
from clearance.kernels.motion.kinematics import NO_PARENT, SLIDING, TURNING, world_axis


class _Chain(NamedTuple):
    """Sums from the tip of a chain to its base: with motion, and of the errors alone.

    Attributes:
        above: [rad] all turns above. moved: [m] the greatest motion of any point by all below. rest: [m].
    """

    above: float
    moved: float
    rest: float
    above_still: float
    moved_still: float
    rest_still: float


@inline
def _write(rows, n, origin, axis, kind, first, offset):
    """One more row; how many there are."""
    r = rows[n]
    r[0], r[1], r[2] = origin.x, origin.y, origin.z
    r[3], r[4], r[5] = axis.x, axis.y, axis.z
    r[KIND], r[FIRST], r[OFFSET], r[FIRST_AT_REST] = kind, first, offset, first
    r[CHORD], r[SLIDE_LENGTH] = 0.0, 0.0
    return n + 1


@inline
def chord(angle):
    """2 sin(angle / 2), rounded up; 2 for half a turn or more."""
    return 2.0 * math.sin(0.5 * min(angle, math.pi)) * OUTWARD


@inline
def _turned(chain, size, still, arm):
    """The sums after a turn whose axis or origin is `arm` [m] from the body's farthest point."""
    above, above_still = max(0.0, chain.above - size), max(0.0, chain.above_still - still)
    far, far_still = arm + chain.moved, arm + chain.moved_still
    return _Chain(
        above, chain.moved + size * far,
        chain.rest + 0.5 * size * far * (size + 2.0 * above),
        above_still, chain.moved_still + still * far_still,
        chain.rest_still + 0.5 * still * far_still * (still + 2.0 * above_still),
    )  # fmt: skip


@inline
def _slid(chain, size, still):
    """The sums after a slide or an offset."""
    return _Chain(
        chain.above, chain.moved + size, chain.rest + size * chain.above,
        chain.above_still, chain.moved_still + still, chain.rest_still + still * chain.above_still,
    )  # fmt: skip


@inline
def _frame(rows, n, origin, angle, xyz, ball, chain):
    """A row of a frame at `origin` (body frame), and the sums after it."""
    if angle > 0.0 or xyz > 0.0:
        n = _write(rows, n, origin, Vec3(0.0, 0.0, 0.0), FRAME, angle, xyz)
        rows[n - 1, CHORD] = chord(angle)
        arm = math.sqrt(dot(sub(ball.t, origin), sub(ball.t, origin))) + ball.radius
        chain = _slid(_turned(chain, angle, angle, arm), xyz, xyz)
    return n, chain


@inline
def ball_of(surface, root):
    """The `Ball` about the box of a body."""
    box = box_of(surface, root)
    return Ball(box.centre, math.sqrt(dot(box.half, box.half)) * (1.0 + LEAN))


@inline
def _joint_of_the_past(rows, n, origin, axis, angle, xyz, ball, chain):
    """A row of a turn by up to `angle` or a slide by up to `xyz` (body frame), and the sums after it."""
    if angle > 0.0:
        n = _write(rows, n, origin, axis, TURN, angle, 0.0)
        rows[n - 1, CHORD] = chord(angle)
        chain = _turned(chain, angle, angle, from_axis(ball, origin, axis))
    elif xyz > 0.0:
        n = _write(rows, n, origin, axis, SLIDE, xyz, 0.0)
        rows[n - 1, SLIDE_LENGTH] = xyz * OUTWARD
        chain = _slid(chain, xyz, xyz)
    return n, chain


@inline
def _extras(extras, i, pose, tip_pose, rows, n, ball, chain):
    """Rows of all further errors of a link or body at a pose, for a body at `tip_pose`."""
    for k in range(extras.starts[i], extras.starts[i + 1]):
        o, a = row(extras.origins, k), row(extras.axes, k)
        origin = move_back(tip_pose, move(pose, o))
        angle, xyz = extras.angle[k], extras.xyz[k]
        if dot(a, a) > 0.0:
            axis = turn_back(tip_pose, turn(pose, a))
            n, chain = _joint_of_the_past(rows, n, origin, axis, angle, xyz, ball, chain)
        else:
            n, chain = _frame(rows, n, origin, angle, xyz, ball, chain)
    return n, chain


@inline
def _share_of_clock(errors, half, link):
    """The share of a joint's motion that an error of its clock causes: 0 to 1."""
    delay = errors.delay[link]
    return delay / (delay + half) if delay > 0.0 else 0.0


@inline
def _turns_above(links, errors, middle, half, link):
    """[rad] all turns of a chain, with motion and of the errors alone."""
    moving = still = 0.0
    i = link
    while i != NO_PARENT:
        extra = errors.angle[i] + middle.turned[i]
        for k in range(errors.of_links.starts[i], errors.of_links.starts[i + 1]):
            extra += errors.of_links.angle[k]
        if links.parents[i] != NO_PARENT and links.kinds[i] == TURNING:
            size = abs(middle.state.swing[i]) + middle.state.bend[i]
            moving += errors.joint[i] + size
            still += errors.joint[i] + size * _share_of_clock(errors, half, i)
        moving += extra
        still += extra
        i = links.parents[i]
    return moving, still


@inline
def _joint_origin(links, poses, i):
    """The origin of the frame of a link's joint, in the world [m]."""
    parent = links.parents[i]
    t = rigid(links.parent_from_joint[i]).t
    return t if parent == NO_PARENT else move(rigid(poses[parent]), t)


@inline
def fill_rows(surface, world, body, errors, middle, half, found):
    """Writes the rows of a body that a link carries, about the `Middle` of a part; `half` [s] is half of that."""
    links, link, poses = world.links, world.frames[body], middle.state.poses
    rows = found.rows[body]
    ball = ball_of(surface, surface.roots[world.solids[body]])
    pose = rigid(poses[link])
    n = 0
    turns, turns_still = _turns_above(links, errors, middle, half, link)
    chain = _Chain(turns, 0.0, 0.0, turns_still, 0.0, 0.0)
    nothing = Vec3(0.0, 0.0, 0.0)
    velocity, spin, clock, share, moves = nothing, nothing, -1, 0.0, False
    i = link
    while i != NO_PARENT:
        joint, swing, bend = errors.joint[i], middle.state.swing[i], middle.state.bend[i]
        size = joint + abs(swing) + bend
        has_joint = links.parents[i] != NO_PARENT
        if has_joint and size > 0.0 and (links.kinds[i] == TURNING or links.kinds[i] == SLIDING):
            if moves and clock != errors.owner[i]:
                n = _write(rows, n, velocity, spin, TOGETHER, share, 0.0)
                velocity, spin = nothing, nothing
            clock, moves, share = errors.owner[i], True, _share_of_clock(errors, half, i)
            still = joint + share * (size - joint)
            axis = turn_back(pose, world_axis(links, poses, i))
            at = poses[i]
            origin = move_back(pose, Vec3(at[0, 3], at[1, 3], at[2, 3]))
            if links.kinds[i] == TURNING:
                n = _write(rows, n, origin, axis, TURN, joint + bend, 0.0)
                rows[n - 1, CHORD] = chord(size)
                chain = _turned(chain, size, still, from_axis(ball, origin, axis))
                spin = along(spin, swing, axis)
                velocity = along(velocity, swing, cross(origin, axis))
            else:
                n = _write(rows, n, origin, axis, SLIDE, joint + bend, 0.0)
                rows[n - 1, SLIDE_LENGTH] = size * OUTWARD
                chain = _slid(chain, size, still)
                velocity = along(velocity, swing, axis)
            rows[n - 1, FIRST_AT_REST] = joint + share * bend
        angle = errors.angle[i] + middle.turned[i]
        if angle > 0.0 or errors.xyz[i] > 0.0:
            origin = move_back(pose, _joint_origin(links, poses, i))
            n, chain = _frame(rows, n, origin, angle, errors.xyz[i], ball, chain)
        n, chain = _extras(errors.of_links, i, rigid(poses[i]), pose, rows, n, ball, chain)
        i = links.parents[i]
    if moves:
        n = _write(rows, n, velocity, spin, TOGETHER, share, 0.0)
    _sum_up(rows, n, ball, chain, turns, errors.surface[body], body, found)


@inline
def fill_rows_of_standing(surface, world, body, errors, found):
    """The same for a standing body."""
    ball = ball_of(surface, surface.roots[world.solids[body]])
    rows = found.rows[body]
    turned = 0.0
    extras = errors.of_bodies
    for k in range(extras.starts[body], extras.starts[body + 1]):
        turned += extras.angle[k]
    chain = _Chain(turned, 0.0, 0.0, turned, 0.0, 0.0)
    own = rigid(world.standing[body])
    n, chain = _extras(extras, body, own, own, rows, 0, ball, chain)
    _sum_up(rows, n, ball, chain, turned, errors.surface[body], body, found)


@inline
def _sum_up(rows, n, ball, chain, turned, surface, body, found):
    offsets = 0.0
    for k in range(n):
        offsets += rows[k, OFFSET]
    sums = found.sums[body]
    sums[OFFSETS], sums[SURFACE], sums[TURNED] = offsets, surface, turned
    sums[REST], sums[REST_AT_REST] = chain.rest * OUTWARD, chain.rest_still * OUTWARD
    sums[REACH] = reach_of_ball(rows, n, ball) * OUTWARD
    residual = residual_of_velocity(rows, n, ball)
    sums[RESIDUAL] = (residual + chain.rest) * OUTWARD if residual >= 0.0 else -1.0
    found.n_rows[body] = n

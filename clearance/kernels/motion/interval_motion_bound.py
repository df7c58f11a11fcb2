"""The interval motion bound: the most that bodies can have moved, by their joints alone, so that steps are
skipped.

A joint that turns by an angle w moves no point farther than w times its distance from the axis, one that slides by
w no farther than w; a change of several joints is made one after another. So between any two steps

    |x' - x| <= sum over the joints k above the link of |q_k' - q_k| radius_k,

with radius_k, the motion radius: the farthest that a point of the body gets from joint k in any pose. It needs no
pose.

A ball joint follows the four parts of a unit quaternion. Take the nearer one of q and -q to q': with t the angle
between the orientations, q . q' = cos(t/2), so |q' - q|^2 = 2 - 2 cos(t/2) and |q' - q| = 2 sin(t/4). A point at
most r from the joint moves no farther than the chord

    2 r sin(t/2) = 4 r sin(t/4) cos(t/4) <= 2 r |q' - q| <= sum over the four parts of |q_i' - q_i| 2 r,

so the motion radius of each part is 2 r. Quaternions of lengths not below l, made of length one, are no more than
|q' - q| / l apart: then it is 2 r / l.
Not for: the motion between the steps (`joint_motion_bound`).
"""

import math

from clearance.compile.decorators import inline
from clearance.kernels.arithmetic.double_double import defect_of
from clearance.kernels.arithmetic.vec3 import cross, dot, rigid, row
from clearance.kernels.mesh.surface import box_of, corner_of
from clearance.kernels.motion.kinematics import (
    BALL,
    NO_COLUMN,
    NO_PARENT,
    SLIDING,
    TURNING,
)

OUTWARD = 1.0 + 2.0**-16
"""Covers the rounding of the sums here and the stretch by the rotations of a chain."""

POSE_ROUNDING = 2.0**-36
"""Rounding of the poses of a chain of up to a thousand links, relative to its reach from the origin."""

ANGLE_ROUNDING = 2.0**-50
"""Rounding of the position of a joint that follows another, relative to the magnitudes of the summands."""


@inline
def _radius(box):
    """[m] the greatest distance of a body's points from the origin of its frame."""
    far_sq = 0.0
    for corner in range(8):
        x = corner_of(box, corner)
        far_sq = max(far_sq, dot(x, x))
    return math.sqrt(far_sq)


@inline
def _radius_about(box, axis):
    """[m] the greatest distance of a body's points from a unit axis through the origin of its frame."""
    far_sq = 0.0
    for corner in range(8):
        away = cross(corner_of(box, corner), axis)
        far_sq = max(far_sq, dot(away, away))
    return math.sqrt(far_sq)


@inline
def _length(pose):
    """[m] of the shift of a pose."""
    return math.sqrt(pose[0, 3] * pose[0, 3] + pose[1, 3] * pose[1, 3] + pose[2, 3] * pose[2, 3])


@inline
def _farthest_slide(links, link, positions):
    """[m] the greatest slide of the joint above a link."""
    column = links.columns[link]
    most = 0.0
    for i in range(0 if column == NO_COLUMN else len(positions)):
        most = max(most, abs(links.factors[link] * positions[i, column] + links.offsets[link]))
    return most


@inline
def _least_length(positions, column):
    """[-] of the quaternions of a ball joint."""
    least_sq = math.inf
    for i in range(len(positions)):
        length_sq = 0.0
        for k in range(column, column + 4):
            length_sq += positions[i, k] * positions[i, k]
        least_sq = min(least_sq, length_sq)
    return math.sqrt(least_sq)


@inline
def _motion_radii_of_body(box, links, link, positions, motion_radii):
    """Fills `motion_radii` (columns,) of one body, and returns its motion by rounding [m]."""
    radius = _radius(box)
    beyond = 0.0  # [m] from the origin of the current link to the body's own
    own = True  # nothing moves between that link and the body
    stretch = OUTWARD  # by rotations that are off orthonormal
    noise = 0.0
    while links.parents[link] != NO_PARENT:
        column = links.columns[link]
        if links.kinds[link] == SLIDING:
            beyond += _farthest_slide(links, link, positions)
        if links.kinds[link] == BALL:
            arm = 2.0 * (radius + beyond) / _least_length(positions, column)
            for k in range(column, column + 4):
                motion_radii[k] += arm
        elif column != NO_COLUMN:
            arm = 1.0
            if links.kinds[link] == TURNING:
                arm = _radius_about(box, row(links.axes, link)) if own else radius + beyond
            motion_radii[column] += abs(links.factors[link]) * arm
            noise += abs(links.offsets[link]) * arm * ANGLE_ROUNDING
        beyond += _length(links.parent_from_joint[link])
        stretch *= 1.0 + defect_of(rigid(links.parent_from_joint[link]))
        own = False
        link = links.parents[link]
    stretch *= 1.0 + defect_of(rigid(links.parent_from_joint[link]))
    for column in range(len(motion_radii)):
        motion_radii[column] *= stretch
    return stretch * (
        noise + POSE_ROUNDING * (radius + beyond + _length(links.parent_from_joint[link]))
    )


@inline
def fill_motion_radii(surface, world, positions, motion_radii, noise):
    """Fills the motion radii of each body for each column of `positions`, and its motion by rounding.

    Args:
        world: a `World`.
        positions: (k, columns) of all steps [rad or m].
        motion_radii: (bodies, columns) [m per rad, m, or part of a quaternion]. noise: (bodies,) [m].
    """
    frames = world.frames
    for body in range(len(frames)):
        noise[body] = 0.0
        for column in range(motion_radii.shape[1]):
            motion_radii[body, column] = 0.0
        if frames[body] >= 0:
            box = box_of(surface, surface.roots[world.solids[body]])
            noise[body] = _motion_radii_of_body(
                box, world.links, frames[body], positions, motion_radii[body]
            )


@inline(force=True)
def interval_motion_bound_of(positions, last, step, motion_radii, noise):
    """[m] an upper bound on the motion of a body from one step to another.

    Args:
        positions: as in `fill_motion_radii`; last, step: rows of it. motion_radii: (columns,), noise: of the body.
    """
    moved = noise
    for column in range(len(motion_radii)):
        before, after = positions[last, column], positions[step, column]
        moved += motion_radii[column] * (
            abs(after - before) + ANGLE_ROUNDING * (abs(after) + abs(before))
        )
    return moved

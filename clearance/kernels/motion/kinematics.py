"""Forward kinematics of trees of links: of one step, or of many at once."""

import math
from typing import NamedTuple

import numpy as np

from clearance.compile.declared import Floats, Floats2, Floats3, Floats4, Integers
from clearance.compile.decorators import inline, kernel
from clearance.kernels.arithmetic.vec3 import RigidMotion, Vec3, after, move, rigid

FIXED, TURNING, SLIDING, BALL = 0, 1, 2, 3

NO_PARENT, NO_COLUMN = -1, -1


class Links(NamedTuple):
    """The links of all robots one after the other, parents before children, and their joints.

    Attributes:
        parents: (links,) or `NO_PARENT` for a root; roots stand.
        kinds: (links,) of the joint above each link. axes: (links, 3) its unit axis.
        parent_from_joint: (links, 4, 4) its fixed part [m]; the pose in the world for a root.
        columns: (links,) of the positions that the joint follows, or `NO_COLUMN`. A ball joint follows four
            columns: a quaternion (x, y, z, w) of length one to within rounding.
        factors, offsets: (links,) its position is factor times the column, plus offset [rad or m]; 1, 0 for a ball
            joint.
    """

    parents: Integers
    kinds: Integers
    axes: Floats2
    parent_from_joint: Floats3
    columns: Integers
    factors: Floats
    offsets: Floats


@inline(force=True)
def _turned(m, axis, position):
    """The motion `m` after a turn about a unit axis."""
    s = math.sin(position)
    v = 2.0 * math.sin(0.5 * position) ** 2  # 1 - cos without cancellation
    x, y, z = axis[0], axis[1], axis[2]
    turn = RigidMotion(
        1.0 - v * (y * y + z * z), v * x * y - s * z, v * x * z + s * y,
        v * x * y + s * z, 1.0 - v * (x * x + z * z), v * y * z - s * x,
        v * x * z - s * y, v * y * z + s * x, 1.0 - v * (x * x + y * y),
        Vec3(0.0, 0.0, 0.0),
    )  # fmt: skip
    return after(m, turn)


@inline(force=True)
def _slid(m, axis, position):
    """The motion `m` after a slide along an axis."""
    shift = Vec3(axis[0] * position, axis[1] * position, axis[2] * position)
    return RigidMotion(m.xx, m.xy, m.xz, m.yx, m.yy, m.yz, m.zx, m.zy, m.zz, move(m, shift))


@inline(force=True)
def _oriented(m, positions, column):
    """The motion `m` after the rotation of the quaternion at `positions[column : column + 4]`.

    Exactness: the rotation is orthonormal to a few roundings, for a quaternion of any length.
    """
    x, y, z = positions[column], positions[column + 1], positions[column + 2]
    w = positions[column + 3]
    s = 2.0 / (x * x + y * y + z * z + w * w)
    turn = RigidMotion(
        1.0 - s * (y * y + z * z), s * (x * y - z * w), s * (x * z + y * w),
        s * (x * y + z * w), 1.0 - s * (x * x + z * z), s * (y * z - x * w),
        s * (x * z - y * w), s * (y * z + x * w), 1.0 - s * (x * x + y * y),
        Vec3(0.0, 0.0, 0.0),
    )  # fmt: skip
    return after(m, turn)


@inline(force=True)
def orient(pose, quaternion, out):
    """Writes a (4, 4) pose that is turned by a quaternion (4,) first."""
    _write(_oriented(rigid(pose), quaternion, 0), out)


@inline
def world_axis(links, poses, link):
    """The axis of the joint above a link in the world, with the links at `poses` (links, 4, 4)."""
    pose = poses[link]
    x, y, z = links.axes[link, 0], links.axes[link, 1], links.axes[link, 2]
    return Vec3(
        pose[0, 0] * x + pose[0, 1] * y + pose[0, 2] * z,
        pose[1, 0] * x + pose[1, 1] * y + pose[1, 2] * z,
        pose[2, 0] * x + pose[2, 1] * y + pose[2, 2] * z,
    )


@inline(force=True)
def copy_pose(pose, out):
    """Copies a (4, 4) pose."""
    for i in range(4):
        for k in range(4):
            out[i, k] = pose[i, k]


@inline(force=True)
def _write(m, out):
    """Writes a motion as a (4, 4) pose."""
    out[0, 0], out[0, 1], out[0, 2], out[0, 3] = m.xx, m.xy, m.xz, m.t.x
    out[1, 0], out[1, 1], out[1, 2], out[1, 3] = m.yx, m.yy, m.yz, m.t.y
    out[2, 0], out[2, 1], out[2, 2], out[2, 3] = m.zx, m.zy, m.zz, m.t.z
    out[3, 0], out[3, 1], out[3, 2], out[3, 3] = 0.0, 0.0, 0.0, 1.0


@inline(force=True)
def _place_link(world_from_parent, parent_from_joint, kind, axis, position, out):
    """Writes the pose of a link whose joint, no ball joint, is at `position`."""
    at = after(rigid(world_from_parent), rigid(parent_from_joint))
    if kind == TURNING:
        at = _turned(at, axis, position)
    elif kind == SLIDING:
        at = _slid(at, axis, position)
    _write(at, out)


@inline(force=True)
def place_links(links, positions, poses, wanted, visit):
    """Fills `poses` (links, 4, 4) of the links whose `wanted` (links,) is `visit`, the joints at `positions`.

    All links above a wanted one must be wanted. Poses [m]; positions (columns,) [rad or m].
    """
    for link in range(len(links.parents)):
        if wanted[link] != visit:
            continue
        parent = links.parents[link]
        if parent == NO_PARENT:
            _write(rigid(links.parent_from_joint[link]), poses[link])
            continue
        column = links.columns[link]
        if links.kinds[link] == BALL:
            at = after(rigid(poses[parent]), rigid(links.parent_from_joint[link]))
            _write(_oriented(at, positions, column), poses[link])
            continue
        position = (
            0.0
            if column == NO_COLUMN
            else links.factors[link] * positions[column] + links.offsets[link]
        )
        _place_link(
            poses[parent], links.parent_from_joint[link], links.kinds[link], links.axes[link],
            position, poses[link],
        )  # fmt: skip


@inline(force=True)
def place_by_joint(links, link, positions, poses):
    """Writes the pose of one link in `poses` (links, 4, 4) [m], which has the pose of its parent.

    No joint is a ball joint; `positions` (links,) [rad or m] of the joint above each link.
    """
    parent = links.parents[link]
    if parent == NO_PARENT:
        _write(rigid(links.parent_from_joint[link]), poses[link])
    else:
        _place_link(
            poses[parent], links.parent_from_joint[link], links.kinds[link], links.axes[link],
            positions[link], poses[link],
        )  # fmt: skip


@inline
def place_by_link(links, positions, poses):
    """Fills `poses` (links, 4, 4) [m] of all links, as `place_by_joint` does."""
    for link in range(len(links.parents)):
        place_by_joint(links, link, positions, poses)


@kernel
def place_each(links: Links, positions: Floats2, poses: Floats4):
    """`place_links` of all links for positions (n, columns) and poses (n, links, 4, 4)."""
    all_wanted = np.zeros(len(links.parents), dtype=np.int64)
    for step in range(len(positions)):
        place_links(links, positions[step], poses[step], all_wanted, 0)

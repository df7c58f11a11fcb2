"""Forward kinematics of a tree of links for many steps at once."""

import math

import numpy as np

from clearance.jit import inlined, kernel

FIXED, TURNING, SLIDING = 0, 1, 2


@inlined
def _joint_motion(kind, axis, position, out):
    """Writes the 3 x 4 motion of one joint at `position` into `out`."""
    for r in range(3):
        for c in range(4):
            out[r, c] = 1.0 if r == c else 0.0
    if kind == SLIDING:
        for r in range(3):
            out[r, 3] = axis[r] * position
    elif kind == TURNING:
        s = math.sin(position)
        v = 2.0 * math.sin(0.5 * position) ** 2  # 1 - cos without cancellation
        x, y, z = axis[0], axis[1], axis[2]
        out[0, 0] = 1.0 - v * (y * y + z * z)
        out[1, 1] = 1.0 - v * (x * x + z * z)
        out[2, 2] = 1.0 - v * (x * x + y * y)
        out[0, 1] = v * x * y - s * z
        out[1, 0] = v * x * y + s * z
        out[0, 2] = v * x * z + s * y
        out[2, 0] = v * x * z - s * y
        out[1, 2] = v * y * z - s * x
        out[2, 1] = v * y * z + s * x


@inlined
def _compose(a, b, out):
    """Writes the product of two affine maps, of which only the upper 3 x 4 parts are read, into `out`."""
    for r in range(3):
        for c in range(4):
            value = a[r, 0] * b[0, c] + a[r, 1] * b[1, c] + a[r, 2] * b[2, c]
            out[r, c] = value + a[r, 3] if c == 3 else value


@kernel
def forward(world_from_base, parents, kinds, parent_from_joint, axes, positions, poses):
    """Fills `poses` (n, n_links, 4, 4) from joint `positions` (n, n_links) in link order.

    Link 0 is the root; link i > 0 hangs on link `parents[i]` < i by a joint of kind `kinds[i]` with the
    fixed part `parent_from_joint[i]` (4, 4) and the unit axis `axes[i]`.
    """
    moved = np.empty((3, 4))
    placed = np.empty((3, 4))
    for step in range(poses.shape[0]):
        for link in range(poses.shape[1]):
            out = poses[step, link]
            if link == 0:
                for r in range(3):
                    for c in range(4):
                        out[r, c] = world_from_base[r, c]
            else:
                _joint_motion(kinds[link], axes[link], positions[step, link], moved)
                _compose(poses[step, parents[link]], parent_from_joint[link], placed)
                _compose(placed, moved, out)
            out[3, 0] = 0.0
            out[3, 1] = 0.0
            out[3, 2] = 0.0
            out[3, 3] = 1.0

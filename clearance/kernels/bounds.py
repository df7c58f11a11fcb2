"""Lower bounds: each pruning rule is a function that never exceeds the distance it bounds."""

import math

from clearance.jit import inlined
from clearance.kernels.vec3 import row, sub, turn, turn_back

SLACK = 64.0 * 2.0**-53
"""Rounding of a box bound, relative to the sum of the coordinates' magnitudes: 20 operations, doubled thrice."""


@inlined
def _axis_gap(centre, half_a, half_b, slack):
    gap = abs(centre) - half_a - half_b - slack
    return gap if gap > 0.0 else 0.0


@inlined
def lower_bound_boxes_sq(a, node_a, b, node_b, m, slack):
    """A lower bound on the squared distance of two node boxes, each in its body's frame.

    In the frame of either box the other one fits in an axis-parallel box of half sizes |R| h; the distance
    of the two axis-parallel boxes is a lower bound, and the greater of the two is returned.
    """
    h = row(a.halves, node_a)
    k = row(b.halves, node_b)
    ca = row(a.centres, node_a)
    cb = row(b.centres, node_b)
    d = sub(turn(m, cb), sub(ca, m.t))  # centre of b as seen from that of a, in a's frame
    x = _axis_gap(d.x, h.x, abs(m.xx) * k.x + abs(m.xy) * k.y + abs(m.xz) * k.z, slack)
    y = _axis_gap(d.y, h.y, abs(m.yx) * k.x + abs(m.yy) * k.y + abs(m.yz) * k.z, slack)
    z = _axis_gap(d.z, h.z, abs(m.zx) * k.x + abs(m.zy) * k.y + abs(m.zz) * k.z, slack)
    in_a = x * x + y * y + z * z
    d = turn_back(m, d)
    x = _axis_gap(d.x, k.x, abs(m.xx) * h.x + abs(m.yx) * h.y + abs(m.zx) * h.z, slack)
    y = _axis_gap(d.y, k.y, abs(m.xy) * h.x + abs(m.yy) * h.y + abs(m.zy) * h.z, slack)
    z = _axis_gap(d.z, k.z, abs(m.xz) * h.x + abs(m.yz) * h.y + abs(m.zz) * h.z, slack)
    return max(in_a, x * x + y * y + z * z)


@inlined
def rounding_slack(a, root_a, b, root_b, m):
    """[m] how much rounding can raise a box bound of this body pair."""
    reach = abs(m.t.x) + abs(m.t.y) + abs(m.t.z)
    for axis in range(3):
        reach += abs(a.centres[root_a, axis]) + a.halves[root_a, axis]
        reach += abs(b.centres[root_b, axis]) + b.halves[root_b, axis]
    return SLACK * reach


@inlined
def displacement(surface, root, before, after):
    """[m] an upper bound on how far a motion of the body from one pose to another moves any of its points.

    The displacement is the norm of an affine map, hence convex: its maximum over the body's box is
    attained at a corner. `before` and `after` are (4, 4) poses.
    """
    most_sq = 0.0
    for corner in range(8):
        sx = 1.0 if corner & 1 else -1.0
        sy = 1.0 if corner & 2 else -1.0
        sz = 1.0 if corner & 4 else -1.0
        x = surface.centres[root, 0] + sx * surface.halves[root, 0]
        y = surface.centres[root, 1] + sy * surface.halves[root, 1]
        z = surface.centres[root, 2] + sz * surface.halves[root, 2]
        moved_sq = 0.0
        for i in range(3):
            moved = (
                (after[i, 0] - before[i, 0]) * x
                + (after[i, 1] - before[i, 1]) * y
                + (after[i, 2] - before[i, 2]) * z
                + (after[i, 3] - before[i, 3])
            )
            moved_sq += moved * moved
        most_sq = max(most_sq, moved_sq)
    return math.sqrt(most_sq) * (1.0 + SLACK)

"""Where the links of a robot are and what they carry, by rational arithmetic that shares no code with the package.

The numbers of the robot (poses of joints, axes, positions) are taken as the rationals that they are; an axis says
a direction. Sines and cosines are Taylor sums of integers. Coordinates come back on a grid of 2^-120, far below
what a float can tell, so that integers stay short.
"""

from __future__ import annotations

from collections.abc import Iterable, Mapping, Sequence
from fractions import Fraction

from tests.oracle.rationals import cross, root

BITS = 180
GRID = 1 << 120
Pose = list[list[Fraction]]
"""Three rows of four numbers."""


def sine_and_cosine(angle: float | Fraction) -> tuple[Fraction, Fraction]:
    """Both to about 2^-160, for angles of a few turns."""
    one = 1 << BITS
    x = Fraction(angle)
    x = x.numerator * one // x.denominator
    sums, term, k = [one, 0, 0, 0], one, 0
    while term:
        k += 1
        term = term * x // (one * k)
        term += term < 0  # floors of negative numbers never come to 0
        sums[k % 4] += term
    return Fraction(sums[1] - sums[3], one), Fraction(sums[0] - sums[2], one)


def link_poses(robot, positions: Mapping[str, float], world_from_base: Iterable) -> dict[str, Pose]:
    """`world_from_link` of every link.

    Args:
        robot: its `link_names`, the root first, and its `joints`, parents before children.
        positions: [rad] or [m] of joints that follow no other; 0 where one is not named.
    """
    by_name = {joint.name: joint for joint in robot.joints}
    poses = {robot.link_names[0]: _pose(world_from_base)}
    for joint in robot.joints:
        fixed = _times(poses[joint.parent], _pose(joint.parent_from_joint))
        poses[joint.child] = _times(fixed, _motion(joint, _position(joint, by_name, positions)))
    return poses


def placed(vertices: Iterable, pose: Iterable) -> list[tuple[Fraction, ...]]:
    """The vertices in the world."""
    rows = _pose(pose)
    return [tuple(_on_grid(_along(row, point)) for row in rows) for point in _rationals(vertices)]


def on(pose: Iterable, other_from_body: Iterable) -> Pose:
    """`world_from_body` of what stands on something at `pose`."""
    return _times(_pose(pose), _pose(other_from_body))


def seen_from(pose: Iterable, world_from_body: Iterable) -> Pose:
    """`other_from_body` of what is at `world_from_body`, as it is seen from something at `pose`."""
    rows = _pose(pose)
    a, b, c = (row[:3] for row in rows)
    columns = [cross(b, c), cross(c, a), cross(a, b)]
    volume = sum(x * y for x, y in zip(a, columns[0], strict=True))
    back = [[column[i] / volume for column in columns] for i in range(3)]
    shift = [-sum(row[k] * rows[k][3] for k in range(3)) for row in back]
    return _times([[*row, x] for row, x in zip(back, shift, strict=True)], _pose(world_from_body))


def rotation_of(quaternion: Sequence[Fraction]) -> list[list[Fraction]]:
    """(3, 3) of a quaternion x, y, z, w of any length but 0, which needs no root."""
    x, y, z, w = quaternion
    s = 2 / (x * x + y * y + z * z + w * w)
    return [
        [1 - s * (y * y + z * z), s * (x * y - z * w), s * (x * z + y * w)],
        [s * (x * y + z * w), 1 - s * (x * x + z * z), s * (y * z - x * w)],
        [s * (x * z - y * w), s * (y * z + x * w), 1 - s * (x * x + y * y)],
    ]


def _position(joint, by_name: Mapping, positions: Mapping[str, float]) -> Fraction:
    if joint.mimic is None:
        return Fraction(float(positions.get(joint.name, 0.0)))
    master = _position(by_name[joint.mimic.joint], by_name, positions)
    return Fraction(joint.mimic.multiplier) * master + Fraction(joint.mimic.offset)


def _motion(joint, position: Fraction) -> Pose:
    kind = str(joint.kind)
    axis = [Fraction(float(x)) for x in joint.axis]
    length = root(sum(x * x for x in axis)) or 1
    x, y, z = axis = [_on_grid(part / length) for part in axis]
    if kind == "prismatic":
        return [[Fraction(i == j) for j in range(3)] + [axis[i] * position] for i in range(3)]
    sine, cosine = sine_and_cosine(position) if kind != "fixed" else (Fraction(0), Fraction(1))
    across = [[0, -z, y], [z, 0, -x], [-y, x, 0]]
    turned = [
        [
            cosine * (i == j) + sine * across[i][j] + (1 - cosine) * axis[i] * axis[j]
            for j in range(3)
        ]
        for i in range(3)
    ]
    return [[*row, Fraction(0)] for row in turned]


def _times(one: Pose, two: Pose) -> Pose:
    product = [[sum(row[k] * two[k][j] for k in range(3)) for j in range(4)] for row in one]
    return [
        [*map(_on_grid, row[:3]), _on_grid(row[3] + pose[3])]
        for row, pose in zip(product, one, strict=True)
    ]


def _along(row: list[Fraction], point: list[Fraction]) -> Fraction:
    return row[0] * point[0] + row[1] * point[1] + row[2] * point[2] + row[3]


def _on_grid(number: Fraction) -> Fraction:
    return Fraction(round(number * GRID), GRID)


def _pose(pose: Iterable) -> Pose:
    return _rationals(list(pose)[:3])


def _rationals(rows: Iterable) -> list[list[Fraction]]:
    return [[x if isinstance(x, Fraction) else Fraction(float(x)) for x in row] for row in rows]

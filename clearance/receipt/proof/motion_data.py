"""What is to be proven, as plain numbers. Not for: where they come from (`receipt.case_data`)."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

FIXED, TURNING, SLIDING, BALL = 0, 1, 2, 3
"""What the joint above a link does. A ball joint takes four columns: a quaternion x, y, z, w."""

NONE = -1
"""The parent of a root, the column of what no column moves, the link of what stands."""

UNIT = 2.0**-30
"""[m] Bounds are claimed in whole numbers of these: about a nanometre."""

NOT_CLAIMED = -(2**62)
"""The bound of an interval of which nothing is claimed."""


class Shape(NamedTuple):
    """A body in its own frame.

    Attributes:
        points: (n, 3) [m]. faces: (m, 3) triangles, or (m, 1) balls about single points.
        radius: [m] of the balls; 0 of triangles.
    """

    name: str
    points: np.ndarray
    faces: np.ndarray
    radius: float

    @property
    def corners(self) -> np.ndarray:
        """(m, k, 3) [m]."""
        return self.points[self.faces]


class Joints(NamedTuple):
    """The links, parents first, and the joint above each.

    Attributes:
        parents: (links,) or `NONE` of a root, which stands. kinds: (links,). axes: (links, 3) in its frame.
        fixed: (links, 4, 4) the joint in its parent's frame [m]; of a root its pose in the world.
        columns: (links,) of the positions that it follows. factors, offsets: (links,) its position is factor
            times that, plus offset.
    """

    parents: np.ndarray
    kinds: np.ndarray
    axes: np.ndarray
    fixed: np.ndarray
    columns: np.ndarray
    factors: np.ndarray
    offsets: np.ndarray


class MountFrames(NamedTuple):
    """What may be off of all that something stands on, or has stood on, beside its own joint; the nearest first.

    Attributes:
        which: (m,) links or bodies that stand there. origins: (m, 3) [m] in their own frames.
        xyz: (m,) [m]. angle: (m,) [rad].
        axes: (m, 3) unit, of a joint that slides by xyz or turns by the angle; 0 of a frame, that does both in
            any direction.
    """

    which: np.ndarray
    origins: np.ndarray
    xyz: np.ndarray
    angle: np.ndarray
    axes: np.ndarray


class Errors(NamedTuple):
    """How far the links and what stands in the world may be from where they are said to be.

    Attributes:
        joint: (links,) [rad or m] of the joint above each. xyz, angle: (links,) [m], [rad] of the frame that it
            hangs on. of_links, of_bodies: what links stand on, and bodies that no link carries.
    """

    joint: np.ndarray
    xyz: np.ndarray
    angle: np.ndarray
    of_links: MountFrames
    of_bodies: MountFrames


class Stretch(NamedTuple):
    """A part of the run in which nothing changes hands.

    Attributes:
        first: the first of its intervals, as the run counts. times: (n + 1,) [s] of its steps.
        positions: (n + 1, columns) [rad or m] between which columns go straight, ball joints about one axis, and
            those that are `cubic` (columns,) on the cubic that has `rates` (n + 1, columns) at both ends.
        carriers: (bodies,) the link that a body is fixed to, or `NONE`: then it stands at `poses` (bodies, 4, 4).
        pairs: (p, 2) bodies to keep apart. rules: (p,) by which claim. padding: (p,) [m] beyond it.
        errors: whatever these are; None where all is taken as it is said to be.
    """

    first: int
    times: np.ndarray
    positions: np.ndarray
    rates: np.ndarray
    cubic: np.ndarray
    joints: Joints
    carriers: np.ndarray
    poses: np.ndarray
    pairs: np.ndarray
    rules: np.ndarray
    padding: np.ndarray
    errors: Errors | None = None

    @property
    def n_intervals(self) -> int:
        """How many intervals it has."""
        return len(self.times) - 1

"""A turn that is allowed about an axis of the world, beside a shift, and what it makes of poses.

What is turned by an angle about a point and shifted moves no point farther than the shift and the angle times how
far the point is from the axis. Not for: by how much (`search`), what is moved (`shift`).
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from clearance.errors import BadChange, NotFinite
from clearance.geometry.pose import pose_from_quaternion
from clearance.geometry.quaternions import quaternions_of
from clearance.simulate.answers.approaches import Approach
from clearance.world.pairs import BodyIndex
from clearance.world.pose_table import PoseTable
from clearance.world.slerp import product

AXES = ("x", "y", "z")

ARM = 0.5
"""[m] One radian counts as half a metre, as with joints."""


@dataclass(frozen=True)
class Turn:
    """A turn that is allowed.

    Attributes:
        axis: of the world, one of `AXES`. about: (x, y, z) [m] a point of it, world; None for the origin of what
            is turned. most: [rad] either way, half a turn at most.

    Raises:
        BadInput: another axis, no finite point, or no angle that could be.
    """

    axis: str
    about: tuple[float, float, float] | None = None
    most: float = float(np.pi)

    def __post_init__(self) -> None:
        if self.axis not in AXES:
            raise BadChange(
                f"a turn about {self.axis!r:.60} is asked for", valid=f"one of {', '.join(AXES)}"
            )
        if self.about is not None:
            point = np.asarray(self.about, dtype=np.float64)
            if point.shape != (3,) or not np.isfinite(point).all():
                raise NotFinite(f"{self.about!r:.60} is no point", valid="x, y and z [m]")
        if not 0.0 < self.most <= np.pi:
            raise BadChange(
                f"a turn of at most {np.degrees(self.most):g} deg is asked for",
                valid="above 0 and up to 180 deg",
            )

    @property
    def direction(self) -> np.ndarray:
        """(3,) of the axis."""
        return np.eye(3)[AXES.index(self.axis)]


@dataclass(frozen=True, eq=False)
class Pivot:
    """A turn of something that stands at a pose.

    Attributes:
        pose: (4, 4) `world_from_…` [m] before it is moved.
    """

    turn: Turn
    pose: np.ndarray

    @property
    def at(self) -> np.ndarray:
        """(3,) [m] the point that is turned about before anything moves, world."""
        about = self.turn.about
        return self.pose[:3, 3].copy() if about is None else np.asarray(about, dtype=np.float64)

    def at_in(self, pose: np.ndarray) -> np.ndarray:
        """(3,) [m] where that point is with the thing at another pose, world."""
        in_thing = self.pose[:3, :3].T @ (self.at - self.pose[:3, 3])
        return np.asarray(pose[:3, :3] @ in_thing + pose[:3, 3])

    def placed(self, x: np.ndarray) -> tuple[list[float], list[float] | None]:
        """The place [m] and the quaternion of the thing after a change; None for the quaternion if it is not
        turned.

        Args:
            x: (4,) [m] the shift, and the angle times `ARM`.
        """
        angle = float(x[3]) / ARM
        if angle == 0.0:
            return (self.pose[:3, 3] + x[:3]).tolist(), None
        turned = _rotation(self.turn.direction, angle)
        place = self.at + turned @ (self.pose[:3, 3] - self.at) + x[:3]
        return place.tolist(), quaternions_of((turned @ self.pose[:3, :3])[None])[0].tolist()

    def moved(self, x: np.ndarray) -> np.ndarray:
        """(4, 4) the pose then [m], as a file gives it by place and quaternion."""
        place, quaternion = self.placed(x)
        if quaternion is not None:
            return pose_from_quaternion(place, quaternion)
        pose = self.pose.copy()
        pose[:3, 3] = place
        return pose

    def moved_table(self, table: PoseTable, x: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
        """(n, 3) places [m] and (n, 4) quaternions of a motion's samples after a change with a turn, as files have
        them.

        Args:
            x: as of `placed`.
        """
        turned = _rotation(self.turn.direction, float(x[3]) / ARM)
        places = (table.positions - self.at) @ turned.T + self.at + x[:3]
        return places, product(quaternions_of(turned[None]), table.quaternions)

    def by_unit(self, points: np.ndarray, pose: np.ndarray) -> np.ndarray:
        """(k, 3) how points of the thing, which is at a pose, move for each unit of the last variable."""
        return np.cross(self.turn.direction, points - self.at_in(pose)) / ARM

    def factors(self, approach: Approach, body: BodyIndex, pose: np.ndarray) -> np.ndarray:
        """(k,) [-] No point of a body that moves with the thing moves farther than this times the change's size.

        The root of 1 and of the square of the farthest point's distance from the axis over `ARM`: by Cauchy and
        Schwarz no more than that comes of a shift and an angle.

        Args:
            pose: (4, 4) of the thing [m].
        """
        shape, case = body.shape_in(approach.case), approach.case
        low, high = shape.bounds
        corners = np.stack(np.meshgrid(*zip(low, high, strict=True)), axis=-1).reshape(-1, 3)
        poses = body.poses_in(case, approach.poses)
        world = np.einsum("kij,cj->kci", poses[:, :3, :3], corners) + poses[:, None, :3, 3]
        arms = np.linalg.norm(np.cross(self.turn.direction, world - self.at_in(pose)), axis=-1)
        return np.hypot(1.0, arms.max(axis=1) / ARM)


def _rotation(axis: np.ndarray, angle: float) -> np.ndarray:
    """(3, 3) about a unit axis along one of the world's."""
    i = int(np.argmax(axis))
    j, k = (i + 1) % 3, (i + 2) % 3
    turned = np.eye(3)
    turned[j, j] = turned[k, k] = np.cos(angle)
    turned[k, j], turned[j, k] = np.sin(angle), -np.sin(angle)
    return turned

"""A robot in the world: where it stands, how it moves, and what of it is measured. Not for: the case (`case`)."""

from __future__ import annotations

import math
from collections.abc import Mapping
from dataclasses import dataclass, field, replace
from typing import Any

import numpy as np

from clearance.errors import BadDimension, Contradiction, NotFinite, NoTrajectory, at
from clearance.geometry.pose import validated_pose
from clearance.world.body import Mount, checked_padding
from clearance.world.collision_matrix import CollisionMatrix
from clearance.world.field_types import owned, require_types
from clearance.world.names import checked_links
from clearance.world.pose_table import require_samples_to_loop
from clearance.world.recording import Recording
from clearance.world.robot import Robot, require_moving_joints
from clearance.world.timing import AS_GIVEN, Timing
from clearance.world.trajectory import Trajectory
from clearance.world.wrap import meant


@dataclass(frozen=True)
class MotionLimit:
    """The greatest speed [rad/s or m/s] and acceleration [rad/s² or m/s²] of a joint, either way.

    Raises:
        BadDimension: a limit that is not above 0.
    """

    velocity: float = math.inf
    acceleration: float = math.inf

    def __post_init__(self) -> None:
        _check_above_0(velocity=self.velocity, acceleration=self.acceleration)


@dataclass(frozen=True)
class PathTolerance:
    """How far a joint may be off its path, and off its goal, before its controller stops [rad or m].

    Attributes:
        trajectory, goal: infinite where the controller does not check.

    Raises:
        BadDimension: one that is not above 0.
    """

    trajectory: float = math.inf
    goal: float = math.inf

    def __post_init__(self) -> None:
        _check_above_0(trajectory=self.trajectory, goal=self.goal)


def _check_above_0(**numbers: float) -> None:
    for name, number in numbers.items():
        if not number > 0.0:
            raise BadDimension(f"{name} {number:g} is given", valid="above 0")


NO_LIMIT = MotionLimit()


@dataclass(frozen=True)
class SelfClearance:
    """The links of a robot are measured against one another.

    Attributes:
        matrix: which pairs are excused, and why; without one, neighbours are.
        trust_never: excuse also what was not seen to meet in random poses.
        geometry: the shapes of the links, as a case file says it; an SRDF is made for those of collision.
    """

    matrix: CollisionMatrix | None = None
    trust_never: bool = False
    geometry: str = "collision"

    def __post_init__(self) -> None:
        require_types(self, matrix=(CollisionMatrix, None))


@dataclass(frozen=True, eq=False)
class PlacedRobot:
    """A robot in the world.

    Attributes:
        trajectory: its commanded motion; None for a robot that only a `Checker` measures.
        world_from_base: (4, 4) pose of the root link [m].
        mount: what it stands on, if that is not the world; then `world_from_base` is the identity.
        timing: when its trajectory is followed.
        fixed_positions: values [rad] or [m] of moving joints that the trajectory does not name.
        exclude_links: links that are not measured.
        self_clearance: True if its links are measured against one another; a `SelfClearance` also says which
            pairs are excused.
        padding: [m] by how much the clearance of links is lessened, by link.
        motion_limits: how fast joints may be, where more than the robot's own file is known.
        path_tolerances: how far the controllers let joints off the trajectory; no clearance is lessened by it.
        trajectory_path: the file that the trajectory is from; empty where it is from none.
        recording: whose measured motion the trajectory is; None where the trajectory is commanded.
        bases: (4, 4) [m] by virtual joint where states put the base; None where neither they nor the case say so.
    """

    robot: Robot
    trajectory: Trajectory | None = None
    world_from_base: np.ndarray = field(default_factory=lambda: np.eye(4))
    fixed_positions: dict[str, float] = field(default_factory=dict)
    exclude_links: tuple[str, ...] = ()
    urdf_path: str = ""
    package_dirs: tuple[str, ...] = ()
    self_clearance: SelfClearance | None = None
    mount: Mount | None = None
    timing: Timing = AS_GIVEN
    padding: dict[str, float] = field(default_factory=dict)
    motion_limits: dict[str, MotionLimit] = field(default_factory=dict)
    path_tolerances: dict[str, PathTolerance] = field(default_factory=dict)
    trajectory_path: str = ""
    recording: Recording | None = None
    bases: Mapping[str, np.ndarray | None] = field(default_factory=dict)

    def __post_init__(self) -> None:
        if isinstance(self.self_clearance, bool):
            asked = SelfClearance() if self.self_clearance else None
            object.__setattr__(self, "self_clearance", asked)
        require_types(
            self, robot=Robot, trajectory=(Trajectory, None), self_clearance=(SelfClearance, None),
            mount=(Mount, None), timing=Timing, padding=Mapping, fixed_positions=Mapping, exclude_links=[str],
        )  # fmt: skip
        for name in ("fixed_positions", "padding", "motion_limits", "path_tolerances", "bases"):
            object.__setattr__(self, name, dict(getattr(self, name)))  # callers use theirs again
        with at("world_from_base"):
            object.__setattr__(self, "world_from_base", owned(validated_pose(self.world_from_base)))
            if self.mount is not None and not np.array_equal(self.world_from_base, np.eye(4)):
                raise Contradiction(
                    "both a base in the world and a mount are given", valid="one of them"
                )
        for name, links in (("padding", self.padding), ("exclude_links", self.exclude_links)):
            with at(name):
                checked_links([*links], self.robot.link_names)
        for link, padding in self.padding.items():
            with at(f"padding.{link}"):
                checked_padding(padding)
        for joint, position in self.fixed_positions.items():
            if not math.isfinite(position):
                raise NotFinite(
                    "a position is NaN or infinite",
                    where=f"fixed_positions.{joint}",
                    valid="finite numbers",
                )
            if self.trajectory is not None and joint in self.trajectory.joint_names:
                raise Contradiction(
                    f"the trajectory moves joint {joint!r}, which is fixed too",
                    where=f"fixed_positions.{joint}",
                    valid="one of them",
                )
        if self.trajectory is not None:
            require_samples_to_loop(self.trajectory.n_steps, self.timing)
            with at(f"robot {self.robot.name!r}: trajectory"):
                require_moving_joints(self.robot, self.trajectory.joint_names)
            object.__setattr__(self, "trajectory", meant(self.robot, self.trajectory))

    def moved_by(self, trajectory: Trajectory, **more: Any) -> PlacedRobot:
        """The robot on another trajectory, with more changes; joints that it moves are fixed no more."""
        moved = {*trajectory.joint_names}
        fixed = {name: at for name, at in self.fixed_positions.items() if name not in moved}
        return replace(self, trajectory=trajectory, fixed_positions=fixed, **more)

    @property
    def joints_given(self) -> tuple[str, ...]:
        """The joints of the trajectory in its order; without one, all moving joints that are not fixed."""
        if self.trajectory is not None:
            return self.trajectory.joint_names
        names = (joint.name for joint in self.robot.moving_joints)
        return tuple(name for name in names if name not in self.fixed_positions)

    @property
    def given_trajectory(self) -> Trajectory:
        """The trajectory of a robot that has one.

        Raises:
            NoTrajectory: there is none.
        """
        if self.trajectory is None:
            raise NoTrajectory(
                f"robot {self.robot.name!r} has no trajectory",
                valid="case.with_trajectory(times, positions)",
            )
        return self.trajectory

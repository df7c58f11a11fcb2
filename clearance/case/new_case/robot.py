"""The robot of a new case: read as a case reads it, with what has to be assumed of it.

Not for: its motion and its scene (`files`).
"""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass, field, replace
from pathlib import Path
from typing import Any

import numpy as np

from clearance.case.driven_robots import Surroundings
from clearance.case.robots import RobotReader
from clearance.errors import NothingToMeasure
from clearance.formats.files.input_files import path_from, resolved
from clearance.formats.mesh_store import MeshStore
from clearance.formats.scene.request import pose_row
from clearance.formats.schema import case as schema
from clearance.formats.schema.strict_model import validated
from clearance.formats.schema.timed import TrajectoryFile
from clearance.formats.text.notes import counted
from clearance.world.notice import naming
from clearance.world.placed_robot import PlacedRobot
from clearance.world.robot import Joint
from clearance.world.trajectory import Trajectory

_FILES = ("urdf", "srdf", "joint_limits", "controllers")
"""Keys of a robot that name files."""

_BESIDE = {
    "srdf": "pairs of links that may touch",
    "joint_limits": "limits of joints",
    "controllers": "path tolerances",
}
"""What the files say that may stand beside the robot's."""

_FIRST = ("xacro", "xacro_args", "package_dirs")
"""Keys that stand beside the robot's file."""


@dataclass(frozen=True)
class NewCaseRequest:
    """What a new case is made from; paths are relative to the current folder.

    Attributes:
        keys: of a robot in a case file, but for its trajectory and joints.
        trajectory: keys of a trajectory; of a program, those of its file.
        states: to move between where there is none. rest: states for the joints that the motion leaves alone.
        scene: a file. includes: of it, as in a case. limits: `fail` and `warn` [m]; None where not given.
    """

    keys: Mapping[str, Any]
    trajectory: Mapping[str, Any] | None = None
    states: Sequence[str] = ()
    rest: Sequence[str] = ()
    scene: str | None = None
    includes: Mapping[str, str] = field(default_factory=dict)
    limits: Mapping[str, float | None] = field(default_factory=dict)

    @property
    def motion_file(self) -> str | None:
        """The file of the trajectory, or of the program in its place."""
        keys = self.trajectory or {}
        return keys["program"]["file"] if "program" in keys else keys.get("file")

    @property
    def srdf(self) -> str | None:
        """The SRDF file."""
        return self.keys.get("srdf")

    @property
    def package_dirs(self) -> Sequence[str]:
        """Folders in which packages are looked for."""
        return self.keys.get("package_dirs", ())


@dataclass(frozen=True)
class NewRobot:
    """The robot, with its trajectory if it is given one.

    Attributes:
        keys: as it was read. rest: states for joints that the motion leaves alone.
        taken, notes: a line each.
        is_seen_only: no link has a collision shape.
    """

    placed: PlacedRobot
    keys: Mapping[str, Any]
    rest: Sequence[str]
    taken: Sequence[str]
    notes: Sequence[str]
    is_seen_only: bool

    @property
    def root(self) -> str:
        """Its first link."""
        return self.placed.robot.link_names[0]

    @property
    def first_body(self) -> str:
        """Its first link that has a shape."""
        return self.placed.robot.bodies[0].name

    def written(self, folder: Path, is_alone: bool) -> dict[str, Any]:
        """Its keys in a case in `folder`.

        Args:
            is_alone: nothing stands around it, so that its links are measured against each other.
        """
        keys = {"self_clearance": True, **self.keys} if is_alone else dict(self.keys)
        keys |= {key: path_from(folder, keys[key]) for key in _FILES if key in keys}
        if "package_dirs" in keys:
            keys["package_dirs"] = [path_from(folder, one) for one in keys["package_dirs"]]
        first = {key: keys.pop(key) for key in ("urdf", *_FIRST) if key in keys}
        pose = pose_row(self.placed.world_from_base)
        base = {"base": pose if "quat_xyzw" in pose else {**pose, "rpy": [0.0, 0.0, 0.0]}}
        if self._is_placed is None:  # each check warns
            base = {}
        keys.pop("joints", None)
        return {**first, **base, "geometry": keys.pop("geometry", "collision"), **keys}

    def standing(self, bases: Mapping[str, np.ndarray]) -> NewRobot:
        """The robot where states put its base, by the virtual joint that does."""
        known = {**self.placed.bases, **bases}
        where = next((one for one in known.values() if one is not None), np.eye(4))
        return replace(self, placed=replace(self.placed, bases=known, world_from_base=where))

    def resting(self, trajectory: Trajectory) -> dict[str, Any]:
        """What stands under `joints` for those that a trajectory does not move."""
        states = self.rest[0] if len(self.rest) == 1 else list(self.rest)
        told = dict(trajectory.elsewhere)
        return ({"state": states} if self.rest else {}) | {
            joint.name: told.get(joint.name, self._rest(joint))
            for joint in self.placed.robot.moving_joints
            if joint.name not in self._set_joints(trajectory)
        }

    def remarks(self, trajectory: Trajectory) -> dict[str, str]:
        """Why each key is as it is."""
        reference = self.placed.robot.reference
        left = {
            joint.name: "assumed: nothing moves it"
            + (", and so the robot's file has it" if reference.get(joint.name) else "")
            for joint in self._unset_joints(trajectory)
        }
        said_by = "by the states" if self._is_placed else "assumed"
        return {"base": f"{said_by}: {self._stands}", **left}

    def assumed(self, trajectory: Trajectory, is_alone: bool) -> Iterator[str]:
        """A line each on what nobody said."""
        if not self._is_placed:
            yield self._stands
        if self.is_seen_only:
            yield "no link has a collision shape: the visual shapes are measured"
        if is_alone:
            yield "nothing stands around the robot, whose links are measured against each other"
        if is_alone and "srdf" not in self.keys:
            yield "all pairs of links but neighbours are measured: no SRDF excuses any"
        left = self._unset_joints(trajectory)
        at_rest = {joint.name: self._rest(joint) for joint in left}
        zero = [name for name, position in at_rest.items() if position == 0.0]
        yield from naming("joints that nothing moves rest at 0", zero, 8)
        own = self.placed.robot.reference
        placed: list[str] = []
        other: list[str] = []
        for name, position in at_rest.items():
            if position != 0.0:
                (placed if position == own.get(name) else other).append(f"{name} {position:g}")
        yield from naming(
            "joints that nothing moves rest where the robot's file has them", placed, 8
        )
        yield from naming("joints that cannot be at 0 rest at the limit next to it", other, 8)

    @property
    def _stands(self) -> str:
        x, y, z = self.placed.world_from_base[:3, 3]
        where = f"({x:g}, {y:g}, {z:g}) m" if x or y or z else "the origin of the world"
        return f"link {self.root!r} stands at {where}"

    @property
    def _is_placed(self) -> bool | None:
        """True if states put its base somewhere; None if a virtual joint moves it, and no state says where."""
        said = [one is not None for one in self.placed.bases.values()]
        return None if False in said else True in said

    def _rest(self, joint: Joint) -> float:
        """[rad] or [m] where its own file has it, or 0; else the limit that is nearest to that."""
        meant = self.placed.robot.reference.get(joint.name, 0.0)
        return float(min(max(meant, joint.lower), joint.upper)) + 0.0

    def _set_joints(self, trajectory: Trajectory) -> set[str]:
        """The joints that the trajectory or a state gives a position."""
        return {*trajectory.joint_names, *self.placed.fixed_positions}

    def _unset_joints(self, trajectory: Trajectory) -> list[Joint]:
        """The joints that neither of them gives a position, nor the start of a message."""
        known = {*self._set_joints(trajectory), *dict(trajectory.elsewhere)}
        return [joint for joint in self.placed.robot.moving_joints if joint.name not in known]


def new_robot(given: NewCaseRequest, meshes: MeshStore) -> NewRobot:
    """The robot that is given; its visual shapes where it has no others and nothing is said of that.

    Raises:
        BadInput: as `RobotReader`.
    """
    keys = dict(given.keys)
    if given.rest:
        keys["joints"] = {"state": list(given.rest)}
    if given.srdf is not None:
        keys["self_clearance"] = True
    try:
        placed, notes = _placed(keys, given, meshes)
    except NothingToMeasure:
        if "geometry" in keys:
            raise
        keys["geometry"] = "visual"
        placed, notes = _placed(keys, given, meshes)
    robot = placed.robot
    from_files = [
        f"robot {robot.name!r} from {meshes.files.shown(Path(placed.urdf_path))}: "
        f"{counted(len(robot.link_names), 'link')}, {len(robot.bodies)} of them with a shape, "
        f"{counted(len(robot.moving_joints), 'joint')} to move"
    ]
    from_files += [
        f"{what} from {meshes.files.shown(resolved(given.keys[key], Path()))}"
        for key, what in _BESIDE.items()
        if key in given.keys
    ]
    seen_only = "geometry" in keys and "geometry" not in given.keys
    return NewRobot(placed, keys, given.rest, from_files, notes, seen_only)


def _placed(
    keys: Mapping[str, Any], given: NewCaseRequest, meshes: MeshStore
) -> tuple[PlacedRobot, list[str]]:
    robot = validated(schema.Robot, dict(keys), "robot")
    motion = None
    if given.trajectory is not None:
        motion = validated(TrajectoryFile, dict(given.trajectory), "trajectory")
    reader = RobotReader(meshes)
    entry = schema.RobotEntry("robot", robot, motion, "trajectory")
    placed, on_motion, _ = reader.moving(entry, Surroundings())
    matrix = placed.self_clearance and placed.self_clearance.matrix
    notes = (*placed.robot.notes, *reader.notes, *on_motion)
    return placed, [*notes, *(matrix.notes if matrix else ())]

"""The robots of a case file, read and placed: URDF, SRDF, trajectory, joints, padding, base. Not for: obstacles
(`scene_file`), and names that only the whole case can know (`case_file`).
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import replace
from pathlib import Path

from clearance.errors import BadInput, MissingFile, UnknownLink, at, nearest_name
from clearance.load import schema
from clearance.load.allow import checked_links
from clearance.load.input_files import InputFiles, resolved
from clearance.load.mesh_store import MeshStore
from clearance.load.motion_names import check_not_given_twice
from clearance.load.robot_formats import read_robot
from clearance.load.robot_request import RobotRequest
from clearance.load.srdf import read_srdf
from clearance.load.timed_files import trajectory_of
from clearance.world.case import PlacedRobot, SelfClearance
from clearance.world.mount import Mount
from clearance.world.moving_joints import require_moving_joints
from clearance.world.robot import Robot
from clearance.world.rules import matches


class RobotReader:
    """Reads the robots of one case; those of one file share its bodies.

    Args:
        folder: against which paths are looked up. meshes: reads and keeps mesh files, and all others.

    Attributes:
        notes: a line each on how what was read so far was taken.
    """

    def __init__(self, folder: Path, meshes: MeshStore) -> None:
        self._folder, self._meshes, self._files = folder, meshes, meshes.files
        self._read: dict[RobotRequest, Robot] = {}
        self.notes: list[str] = []

    def placed(self, entry: schema.RobotEntry) -> PlacedRobot:
        """The robot of an entry.

        Raises:
            BadInput: with the field and the file.
        """
        given, field = entry.robot, entry.field
        request = self._request(given, field)
        robot = self._robot(request, given.name, field)
        with at(f"{field}.joints"):
            require_moving_joints(robot, given.joints)
        with at(f"{field}.exclude_links"):
            exclude_links = checked_links(given.exclude_links, robot.link_names)
        with at(f"{field}.padding"):
            padding = _padding(given.padding, robot.link_names)
        placed = PlacedRobot(
            robot=robot,
            fixed_positions=dict(given.joints),
            exclude_links=exclude_links,
            urdf_path=str(request.path),
            package_dirs=tuple(map(str, request.package_dirs)),
            self_clearance=self._self_clearance(given, field, robot),
            padding=padding,
        )
        if given.base.on is not None:
            placed = replace(placed, mount=Mount(given.base.on, given.base.matrix()))
        else:
            placed = replace(placed, world_from_base=given.base.matrix())
        if entry.trajectory is None:
            return placed
        moved, notes = with_trajectory(entry, placed, self._folder, self._files)
        self.notes += notes
        return moved

    def _request(self, given: schema.Robot, field: str) -> RobotRequest:
        package_dirs = tuple(resolved(text, self._folder) for text in given.package_dirs)
        with at(f"{field}.package_dirs"):
            _refuse_missing_folders(given.package_dirs, package_dirs)
        path = resolved(given.urdf, self._folder)
        return RobotRequest(path, package_dirs, given.geometry, given.collada_up_axis)

    def _robot(self, request: RobotRequest, name: str | None, field: str) -> Robot:
        if request not in self._read:
            with at(f"{field}.urdf"):
                self._read[request] = read_robot(request, self._meshes)
        robot = self._read[request]
        return robot if name is None else replace(robot, name=name)

    def _self_clearance(
        self, given: schema.Robot, field: str, robot: Robot
    ) -> SelfClearance | None:
        """Whether the robot's links are measured against one another, and which pairs an SRDF file excuses."""
        _refuse_idle_excuses(given, field)
        if not given.self_clearance:
            return None
        if given.srdf is None:
            return SelfClearance()
        with at(f"{field}.srdf"):
            matrix = read_srdf(resolved(given.srdf, self._folder), robot, self._files)
        return SelfClearance(matrix, given.trust_never)


def with_trajectory(
    entry: schema.RobotEntry, placed: PlacedRobot, folder: Path, files: InputFiles
) -> tuple[PlacedRobot, tuple[str, ...]]:
    """The robot of an entry with the trajectory of its file, and a line each on how that was taken.

    Args:
        folder: against which its path is looked up.

    Raises:
        BadInput: with the field and the file.
    """
    asked = entry.trajectory
    assert asked is not None
    trajectory, notes = trajectory_of(asked, entry.trajectory_field, folder, placed.robot, files)
    with at(f"{entry.field}.joints"):
        check_not_given_twice(placed.fixed_positions, trajectory.joint_names)
    path = str(resolved(asked.file, folder))
    placed = replace(placed, trajectory=trajectory, timing=asked.timing, trajectory_path=path)
    return placed, notes


def _refuse_idle_excuses(given: schema.Robot, field: str) -> None:
    """Refuses fields about excused pairs where they would excuse nothing."""
    if not given.self_clearance:
        for key in ("srdf", "trust_never"):
            if getattr(given, key):
                raise BadInput(
                    "it excuses pairs of links, which are not measured",
                    where=f"{field}.{key}",
                    valid="self_clearance: true, or no such field",
                )
    elif given.srdf is None and given.trust_never:
        raise BadInput(
            "it speaks of the pairs that an SRDF file calls Never",
            where=f"{field}.trust_never",
            valid=f"{field}.srdf: the file",
        )


def _padding(given: Mapping[str, float], links: Sequence[str]) -> dict[str, float]:
    """[m] by link; of several patterns for a link the last counts."""
    found: dict[str, float] = {}
    for pattern, padding in given.items():
        meant = [link for link in links if matches(link, pattern)]
        if not meant:
            raise UnknownLink(f"no link matches {pattern!r}", valid=nearest_name(pattern, links))
        found |= dict.fromkeys(meant, padding)
    return found


def _refuse_missing_folders(given: Sequence[str], package_dirs: Sequence[Path]) -> None:
    for i, (text, path) in enumerate(zip(given, package_dirs, strict=True)):
        if not path.is_dir():
            raise MissingFile(f"there is no folder {text!r}", where=f"[{i}]")

"""A case file, and all files that it names, to a `Case`: the one entry to this room.

Everything is checked here or on the way, so that a `Case` that exists can be run: names refer to
something, numbers are finite, shapes are solids, times increase.
"""

from __future__ import annotations

import os
from dataclasses import dataclass
from os import PathLike
from pathlib import Path

from clearance.errors import BadInput, MissingFile, at
from clearance.load import schema
from clearance.load.allow import checked_links, checked_pairs
from clearance.load.foreign_files import refuse_foreign
from clearance.load.input_files import InputFiles, resolved
from clearance.load.mesh_store import MeshStore
from clearance.load.motion_names import check_not_given_twice, note_on_joints_at_zero
from clearance.load.plausibility import angle_notices, obstacle_notices, odd_angles, scale_notices
from clearance.load.reserved import reserved_spaces
from clearance.load.scene_file import make_obstacles
from clearance.load.schema_errors import validated
from clearance.load.srdf import read_srdf
from clearance.load.trajectory_file import read_trajectory
from clearance.load.urdf import UrdfRequest, read_robot
from clearance.load.yaml_file import parse_yaml
from clearance.world.case import Case, Limits, PlacedRobot, SelfClearance, SignOff
from clearance.world.moving_joints import require_moving_joints
from clearance.world.names import checked_name
from clearance.world.notice import Notice
from clearance.world.pairs import measured_pairs
from clearance.world.reach import require_few_turns
from clearance.world.robot import Robot
from clearance.world.rules import Allowance
from clearance.world.trajectory import Trajectory


def load_case(path: str | PathLike[str]) -> Case:
    """The case in a YAML file, with robot, scene and trajectory read and checked.

    Args:
        path: the case file; the paths in it are relative to its folder.

    Raises:
        BadInput: what was wrong, in which file and field, and what would be valid.
    """
    path = Path(path)
    files = InputFiles(path.parent)
    meshes = MeshStore(files)
    given, scene_at = _read_schema(path, files)
    with at(path.name):
        placed = _placed_robot(given, path.parent, meshes)
    with at(scene_at.place):
        obstacles, scene_notes = make_obstacles(given.scene.obstacles, scene_at.folder, meshes)
    with at(path.name):
        robot = placed.robot
        others = [obstacle.name for obstacle in obstacles]
        if placed.self_clearance:
            others += robot.link_names
        allow = checked_pairs(given.allow, robot.link_names, others)
        profiles = reserved_spaces(given.profiles, path.parent, files, robot.link_names)
    given_joints = [*placed.asked.joint_names, *placed.fixed_positions]
    case = Case(
        name=given.name or _name_of(path),
        robots=(placed,),
        obstacles=obstacles,
        limits=_limits(given.limits),
        allow=tuple(map(Allowance, allow)),
        contact_response=given.contact_response,
        sources=files.sources,
        notes=(*note_on_joints_at_zero(robot, given_joints), *_srdf_notes(placed), *scene_notes),
        profiles=profiles,
        notices=tuple(_notices(given)),
        accept=tuple(given.accept),
        sign_off=_sign_off(given.report),
    )
    with at(path.name):
        measured_pairs(case)  # refuses a case that leaves nothing to measure
    return case


def _name_of(path: Path) -> str:
    """The name of a case that gives none: its folder's where the file is called case, else the file's."""
    folder = Path(os.path.abspath(path)).parent.name
    return checked_name(folder if path.stem == "case" and folder else path.stem)


def _notices(given: schema.Case) -> list[Notice]:
    obstacles = given.scene.obstacles
    scales = [(item.name, item.mesh.factors) for item in obstacles if item.mesh is not None]
    return [
        *angle_notices(odd_angles("the robot's base", given.robot.base.rpy)),
        *obstacle_notices(obstacles),
        *scale_notices(scales),
    ]


@dataclass(frozen=True)
class _ScenePlace:
    """Where the obstacles are written: file and field for errors, folder for mesh files."""

    place: str
    folder: Path


def _read_schema(path: Path, files: InputFiles) -> tuple[schema.Case, _ScenePlace]:
    data = files.read(path)
    refuse_foreign(data, path.name, "a case file")
    raw = parse_yaml(data, path.name)
    scene_at = _ScenePlace(f"{path.name}: scene", path.parent)
    if isinstance(raw, dict) and isinstance(raw.get("scene"), str):
        with at(f"{path.name}: scene"):
            scene_path = resolved(raw["scene"], path.parent)
            shown = files.shown(scene_path)
            refuse_foreign(files.read(scene_path), shown, "a scene")
            scene = parse_yaml(files.read(scene_path), shown)
            validated(schema.Scene, scene, shown)
        raw = {**raw, "scene": scene}
        scene_at = _ScenePlace(f"{path.name}: scene: {shown}", scene_path.parent)
    return validated(schema.Case, raw, path.name), scene_at


def _placed_robot(given: schema.Case, folder: Path, meshes: MeshStore) -> PlacedRobot:
    urdf_path = resolved(given.robot.urdf, folder)
    package_dirs = tuple(resolved(text, folder) for text in given.robot.package_dirs)
    with at("robot.package_dirs"):
        _refuse_missing_folders(given.robot.package_dirs, package_dirs)
    with at("robot.urdf"):
        request = UrdfRequest(
            urdf_path, package_dirs, given.robot.geometry, given.robot.collada_up_axis
        )
        robot = read_robot(request, meshes)
    trajectory = _trajectory(resolved(given.trajectory.file, folder), robot, meshes)
    with at("robot.joints"):
        require_moving_joints(robot, given.robot.joints)
        check_not_given_twice(given.robot.joints, trajectory.joint_names)
    with at("robot.exclude_links"):
        exclude_links = checked_links(given.robot.exclude_links, robot.link_names)
    return PlacedRobot(
        robot=robot,
        trajectory=trajectory,
        world_from_base=given.robot.base.matrix(),
        fixed_positions=dict(given.robot.joints),
        exclude_links=exclude_links,
        urdf_path=str(urdf_path),
        package_dirs=tuple(str(path) for path in package_dirs),
        self_clearance=_self_clearance(given.robot, robot, folder, meshes.files),
    )


def _self_clearance(
    given: schema.Robot, robot: Robot, folder: Path, files: InputFiles
) -> SelfClearance | None:
    """Whether the robot's links are measured against one another, and which pairs an SRDF file excuses."""
    if not given.self_clearance:
        for field in ("srdf", "trust_never"):
            if getattr(given, field):
                raise BadInput(
                    "it excuses pairs of links, which are not measured",
                    where=f"robot.{field}",
                    valid="self_clearance: true, or no such field",
                )
        return None
    if given.srdf is None:
        if given.trust_never:
            raise BadInput(
                "it speaks of the pairs that an SRDF file calls Never",
                where="robot.trust_never",
                valid="robot.srdf: the file",
            )
        return SelfClearance()
    with at("robot.srdf"):
        matrix = read_srdf(resolved(given.srdf, folder), robot, files)
    return SelfClearance(matrix, given.trust_never)


def _srdf_notes(placed: PlacedRobot) -> tuple[str, ...]:
    asked = placed.self_clearance
    return () if asked is None or asked.matrix is None else asked.matrix.notes


def _refuse_missing_folders(given: list[str], package_dirs: tuple[Path, ...]) -> None:
    for i, (text, path) in enumerate(zip(given, package_dirs, strict=True)):
        if not path.is_dir():
            raise MissingFile(f"there is no folder {text!r}", where=f"[{i}]")


def _trajectory(path: Path, robot: Robot, meshes: MeshStore) -> Trajectory:
    with at("trajectory.file"):
        shown = meshes.files.shown(path)
        opened, n_bytes = meshes.files.unread(path)
        try:
            needed = bool(robot.moving_joints)
            trajectory = read_trajectory(opened, n_bytes, shown, joints_needed=needed)
        except BadInput:
            with opened() as file:
                refuse_foreign(file.read(65536), shown, "a trajectory")
            raise
        with at(shown):
            require_moving_joints(robot, trajectory.joint_names)
            require_few_turns(robot, trajectory.joint_names, trajectory)
    return trajectory


def _sign_off(given: schema.Report | None) -> SignOff | None:
    return None if given is None else SignOff(given.author or "", given.revision or "")


def _limits(given: schema.Limits) -> Limits:
    return Limits(given.fail, given.fail if given.warn is None else given.warn, given.joints)

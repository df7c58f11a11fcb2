"""Small valid files of every kind that is read, and what reads each: where `fuzz_readers` starts from."""

from __future__ import annotations

import tempfile
from collections.abc import Callable
from pathlib import Path
from typing import NamedTuple

import numpy as np

from scripts.bench.fuzz_meshes import (
    CUBE,
    binary_stl,
    collada,
    dxf,
    glb,
    obj,
    off,
    ply_binary,
    ply_text,
    step,
    text_stl,
)
from scripts.bench.fuzz_texts import (
    BOXES,
    CASE,
    COMMAS,
    CONTROL,
    CURVES,
    LIMITS,
    MESSAGE,
    MESSAGE_JSON,
    MJCF,
    PATH,
    PLANNING_SCENE,
    POSES,
    PROFILE,
    ROBOT,
    SCENE_TEXT,
    SDF,
    SRDF,
    STAMPED,
    URDF,
    XACRO,
)
from tests.load.making_clouds import pcd, ply, table
from tests.load.making_octree import octree

CELLS = {(0, 0, 0): True, (1, 0, 0): True, (0, -1, 2): False, (-9, 4, 4): True}

SKETCH = Path(__file__).parents[2] / "scenes" / "sketches" / "d_cell.yaml"


class Reader(NamedTuple):
    """What is read: a valid file, its name, and a function of content and folder that reads it."""

    name: str
    valid: bytes
    read: Callable[[bytes, Path], object]


def readers() -> dict[str, Reader]:
    """Every reader by name."""
    meshes = {
        "STL binary": ("m.stl", binary_stl()),
        "STL text": ("m.stl", text_stl()),
        "OBJ": ("m.obj", obj()),
        "COLLADA": ("m.dae", collada()),
        "PLY text": ("m.ply", ply_text()),
        "PLY binary": ("m.ply", ply_binary()),
        "OFF": ("m.off", off()),
        "GLB": ("m.glb", glb()),
        "STEP": ("m.step", step()),
        "octomap binary": ("m.bt", octree(CELLS)),
        "octomap full": ("m.ot", octree(CELLS, full=True)),
    }
    made = {kind: Reader(name, data, _mesh_reader(name)) for kind, (name, data) in meshes.items()}
    for kind, (name, data) in _scans().items():
        made[kind] = Reader(name, data, _points_reader(name))
    return made | {
        "DXF": Reader("d.dxf", dxf(), _file_reader("d.dxf", _read_dxf)),
        "curves": Reader("c.yaml", CURVES, _file_reader("c.yaml", _read_curves)),
        "profile": Reader("p.yaml", PROFILE, _file_reader("p.yaml", _read_profile)),
        "sketch": Reader("s.yaml", SKETCH.read_bytes(), _file_reader("s.yaml", _read_sketch)),
        "URDF": Reader("arm.urdf", URDF, _case_reader("arm.urdf")),
        "MJCF": Reader("arm.xml", MJCF, _mjcf_reader("arm.xml")),
        "MJCF scene": Reader("world.xml", MJCF, _mjcf_scene_reader("world.xml")),
        "case": Reader("case.yaml", CASE, _case_reader("case.yaml")),
        "SRDF": Reader("arm.srdf", SRDF, _robot_reader("arm.srdf")),
        "joint limits": Reader("limits.yaml", LIMITS, _robot_reader("limits.yaml")),
        "controllers": Reader("control.yaml", CONTROL, _robot_reader("control.yaml")),
        "xacro": Reader("arm.xacro", XACRO, _file_reader("arm.xacro", _read_xacro)),
        "trajectory": Reader("path.csv", PATH, _trajectory_reader("path.csv")),
        "trajectory semicolons": Reader("path.csv", COMMAS, _trajectory_reader("path.csv")),
        "JointTrajectory": Reader("path.yaml", MESSAGE, _trajectory_reader("path.yaml")),
        "JointTrajectory JSON": Reader("path.json", MESSAGE_JSON, _trajectory_reader("path.json")),
        "pose table": Reader("door.csv", POSES, _file_reader("door.csv", _read_poses)),
        "poses stamped": Reader("door.yaml", STAMPED, _file_reader("door.yaml", _read_poses)),
        "PlanningScene": Reader("cell.yaml", PLANNING_SCENE, _scene_reader("cell.yaml")),
        "scene text": Reader("cell.scene", SCENE_TEXT, _scene_reader("cell.scene")),
        "SDF": Reader("cell.sdf", SDF, _scene_reader("cell.sdf")),
        **_bag_readers(),
    }


def _mesh_reader(name: str) -> Callable[[bytes, Path], object]:
    def read(data: bytes, folder: Path) -> object:
        from clearance.load.mesh import mesh_from_bytes

        return mesh_from_bytes(data, name)

    return read


def _scans() -> dict[str, tuple[str, bytes]]:
    points = np.concatenate([CUBE, [[np.nan] * 3]])
    return {
        "PCD ascii": ("s.pcd", pcd(points, "ascii")),
        "PCD binary": ("s.pcd", pcd(points, "binary")),
        "PCD compressed": ("s.pcd", pcd(points, "binary_compressed")),
        "points PLY": ("s.ply", ply(points)),
        "points CSV": ("s.csv", table(points, ",", "x [mm],y [mm],z [mm]")),
        "points XYZ": ("s.xyz", table(points, " ", "")),
    }


def _points_reader(name: str) -> Callable[[bytes, Path], object]:
    def read(data: bytes, folder: Path) -> object:
        from clearance.load.cloud import cloud_from_bytes

        return cloud_from_bytes(data, name, 0.01)

    return read


def _file_reader(name: str, read_file: Callable[[Path], object]) -> Callable[[bytes, Path], object]:
    def read(data: bytes, folder: Path) -> object:
        (folder / name).write_bytes(data)
        return read_file(folder / name)

    return read


def _case_reader(name: str) -> Callable[[bytes, Path], object]:
    def read(data: bytes, folder: Path) -> object:
        from clearance.load.case_file import load_case

        valid = {"case.yaml": CASE, "arm.urdf": URDF, "path.csv": PATH, "m.stl": binary_stl()}
        for other, content in (valid | {name: data}).items():
            (folder / other).write_bytes(content)
        return load_case(folder / "case.yaml")

    return read


def _robot_reader(name: str) -> Callable[[bytes, Path], object]:
    """Reads a robot with all the files that may stand beside it, of which one is damaged."""

    def read(data: bytes, folder: Path) -> object:
        from clearance.load import schema
        from clearance.load.input_files import InputFiles
        from clearance.load.mesh_store import MeshStore
        from clearance.load.robots import RobotReader

        valid = {"arm.urdf": BOXES, "m.stl": binary_stl(), "arm.srdf": SRDF}
        valid |= {"limits.yaml": LIMITS, "control.yaml": CONTROL}
        for other, content in (valid | {name: data}).items():
            (folder / other).write_bytes(content)
        robot = schema.Robot.model_validate(ROBOT)
        entry = schema.RobotEntry("robot", robot, None, "trajectory")
        return RobotReader(folder, MeshStore(InputFiles(folder))).moving(entry)

    return read


def _mjcf_reader(name: str) -> Callable[[bytes, Path], object]:
    def read(data: bytes, folder: Path) -> object:
        from clearance.load.robot_formats import load_robot

        (folder / name).write_bytes(data)
        (folder / "m.stl").write_bytes(binary_stl())
        return load_robot(folder / name)

    return read


def _mjcf_scene_reader(name: str) -> Callable[[bytes, Path], object]:
    def read(data: bytes, folder: Path) -> object:
        from clearance.load.input_files import InputFiles
        from clearance.load.scene_formats import read_scene
        from clearance.load.scene_request import SceneRequest

        (folder / name).write_bytes(data)
        (folder / "m.stl").write_bytes(binary_stl())
        return read_scene(SceneRequest(folder / name, InputFiles(folder)))

    return read


def _read_dxf(path: Path) -> object:
    from clearance.planar.dxf import read_dxf

    return read_dxf(str(path))


def _read_xacro(path: Path) -> object:
    """What is evaluated in the process that is started for it, and then read as URDF."""
    from clearance.errors import BadSyntax
    from clearance.load.urdf_elements import parse_document
    from clearance.load.xacro_process import Watch, evaluated

    made = evaluated(path, {}, Watch())
    if "problem" in made:
        raise BadSyntax(made["problem"], where=path.name)
    return parse_document(made["urdf"].encode())


def _read_curves(path: Path) -> object:
    from clearance.planar.curve_file import read_curve

    return read_curve(str(path))


def _read_profile(path: Path) -> object:
    from clearance.profiles.outline_file import read_profile

    return read_profile(path)


def _read_sketch(path: Path) -> object:
    from clearance.sketch import Sketch

    return Sketch.load(path)


def _read_poses(path: Path) -> object:
    from clearance.load.pose_formats import read_poses
    from clearance.load.pose_table_request import PoseRequest

    return read_poses(PoseRequest(lambda: path.open("rb"), path.stat().st_size), path.name)


def _scene_reader(name: str) -> Callable[[bytes, Path], object]:
    """Reads a scene as a case would: its content, then the solids that it names."""

    def read(data: bytes, folder: Path) -> object:
        from clearance.load.input_files import InputFiles
        from clearance.load.mesh_store import MeshStore
        from clearance.load.obstacle_schema import Scene
        from clearance.load.scene_file import make_obstacles
        from clearance.load.scene_formats import read_scene
        from clearance.load.scene_request import SceneRequest
        from clearance.load.schema_errors import validated

        (folder / "m.stl").write_bytes(binary_stl())
        (folder / name).write_bytes(data)
        files = InputFiles(folder)
        content = read_scene(SceneRequest(folder / name, files))
        given = validated(Scene, content.scene, name).obstacles
        return make_obstacles(given, folder, MeshStore(files))

    return read


def _bag_readers() -> dict[str, Reader]:
    """Bags in each container that rosbags writes; of a folder its one file with the messages."""
    files = {"bag": "run.bag", "mcap": "run.mcap", "rosbag2 sqlite3": "run.db3"}
    return {
        f"bag {kind}": Reader(name, _bag(kind), _file_reader(name, _read_bag))
        for kind, name in files.items()
    }


def _read_bag(path: Path) -> object:
    from clearance.load.timed_files import load_trajectory
    from clearance.load.trajectory_request import Choice

    return load_trajectory(path, Choice())


def _bag(kind: str) -> bytes:
    from tests.load.making_bags import planned, write_bag

    with tempfile.TemporaryDirectory() as folder:
        topics = {"/plan": [planned([0.1, 0.0], [0.3, 0.05])]}
        path = write_bag(Path(folder) / "made", kind, topics)
        file = next(path.glob("*.db3")) if path.is_dir() else path
        return file.read_bytes()


def _trajectory_reader(name: str) -> Callable[[bytes, Path], object]:
    def read(data: bytes, folder: Path) -> object:
        from clearance.load.trajectory_file import parse_trajectory

        return parse_trajectory(data, name)

    return read

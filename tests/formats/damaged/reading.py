"""What reads each kind of file: functions of its content, a folder that they may write into, and its name."""

from __future__ import annotations

import contextlib
import io
from collections.abc import Callable
from functools import lru_cache
from pathlib import Path

from tests.formats.damaged.meshes import binary_stl
from tests.formats.damaged.texts import BOXES, CASE, CONTROL, LIMITS, PATH, ROBOT, SRDF, URDF

Read = Callable[[bytes, Path, str], object]


def mesh(data: bytes, folder: Path, name: str) -> object:
    from clearance.formats.mesh.mesh_file import mesh_from_bytes

    return mesh_from_bytes(data, name).shape.vertices


def points(data: bytes, folder: Path, name: str) -> object:
    from clearance.formats.cloud.formats import cloud_from_bytes

    return cloud_from_bytes(data, name, 0.01).shape.vertices


def by_path(read_path: Callable[[Path], object]) -> Read:
    """A reader of files on disk."""

    def read(data: bytes, folder: Path, name: str) -> object:
        path = folder / name
        path.parent.mkdir(exist_ok=True)
        path.write_bytes(data)
        return read_path(path)

    return read


def case(data: bytes, folder: Path, name: str) -> object:
    """A case with its files, of which one is damaged."""
    from clearance.case.case_file import load_case

    valid = {"case.yaml": CASE, "arm.urdf": URDF, "path.csv": PATH, "m.stl": binary_stl()}
    for other, content in (valid | {name: data}).items():
        (folder / other).write_bytes(content)
    return load_case(folder / "case.yaml")


def robot_beside(data: bytes, folder: Path, name: str) -> object:
    """A robot with all the files that may stand beside it, of which one is damaged."""
    from clearance.case.robots import RobotReader
    from clearance.formats.files.input_files import InputFiles
    from clearance.formats.mesh_store import MeshStore
    from clearance.formats.schema import case as schema

    valid = {"arm.urdf": BOXES, "m.stl": binary_stl(), "arm.srdf": SRDF}
    valid |= {"limits.yaml": LIMITS, "control.yaml": CONTROL}
    for other, content in (valid | {name: data}).items():
        (folder / other).write_bytes(content)
    robot = schema.Robot.model_validate(ROBOT)
    entry = schema.RobotEntry("robot", robot, None, "trajectory")
    return RobotReader(MeshStore(InputFiles(folder))).moving(entry, {})


def robot(data: bytes, folder: Path, name: str) -> object:
    from clearance.formats.robot.request import load_robot

    (folder / "m.stl").write_bytes(binary_stl())
    (folder / name).write_bytes(data)
    return load_robot(folder / name)


def scene(data: bytes, folder: Path, name: str) -> object:
    """A scene as a case would have it: its content, then the solids that it names."""
    from clearance.formats.files.input_files import InputFiles
    from clearance.formats.mesh_store import MeshStore
    from clearance.formats.scene.obstacles import make_obstacles
    from clearance.formats.scene.request import SceneRequest, read_scene
    from clearance.formats.schema.obstacle import Scene
    from clearance.formats.schema.strict_model import validated

    (folder / "m.stl").write_bytes(binary_stl())
    (folder / name).write_bytes(data)
    files = InputFiles(folder)
    content = read_scene(SceneRequest(folder / name, files))
    given = validated(Scene, content.scene, name).obstacles
    return make_obstacles(given, folder, MeshStore(files))


def trajectory(data: bytes, folder: Path, name: str) -> object:
    from clearance.formats.motion.requests import parse_trajectory

    return parse_trajectory(data, name)


def program(data: bytes, folder: Path, name: str) -> object:
    """A program as a case would have it: its moves, then the joints that follow."""
    from clearance.case.driven_robots import Surroundings
    from clearance.case.program import program_motion
    from clearance.formats.files.input_files import InputFiles
    from clearance.formats.schema.timed import TrajectoryFile

    (folder / name).write_bytes(data)
    asked = TrajectoryFile.model_validate({"program": name})
    return program_motion(asked, {}, programmed(), InputFiles(folder), Surroundings())


def controller(data: bytes, folder: Path, name: str) -> object:
    """A program of a controller as moves of a robot."""
    from clearance.formats.known_formats import Kind, format_of, function_at
    from clearance.formats.program.controller_program import ProgramRequest
    from clearance.formats.program.conversion import converted
    from clearance.formats.schema.program import Frame
    from clearance.formats.schema.program_file import ProgramFile

    asked = ProgramFile(file=name, link="tool_tip", base=Frame(on="base"), axes_as="plain")
    row = format_of(Kind.PROGRAM, name, data)
    read = function_at(row.read)(ProgramRequest(data, name, asked))
    return converted(read, asked, programmed().robot, {})


@lru_cache
def programmed():
    """The arm that programs move."""
    from clearance.formats.robot.request import load_robot
    from clearance.world.placed_robot import PlacedRobot

    root = Path(__file__).parents[3]
    return PlacedRobot(load_robot(root / "robots" / "heron6" / "heron6.urdf"))


def bag(path: Path) -> object:
    from clearance.formats.motion.requests import Choice
    from clearance.formats.timed_files import load_trajectory

    return load_trajectory(path, Choice())


def bag_folder(path: Path) -> object:
    """A bag that is a folder, of which the file beside the messages is damaged."""
    from tests.formats.damaged import bags

    (path.parent / "run.db3").write_bytes(bags.bag("rosbag2 sqlite3"))
    return bag(path.parent)


def poses(data: bytes, folder: Path, name: str) -> object:
    from clearance.formats.motion.requests import PoseRequest, read_samples

    return read_samples(PoseRequest(lambda: io.BytesIO(data)), name)


def xacro(path: Path) -> object:
    """What is evaluated in the process that is started for it, and then read as URDF."""
    from clearance.errors import BadSyntax
    from clearance.formats.robot.urdf.xacro_process import evaluated
    from tests.formats.making_urdf import parse_document

    with contextlib.redirect_stderr(io.StringIO()):  # its process hands it on as notes
        made = evaluated(path, {})
    if "problem" in made:
        raise BadSyntax(made["problem"], where=path.name)
    parse_document(made["urdf"].encode())
    return None


def dxf(path: Path) -> object:
    from clearance.planar.dxf import read_dxf

    return read_dxf(str(path))


def curves(path: Path) -> object:
    from clearance.planar.curve_file import read_curve

    return read_curve(str(path))


def outline(path: Path) -> object:
    from clearance.profiles.outline_file import read_outline

    return read_outline(path)


def sketch(path: Path) -> object:
    from clearance.sketch import Sketch

    return Sketch.load(path)


def waivers(path: Path) -> object:
    from clearance.case.waiver_file import load_waivers

    return load_waivers(path)


def manifest(path: Path) -> object:
    from clearance.batch.manifest_file import load_manifest

    return load_manifest(path)


def batch_items(path: Path) -> object:
    from clearance.batch.manifest import batch_of

    for name in ("case.yaml", "cell.yaml", "a.csv"):
        (path.parent / name).write_bytes(CASE)
    return batch_of([str(path)]).items


def case_list(path: Path) -> object:
    from clearance.case.case_list import cases_in

    (path.parent / "case.yaml").write_bytes(CASE)
    return cases_in(path)


def findings(path: Path) -> object:
    from clearance.findings.findings_file import read_findings

    return read_findings(path)

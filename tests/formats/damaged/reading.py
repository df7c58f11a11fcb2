"""What reads each kind of file: functions of its content, a folder that they may write into, and its name."""

from __future__ import annotations

import contextlib
import io
from collections.abc import Callable
from functools import lru_cache
from pathlib import Path

from clearance.batch.manifest import batch_of
from clearance.case.case_file import load_case
from clearance.case.case_list import cases_in
from clearance.case.driven_robots import Surroundings
from clearance.case.program import program_motion
from clearance.case.robots import RobotReader
from clearance.errors import BadSyntax
from clearance.formats.cloud.formats import cloud_from_bytes
from clearance.formats.files.input_files import InputFiles
from clearance.formats.known_formats import Kind, format_of, function_at
from clearance.formats.mesh.mesh_file import mesh_from_bytes
from clearance.formats.mesh_store import MeshStore
from clearance.formats.motion.requests import Choice, PoseRequest, parse_trajectory, read_samples
from clearance.formats.program.controller_program import ProgramRequest
from clearance.formats.program.conversion import converted
from clearance.formats.robot.request import load_robot
from clearance.formats.robot.urdf.xacro_process import evaluated
from clearance.formats.scene.obstacles import make_obstacles
from clearance.formats.scene.request import SceneRequest, read_scene
from clearance.formats.schema import case as schema
from clearance.formats.schema.obstacle import Scene
from clearance.formats.schema.program import Frame
from clearance.formats.schema.program_file import ProgramFile
from clearance.formats.schema.strict_model import validated
from clearance.formats.schema.timed import TrajectoryFile
from clearance.formats.timed_files import load_trajectory
from clearance.world.placed_robot import PlacedRobot
from tests.formats.damaged import cases
from tests.formats.damaged.texts import BOXES, CASE, CONTROL, LIMITS, PATH, ROBOT, SRDF
from tests.formats.making import cube_stl
from tests.formats.making_urdf import parse_document

Read = Callable[[bytes, Path, str], object]

MESH = {"m.stl": cube_stl()}
CASE_FILES = {"case.yaml": CASE, "arm.urdf": BOXES, "path.csv": PATH, **MESH}
ROBOT_FILES = {
    "arm.urdf": BOXES, "arm.srdf": SRDF, "limits.yaml": LIMITS, "control.yaml": CONTROL, **MESH,
}  # fmt: skip


def by_path(read_path: Callable[[Path], object], **beside: bytes) -> Read:
    """A reader of files on disk, a double underscore in whose names beside it stands for the dot."""
    others = {name.replace("__", "."): content for name, content in beside.items()}
    return among(others, lambda folder, name: read_path(folder / name))


def among(files: dict[str, bytes], read: Callable[[Path, str], object]) -> Read:
    """A reader of a damaged file in a folder that has these files too; it may be one of them."""

    def reads(data: bytes, folder: Path, name: str) -> object:
        path = folder / name
        path.parent.mkdir(exist_ok=True)
        for other, content in files.items():
            if not (folder / other).exists():
                (folder / other).write_bytes(content)
        path.write_bytes(data)
        return read(folder, name)

    return reads


def mesh(data: bytes, folder: Path, name: str) -> object:
    return mesh_from_bytes(data, name).shape.vertices


def points(data: bytes, folder: Path, name: str) -> object:
    return cloud_from_bytes(data, name, 0.01).shape.vertices


def trajectory(data: bytes, folder: Path, name: str) -> object:
    return parse_trajectory(data, name)


def poses(data: bytes, folder: Path, name: str) -> object:
    return read_samples(PoseRequest(lambda: io.BytesIO(data)), name)


def _robot_beside(folder: Path, name: str) -> object:
    entry = schema.RobotEntry("robot", schema.Robot.model_validate(ROBOT), None, "trajectory")
    return RobotReader(MeshStore(InputFiles(folder))).moving(entry, {})


def _scene(folder: Path, name: str) -> object:
    """Its content, then the solids that it names."""
    files = InputFiles(folder)
    content = read_scene(SceneRequest(folder / name, files))
    given = validated(Scene, content.scene, name).obstacles
    return make_obstacles(given, folder, MeshStore(files))


def _program(folder: Path, name: str) -> object:
    """Its moves, then the joints that follow."""
    asked = TrajectoryFile.model_validate({"program": name})
    return program_motion(asked, {}, programmed(), InputFiles(folder), Surroundings())


case = among(CASE_FILES, lambda folder, name: load_case(folder / "case.yaml"))
robot_beside = among(ROBOT_FILES, _robot_beside)
robot = among(MESH, lambda folder, name: load_robot(folder / name))
scene = among(MESH, _scene)
program = among({}, _program)
case_list = by_path(cases_in, case__yaml=CASE)
batch_items = by_path(
    lambda path: batch_of([str(path)]).items, case__yaml=CASE, cell__yaml=CASE, a__csv=CASE
)


def controller(data: bytes, folder: Path, name: str) -> object:
    """A program of a controller as moves of a robot."""
    asked = ProgramFile(file=name, link="tool_tip", base=Frame(on="base"), axes_as="plain")
    row = format_of(Kind.PROGRAM, name, data)
    read = function_at(row.read)(ProgramRequest(data, name, asked))
    return converted(read, asked, programmed().robot, {})


@lru_cache
def programmed() -> PlacedRobot:
    """The arm that programs move."""
    root = Path(__file__).parents[3]
    return PlacedRobot(load_robot(root / "robots" / "heron6" / "heron6.urdf"))


def _bag(path: Path) -> object:
    return load_trajectory(path, Choice())


def _bag_folder(path: Path) -> object:
    """A bag that is a folder, of which the file beside the messages is damaged."""
    messages = path.parent / "run.db3"
    if not messages.exists():
        messages.write_bytes(cases.bag("rosbag2 sqlite3"))
    return _bag(path.parent)


def _xacro(path: Path) -> object:
    """What is evaluated in the process that is started for it, and then read as URDF."""
    with contextlib.redirect_stderr(io.StringIO()):  # its process hands it on as notes
        made = evaluated(path, {})
    if "problem" in made:
        raise BadSyntax(made["problem"], where=path.name)
    parse_document(made["urdf"].encode())
    return None


bag, bag_folder, xacro = by_path(_bag), by_path(_bag_folder), by_path(_xacro)

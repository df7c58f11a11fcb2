"""Every format of files that clearance reads, writes, or knows by sight: one row each.

A further format is a file with its reader and a row here. From the rows follow the reader that a file gets, what
`clearance convert` recognises, the advice about a file that is not what is asked for, the sentences of the JSON
schema and the guide's table. Readers and writers are named by text: nothing is imported before a file of the
format is met. Not for: what stands in the files.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator
from dataclasses import dataclass
from enum import StrEnum
from importlib import import_module
from pathlib import PurePath
from typing import Any

from clearance.errors import BadInput, BadSyntax
from clearance.formats.text import file_start as sniff
from clearance.formats.text.file_start import FileStart, suffix_of

ANY = "*"
"""Among suffixes: a file of any other name is read so too."""

CAD = (".step", ".stp")
"""Suffixes of surfaces that become facets within a tolerance."""

BAGS = (".bag", ".mcap", ".db3")
"""Suffixes of bags, which may be folders too; their reader takes a path."""


class Kind(StrEnum):
    """What a file holds."""

    MESH = "mesh"
    CLOUD = "cloud"
    ROBOT = "robot"
    SCENE = "scene"
    POSES = "poses"
    TRAJECTORY = "trajectory"
    PROGRAM = "program"
    SRDF = "SRDF"
    CASE = "case"


WANTED = {
    Kind.ROBOT: "a URDF file",
    Kind.SCENE: "a scene",
    Kind.POSES: "a table of poses",
    Kind.TRAJECTORY: "a trajectory",
    Kind.PROGRAM: "a robot program",
    Kind.CASE: "a case file",
}
"""What is missed where a file is something else."""


@dataclass(frozen=True)
class Format:
    """A format of files.

    Attributes:
        name: in lists. kind: what its files hold.
        suffixes: in small letters, the usual one first; `ANY` where files of any other name are read so too.
        read, write: the function that does it, as `module:function` below `clearance.formats`; each kind has one
            signature. Empty where files of this format are only known by sight.
        sniff: whether the start of a file shows this format; without it, a suffix does.
        keys: of messages, which only this kind has; the first in a file says what it is.
        extra: of `clearance.extras`, which reading needs.
        read_by: another kind, whose reader says best what is wrong with such a file.
        what: such a file, in messages. hint: what to do with one where something else is wanted; `{name}` is its
            name.
        along: suffixes of files of the same stem that are read along, where they are there.
        points: of meshes: the function that finds all vertices, those that no face uses too, where that is faster.
    """

    name: str
    kind: Kind
    suffixes: tuple[str, ...]
    read: str = ""
    write: str = ""
    sniff: Callable[[FileStart], bool] | None = None
    keys: tuple[str, ...] = ()
    extra: str = ""
    read_by: Kind | None = None
    what: str = ""
    hint: str = ""
    along: tuple[str, ...] = ()
    points: str = ""

    def shows_in(self, start: FileStart) -> bool:
        """True where the start of a file, or its suffix, says that it is of this format."""
        return start.suffix in self.suffixes if self.sniff is None else self.sniff(start)

    @property
    def is_message(self) -> bool:
        """True for messages of ROS, which keep times in whole nanoseconds."""
        return bool(self.keys)

    def takes(self, suffix: str) -> bool:
        """True where a file with this suffix is read as one of this format."""
        return suffix in self.suffixes or ANY in self.suffixes


def _unseen(_: FileStart) -> bool:
    """A format that nothing shows; another row of its files does."""
    return False


_MESH = (
    "name it in a case file: scene: {{obstacles: [{{name: …, mesh: {{file: {name}, scale: 0.001}}}}]}} if in "
    "millimetres, scale: 1 in metres"
)
_CLOUD = "name it in a case file: scene: {{obstacles: [{{name: …, points: {{file: {name}, radius: …}}}}]}}"
_PROGRAM = "name it in a case file: trajectory: {{program: {name}}}, beside robot and scene"
_MOTION = "name it in a case file: trajectory: {name}, beside robot and scene"
_IS_MJCF = sniff.has_root("mujoco", "mujocoinclude")
_MJCF = (
    "call it .xml and name it in a case file: robot: {{urdf: {name}}} for a robot, scene: {name} for what stands "
    "around one"
)
_MOTION_KEYS = (
    *("joint_names", "points", "joint_trajectory", "model_id", "trajectory_start"),
    *("multi_dof_joint_trajectory", "planned_trajectory"),
)
_SCENE_KEYS = (
    *("world", "robot_state", "allowed_collision_matrix", "collision_objects"),
    *("fixed_frame_transforms", "robot_model_name"),
)


def _mesh(name: str, suffixes: tuple[str, ...], read: str, **more: Any) -> Format:
    return Format(name, Kind.MESH, suffixes, f"mesh.{read}", what="a mesh", hint=_MESH, **more)


def _cloud(name: str, suffixes: tuple[str, ...], read: str, **more: Any) -> Format:
    return Format(name, Kind.CLOUD, suffixes, f"cloud.{read}", what="a scan", hint=_CLOUD, **more)


def _messages(name: str, kind: Kind, read: str, write: str, **more: Any) -> Iterator[Format]:
    """Messages of ROS, in JSON and in YAML, which `{}` stands for."""
    for language, suffixes in (("JSON", (".json",)), ("YAML", (".yaml", ".yml"))):
        reads, writes = (f"motion.{one.format(language.lower())}" for one in (read, write))
        yield Format(f"{name} in {language}", kind, suffixes, reads, writes, **more)


def _program(name: str, suffixes: tuple[str, ...], read: str, **more: Any) -> Format:
    """A program in the language of a controller."""
    what = f"a program in {name}"
    return Format(name, Kind.PROGRAM, suffixes, f"program.{read}", what=what, hint=_PROGRAM, **more)


FORMATS = (
    _mesh("STL", (".stl",), "stl_file:read_stl"),
    _mesh("OBJ", (".obj",), "obj_file:read_obj", points="mesh.obj_file:vertices_of_obj"),
    _mesh("COLLADA", (".dae",), "collada_file:read_collada",
          sniff=lambda start: start.root == "COLLADA" or start.suffix == ".dae"),
    _mesh("PLY", (".ply",), "ply_file:read_ply"),
    _mesh("OFF", (".off",), "off_file:read_off"),
    _mesh("GLB", (".glb",), "gltf_file:read_glb"),
    _mesh("STEP", CAD, "step_file:read_step", extra="cad"),
    _mesh("octomap", (".bt", ".ot"), "octree_file:read_octree"),
    Format("glTF", Kind.MESH, (".gltf",), what="a mesh", hint="export it as .glb, one binary file"),
    _cloud("PCD", (".pcd",), "pcd_file:read_pcd"),
    _cloud("points of a PLY", (".ply",), "formats:read_ply_points", sniff=_unseen),
    _cloud("points as text", (".csv", ".xyz", ".txt", ".asc"), "points_text:read_points_text", sniff=_unseen),
    Format("URDF", Kind.ROBOT, (".urdf", ".xml", ANY), "robot.urdf.robot:read_urdf", sniff=sniff.is_urdf,
           what="a URDF robot", hint="name it in a case file: robot: {{urdf: {name}}}, beside scene and "
           "trajectory; or let `clearance new` write one"),
    Format("xacro", Kind.ROBOT, (".xacro", ANY), "robot.urdf.robot:read_urdf", sniff=sniff.is_xacro, extra="ros",
           what="a xacro robot", hint="name it in a case file: robot: {{urdf: {name}, xacro: true}}, which "
           "evaluates the Python in it"),
    Format("MJCF robot", Kind.ROBOT, (".mjcf", ".xml"), "robot.mjcf.robot:read_mjcf", sniff=_IS_MJCF,
           extra="mujoco", what="a MuJoCo model", hint=_MJCF),
    Format("SRDF", Kind.SRDF, (".srdf",), sniff=sniff.is_srdf, what="a MoveIt SRDF",
           hint="name it in a case file: robot: {{srdf: {name}, self_clearance: true}}, beside urdf"),
    Format("SDF", Kind.SCENE, (".sdf", ".world"), "scene.sdf.scene:read_sdf", sniff=sniff.has_root("sdf"),
           what="an SDF world or model", hint="name it, as .sdf, in a case file: scene: {name}, beside "
           "robot (as URDF) and trajectory"),
    Format("MJCF", Kind.SCENE, (".mjcf", ".xml"), "scene.mjcf:read_mjcf_scene", sniff=_IS_MJCF,
           extra="mujoco", what="a MuJoCo model", hint=_MJCF),
    Format("MoveIt .scene", Kind.SCENE, (".scene",), "scene.moveit.scene_file:read_moveit_scene",
           sniff=sniff.is_moveit_scene, what="a MoveIt scene",
           hint="call it .scene and name it in a case file: scene: {name}, beside robot and trajectory"),
    Format("CSV poses", Kind.POSES, (".csv", ANY), "motion.tables:read_csv_poses",
           "motion.pose_writer:csv_text", sniff.is_pose_table, read_by=Kind.TRAJECTORY, what="a table of poses",
           hint="name it in a case file: moves: {name}, beside an obstacle's shape"),
    Format("CSV", Kind.TRAJECTORY, (".csv", ANY), "motion.tables:read_csv",
           "motion.trajectory_writer:csv_text", lambda start: start.suffix == ".csv" and not start.is_xml,
           read_by=Kind.POSES, what="a table", hint=_MOTION),
    *_messages("JointTrajectory", Kind.TRAJECTORY, "joint_points:read_{}_trajectory", "trajectory_writer:{}_text",
               sniff=sniff.has_keys(b"joint_names", b"points"), keys=_MOTION_KEYS, what="a ROS JointTrajectory",
               hint="name it in a case file: trajectory: path.yaml, beside robot and scene; a file of it ends in "
               ".yaml or .json"),
    Format("ROS bag", Kind.TRAJECTORY, BAGS, "motion.rosbag_file:read_bag", extra="ros", what="a ROS bag",
           hint=_MOTION),
    *_messages("stamped poses", Kind.POSES, "pose_messages:read_{}_poses", "pose_writer:{}_text", sniff=_unseen,
               keys=("pose", "poses", "transform", "transforms", "child_frame_id")),
    Format("MoveIt PlanningScene", Kind.SCENE, (".yaml", ".yml", ANY), "scene.scene_yaml:read_scene_yaml",
           sniff=sniff.has_keys(b"collision_objects"), keys=_SCENE_KEYS, what="a MoveIt planning scene",
           hint="name it in a case file: scene: {name}, beside robot and trajectory"),
    Format("YAML", Kind.SCENE, (".yaml", ".yml", ANY), "scene.scene_yaml:read_scene_yaml",
           "conversion:converted_scene", _unseen, ("obstacles",)),
    Format("robot program", Kind.PROGRAM, (".yaml", ".yml"), "program.program_yaml:read_yaml_program",
           sniff=sniff.has_keys(b"tool", b"moves"), what="a robot program", hint=_PROGRAM),
    _program("URScript", (".script", ".urscript"), "urscript:read_urscript"),
    _program("RAPID", (".mod", ".prg", ".sys", ".modx"), "rapid:read_rapid"),
    _program("KRL", (".src",), "krl:read_krl", along=(".dat", ".DAT")),
    _program("FANUC TP", (".ls",), "fanuc:read_fanuc"),
    Format("case file", Kind.CASE, (".yaml", ANY), sniff=sniff.is_case, what="a case file",
           hint="`clearance check {name}` checks it; what is asked for is one of the files that it names"),
)  # fmt: skip


def rows_of(kind: Kind) -> list[Format]:
    """The formats of one kind that are read."""
    return [one for one in FORMATS if one.kind is kind and one.read]


def names_of(kind: Kind) -> str:
    """The names of the formats of one kind that are read, in a sentence."""
    *most, last = [one.name for one in rows_of(kind)]
    return f"{', '.join(most)} or {last}"


def suffixes_read(kind: Kind) -> tuple[str, ...]:
    """The suffixes of the files of one kind that are read."""
    return _once(suffix for one in rows_of(kind) for suffix in one.suffixes)


def suffixes_written(kind: Kind) -> tuple[str, ...]:
    """The suffixes of the files of one kind that are written."""
    return _once(suffix for one in rows_of(kind) if one.write for suffix in one.suffixes)


def _once(suffixes: Iterator[str]) -> tuple[str, ...]:
    return tuple(dict.fromkeys(suffix for suffix in suffixes if suffix != ANY))


def format_of(kind: Kind, shown: str, data: bytes = b"") -> Format | None:
    """The format that a file of one kind is read as: by its suffix, and by its content where two share that.

    Args:
        shown: the file's name. data: its content.
    """
    suffix = suffix_of(shown)
    rows = rows_of(kind)
    own = [one for one in rows if suffix in one.suffixes] or [
        one for one in rows if ANY in one.suffixes
    ]
    start = FileStart.of(data, shown)
    return next((one for one in own if one.shows_in(start)), own[0] if own else None)


def written_as(kind: Kind, shown: str) -> Format:
    """The format that a file of one kind is written in, by its suffix.

    Raises:
        BadInput: no such format.
    """
    for one in rows_of(kind):
        if one.write and suffix_of(shown) in one.suffixes:
            return one
    raise BadInput(
        f"{shown!r} has no suffix to write for {WANTED[kind]}",
        valid=f"one of {', '.join(suffixes_written(kind))}",
    )


def function_at(place: str) -> Callable[..., Any]:
    """The reader or writer that a row names; its module is imported here."""
    module, _, name = place.partition(":")
    found: Callable[..., Any] = getattr(import_module(f"clearance.formats.{module}"), name)
    return found


def formats_in(data: bytes, shown: str) -> list[Format]:
    """The formats that a file's name or its first lines show."""
    start = FileStart.of(data, shown)
    return [one for one in FORMATS if one.shows_in(start)]


def refuse_foreign(data: bytes, shown: str, kind: Kind) -> None:
    """Nothing, if a file is not known to be something else than one of this kind.

    Raises:
        BadSyntax: what it is, and what to do with it.
    """
    known = formats_in(data, shown)
    fits = any(
        one.read_by is kind or (one.kind is kind and one.takes(suffix_of(shown))) for one in known
    )
    if known and not fits:
        raise foreign(known[0], shown, WANTED[kind])


def foreign(known: Format, shown: str, wanted: str) -> BadSyntax:
    """The error for a file of a known format that is not what is wanted."""
    valid = known.hint.format(name=PurePath(shown).name)
    return BadSyntax(f"this is {known.what}, not {wanted}", where=shown, valid=valid)

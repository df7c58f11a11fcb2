"""Files of this field that are not what is asked for, known by their content: one line says what to do with each.

Not for: reading them.
"""

from __future__ import annotations

import re
from pathlib import PurePath

from clearance.errors import BadSyntax

_ADVICE = {
    "urdf": (
        "a URDF robot",
        "name it in a case file: robot: {{urdf: {name}}}, beside scene and trajectory; or let "
        "`clearance new` write one",
    ),
    "xacro": (
        "a xacro robot",
        "name it in a case file: robot: {{urdf: {name}, xacro: true}}, which evaluates the Python in it",
    ),
    "srdf": (
        "a MoveIt SRDF",
        "name it in a case file: robot: {{srdf: {name}, self_clearance: true}}, beside urdf",
    ),
    "sdf": (
        "an SDF world or model",
        "call it .sdf and name it in a case file: scene: {name}, beside robot (as URDF) and trajectory",
    ),
    "mjcf": (
        "a MuJoCo model",
        "call it .xml and name it in a case file: robot: {{urdf: {name}}} for a robot, scene: {name} for what "
        "stands around one",
    ),
    "scene": (
        "a MoveIt scene",
        "call it .scene and name it in a case file: scene: {name}, beside robot and trajectory",
    ),
    "joint trajectory": (
        "a ROS JointTrajectory",
        "name it in a case file: trajectory: path.yaml, beside robot and scene; a file of it ends in .yaml "
        "or .json",
    ),
    "planning scene": (
        "a MoveIt planning scene",
        "name it in a case file: scene: {name}, beside robot and trajectory",
    ),
    "case": (
        "a case file",
        "`clearance check {name}` checks it; what is asked for is one of the files that it names",
    ),
    "mesh": (
        "a mesh",
        "name it in a case file: scene: {{obstacles: [{{name: …, mesh: {{file: {name}, scale: 1}}}}]}}",
    ),
    "csv": ("a table", "name it in a case file: trajectory: {name}, beside robot and scene"),
}
"""What a file is, and what to do; `clearance schema` and the README show a whole case file."""

_LEFT = {
    "case": ("a case file",),
    "urdf": ("a URDF file",),
    "planning scene": ("a scene",),
    "xacro": ("a URDF file",),
    "csv": ("a URDF file", "a trajectory", "a table of poses"),
}
"""What may be wanted where a file is of a kind, or is better answered by who reads it."""

_MESSAGES = {".yaml", ".yml", ".json"}
"""What is read as a trajectory of messages."""

_MESHES = {
    *(".stl", ".obj", ".dae", ".ply", ".off", ".glb", ".gltf", ".step", ".stp", ".bt", ".ot"),
}

_ROOT = re.compile(rb"\s*<(?:\w+:)?([A-Za-z_][\w.-]*)[\s/>]")

_BEFORE_ROOT = ((b"<?", b"?>"), (b"<!--", b"-->"), (b"<!", b">"))
"""How what may stand before the root element begins and ends."""


def refuse_foreign(data: bytes, shown: str, wanted: str) -> None:
    """Nothing, if the file is not known to be something else than what is wanted.

    Args:
        wanted: "a case file", "a scene", "a trajectory", "a table of poses", "a URDF file", or what else there is.

    Raises:
        BadSyntax: what it is, and what to do with it.
    """
    name = PurePath(shown).name
    kind = known_kind(data, shown)
    if kind is None or wanted in _LEFT.get(kind, ()):
        return
    if (kind, wanted) == ("joint trajectory", "a trajectory") and _suffix(name) in _MESSAGES:
        return
    what, remedy = _ADVICE[kind]
    raise BadSyntax(f"this is {what}, not {wanted}", where=shown, valid=remedy.format(name=name))


def is_mjcf(data: bytes) -> bool:
    """True for a file whose root element is that of MuJoCo's models."""
    start = data[:65536].removeprefix(b"\xef\xbb\xbf").lstrip()
    return start.startswith(b"<") and _xml_kind(start) == "mjcf"


def _suffix(name: str) -> str:
    return PurePath(name).suffix.lower()


def known_kind(data: bytes, shown: str) -> str | None:
    """What a file is, one of the keys of `_ADVICE`, if its name or its first lines say so."""
    suffix = _suffix(shown)
    if suffix in _MESHES:
        return "mesh"
    start = data[:65536].removeprefix(b"\xef\xbb\xbf").lstrip()
    if start.startswith(b"<"):
        return _xml_kind(start)
    if suffix == ".csv":
        return "csv"
    if suffix == ".scene" or re.match(rb"[^\n:{]*\n\* \S", start):
        return "scene"
    keys = set(re.findall(rb"^[ \t{-]*\"?([a-z_]+)\"?:", start, re.MULTILINE))
    if {b"joint_names", b"points"} <= keys:
        return "joint trajectory"
    if b"collision_objects" in keys:
        return "planning scene"
    return "case" if _is_case(start) else None


def _is_case(start: bytes) -> bool:
    """True for keys that only a case file has beside each other, in the first column."""
    keys = set(re.findall(rb"^\"?([a-z]+)\"?:", start.removeprefix(b"{"), re.MULTILINE))
    return not keys.isdisjoint((b"robot", b"robots")) and not keys.isdisjoint(
        (b"scene", b"trajectory", b"limits")
    )


def _xml_kind(start: bytes) -> str | None:
    root = _ROOT.match(start, _root_begins(start))
    tag = root[1].decode() if root else ""
    if tag != "robot":
        return {"sdf": "sdf", "mujoco": "mjcf", "mujocoinclude": "mjcf", "COLLADA": "mesh"}.get(tag)
    if b"<xacro:" in start:
        return "xacro"
    groups = re.search(rb"<(disable_collisions|group|virtual_joint|end_effector)\b", start)
    parts = re.search(rb"<(parent|visual|collision|inertial)\b", start)
    return "srdf" if groups and not parts else "urdf"


def _root_begins(start: bytes) -> int:
    """Where the root element begins, behind declarations and comments; at the end if they do not end."""
    at = 0
    while True:
        while at < len(start) and start[at : at + 1].isspace():
            at += 1
        ends = next((end for begin, end in _BEFORE_ROOT if start.startswith(begin, at)), None)
        if ends is None:
            return at
        found = start.find(ends, at)
        if found < 0:
            return len(start)
        at = found + len(ends)

"""What a file to convert holds, by its suffix and its first lines: a trajectory, a scene or poses.

Not for: reading it, which may find otherwise (`files`).
"""

from __future__ import annotations

import re
from enum import StrEnum
from pathlib import Path

from clearance.errors import BadInput, BadShape
from clearance.formats.files.foreign_files import known_kind, refuse_foreign
from clearance.formats.files.input_files import InputFiles
from clearance.formats.motion.bag_files import is_bag
from clearance.formats.motion.pose_table_file import COLUMNS

HEAD = 65536
"""[bytes] Looked at."""


class FileKind(StrEnum):
    """What can be converted."""

    TRAJECTORY = "trajectory"
    SCENE = "scene"
    POSES = "poses"


_SCENES = {"sdf", "mjcf", "scene", "planning scene"}
"""Kinds of `foreign_files` that are scenes."""

_SAYS = {
    **dict.fromkeys(
        ("obstacles", "world", "robot_state", "allowed_collision_matrix", "collision_objects"),
        FileKind.SCENE,
    ),
    **dict.fromkeys(("fixed_frame_transforms", "robot_model_name"), FileKind.SCENE),
    **dict.fromkeys(
        ("joint_names", "points", "joint_trajectory", "model_id", "trajectory_start"),
        FileKind.TRAJECTORY,
    ),
    **dict.fromkeys(("multi_dof_joint_trajectory", "planned_trajectory"), FileKind.TRAJECTORY),
    **dict.fromkeys(("pose", "poses", "transform", "transforms", "child_frame_id"), FileKind.POSES),
}
"""Keys of messages and of our scenes; the first of them in a file says what it is."""

_DOCUMENTS = {".yaml", ".yml", ".json"}

_KEY = re.compile(rb"""(?:^|[{,])[ \t-]*(["']?)([A-Za-z_]+)\1[ \t]*:""", re.MULTILINE)
_COMMENT = re.compile(rb"(?:^|(?<=\s))#[^\n]*")
_QUOTED = re.compile(rb"""("(?:[^"\\\n]|\\.)*"|'[^'\n]*')([ \t]*:)?""")
"""Text in quotes, which may say anything where it is no key."""

_WANTED = "a trajectory, a scene or poses"


def kind_of(path: Path, files: InputFiles) -> FileKind:
    """What a file holds.

    Raises:
        MissingFile: it is not there. BadSyntax: another kind of file, and what to do with it. BadShape: it is
        empty. BadInput: nothing says what it is.
    """
    if is_bag(path):
        return FileKind.TRAJECTORY
    shown = files.shown(path)
    head = _head(path, files)
    if not head.removeprefix(b"\xef\xbb\xbf").strip():
        raise BadShape("the file is empty", where=shown, valid=_WANTED)
    known = known_kind(head, shown)
    if known in _SCENES:
        return FileKind.SCENE
    if known == "joint trajectory":
        return FileKind.TRAJECTORY
    if known is not None and known != "csv":
        refuse_foreign(head, shown, _WANTED)
    found = _of_keys(head) if path.suffix.lower() in _DOCUMENTS else _of_header(head)
    if found is None:
        raise BadInput(
            "it cannot be told what this file holds",
            where=shown,
            valid=f"--kind says it: {', '.join(FileKind)}",
        )
    return found


def _head(path: Path, files: InputFiles) -> bytes:
    opened, _ = files.unread(path)
    with opened() as file:
        return file.read(HEAD)


def _of_keys(head: bytes) -> FileKind | None:
    """By the first key that only one of them has; nested ones count, since messages hold messages."""
    keys = _QUOTED.sub(lambda text: text[0] if text[2] else b"", _COMMENT.sub(b"", head))
    for found in _KEY.finditer(keys):
        kind = _SAYS.get(found[2].decode())
        if kind is not None:
            return kind
    return None


def _of_header(head: bytes) -> FileKind:
    """Poses for a table whose header has all columns of such a table, in whatever units and order."""
    words = set(re.split(rb"[^a-z]+", head.split(b"\n", 1)[0].lower()))
    is_poses = {name.encode() for name in COLUMNS} <= words
    return FileKind.POSES if is_poses else FileKind.TRAJECTORY

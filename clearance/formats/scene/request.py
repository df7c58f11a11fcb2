"""What is asked of a reader of scene files, and what it gives: rows as a YAML scene has them; and a file to a
scene by the reader of its format.

Not for: making solids of it (`obstacles`).
"""

from __future__ import annotations

import os
from collections.abc import Mapping
from dataclasses import dataclass, field, replace
from pathlib import Path
from typing import NamedTuple

import numpy as np

from clearance.errors import BadScene
from clearance.formats.files.input_files import InputFiles, resolved
from clearance.formats.known_formats import Kind, format_of, function_at
from clearance.formats.schema.obstacle import Scene
from clearance.formats.schema.strict_model import validated
from clearance.geometry.quaternions import quaternions_of
from clearance.world.notice import Notice, Severity

ANY = "*"
"""In a pair that may touch: every body, but for those of `SceneContent.not_by_default`."""

SKIP = "skip"
"""In place of an included model: nothing."""


@dataclass(frozen=True)
class SceneRequest:
    """Which scene, and where to look for what it names.

    Attributes:
        path: the scene's file. package_dirs: where `model://` and `package://` are looked up first.
        files: reads the file, and all that it names.
        includes: by URI of a model that an SDF file includes: `SKIP`, or the path or URI of one to take for it.
    """

    path: Path
    files: InputFiles
    package_dirs: tuple[Path, ...] = ()
    includes: Mapping[str, str] = field(default_factory=dict)

    @property
    def shown(self) -> str:
        """The file's name in messages."""
        return self.files.shown(self.path)


def includes_of(given: Mapping[str, str], folder: Path) -> dict[str, str]:
    """The same for a `SceneRequest`: paths as seen from a folder are whole; what is no text is left out."""
    return {
        uri: model if model == SKIP or "://" in model else os.path.abspath(resolved(model, folder))
        for uri, model in given.items()
        if isinstance(uri, str) and isinstance(model, str)
    }


class AttachedPart(NamedTuple):
    """An obstacle that a link holds, and the links and objects that it may touch meanwhile."""

    part: str
    link: str
    touch: tuple[str, ...] = ()


@dataclass(frozen=True)
class SceneContent:
    """A scene as a case file would have it.

    Attributes:
        scene: what stands under `scene:`, files relative to the folder of the scene's file.
        notes: what was left out or decided, one line each. notices: what bears on the verdict.
        allow: names of bodies that may touch, in any order, of which some may not be there; `ANY` is the second.
        not_by_default: names that no pair with `ANY` is of.
        link_padding: [m] by link. attached: obstacles that links carry.
        frame: what its poses are given in, if its file says so; it is taken for the world.
        bases: (4, 4) [m] where its file says that a robot stands, by the joint that moves it. joints: [rad or m]
            where it has the other joints.
    """

    scene: object
    notes: tuple[str, ...] = ()
    notices: tuple[Notice, ...] = ()
    allow: tuple[tuple[str, str], ...] = ()
    not_by_default: tuple[str, ...] = ()
    link_padding: dict[str, float] = field(default_factory=dict)
    attached: tuple[AttachedPart, ...] = ()
    frame: str = ""
    bases: dict[str, np.ndarray] = field(default_factory=dict)
    joints: dict[str, float] = field(default_factory=dict)


def mesh_row(file: str, scale: list[float]) -> dict[str, dict]:
    """The row of a mesh file that Gazebo or MoveIt places: COLLADA and GLB lie as they are, not turned to z up."""
    axis = {"collada_up_axis": "ros"} if file.lower().endswith((".dae", ".glb")) else {}
    return {"mesh": {"file": file, "scale": scale} | axis}


def pose_row(pose: np.ndarray) -> dict[str, list[float]]:
    """The row of a (4, 4) pose [m]; without a rotation where there is none.

    Exactness: the place is the same; the rotation read back is off by a few roundings.
    """
    row = {"xyz": pose[:3, 3].tolist()}
    if not np.array_equal(pose[:3, :3], np.eye(3)):
        row["quat_xyzw"] = quaternions_of(pose[None, :3, :3])[0].tolist()
    return row


def read_scene(asked: SceneRequest) -> SceneContent:
    """The scene in a file; one of a format that is not known is read as YAML.

    Raises:
        BadInput: as the reader says, with the place in the file.
    """
    known = format_of(Kind.SCENE, asked.path.name)
    assert known is not None  # as any file is YAML where nothing says otherwise
    if asked.includes and known.name != "SDF":
        raise BadScene(
            f"includes are given, and {asked.shown} is no SDF file", valid="no includes in the case"
        )
    content: SceneContent = function_at(known.read)(asked)
    return with_own_words(content, validated(Scene, content.scene, asked.shown))


def with_own_words(content: SceneContent, scene: Scene) -> SceneContent:
    """The content with the frame and the warnings that stand in the scene itself."""
    notices = tuple(Notice(Severity.WARNING, "scene", text) for text in scene.warnings)
    return replace(
        content, notices=(*content.notices, *notices), frame=scene.frame or content.frame
    )

"""A scene file to a scene, by the reader of its suffix: a further format is a file, a function and a row here.

Not for: making solids of it (`obstacles`).
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace

from clearance.errors import BadInput
from clearance.formats.scene.request import SceneContent, SceneRequest
from clearance.formats.scene.scene_yaml import read_scene_yaml
from clearance.formats.schema.errors import validated
from clearance.formats.schema.obstacle import Scene
from clearance.world.notice import Notice, Severity


def _sdf(asked: SceneRequest) -> SceneContent:
    from clearance.formats.scene.sdf.scene import read_sdf

    return read_sdf(asked)


def _mjcf(asked: SceneRequest) -> SceneContent:
    from clearance.formats.scene.mjcf import read_mjcf_scene

    return read_mjcf_scene(asked)


def _moveit(asked: SceneRequest) -> SceneContent:
    from clearance.formats.scene.moveit.scene_file import read_moveit_scene

    return read_moveit_scene(asked)


READERS: dict[str, Callable[[SceneRequest], SceneContent]] = {
    ".yaml": read_scene_yaml,
    ".sdf": _sdf,
    ".world": _sdf,
    ".mjcf": _mjcf,
    ".xml": _mjcf,
    ".scene": _moveit,
}
"""By suffix in small letters; a file of another suffix is read as YAML."""


def read_scene(asked: SceneRequest) -> SceneContent:
    """The scene in a file.

    Raises:
        BadInput: as the reader says, with the place in the file.
    """
    reader = READERS.get(asked.path.suffix.lower(), read_scene_yaml)
    if asked.includes and reader is not _sdf:
        raise BadInput(
            f"includes are given, and {asked.shown} is no SDF file", valid="no includes in the case"
        )
    content = reader(asked)
    return with_own_words(content, validated(Scene, content.scene, asked.shown))


def with_own_words(content: SceneContent, scene: Scene) -> SceneContent:
    """The content with the frame and the warnings that stand in the scene itself."""
    notices = tuple(Notice(Severity.WARNING, "scene", text) for text in scene.warnings)
    return replace(
        content, notices=(*content.notices, *notices), frame=scene.frame or content.frame
    )

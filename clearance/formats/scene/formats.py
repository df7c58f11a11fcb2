"""A scene file to a scene, by the reader of its format.

Not for: making solids of it (`obstacles`).
"""

from __future__ import annotations

from dataclasses import replace

from clearance.errors import BadScene
from clearance.formats.known_formats import Kind, format_of, function_at
from clearance.formats.scene.request import SceneContent, SceneRequest
from clearance.formats.schema.obstacle import Scene
from clearance.formats.schema.strict_model import validated
from clearance.world.notice import Notice, Severity


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

"""A scene in YAML, as under `scene:` in a case file, or as MoveIt's PlanningScene. Not for: its keys."""

from __future__ import annotations

from clearance.formats.known_formats import Kind, refuse_foreign
from clearance.formats.scene.moveit.planning_scene import is_planning_scene, planning_scene
from clearance.formats.scene.request import SceneContent, SceneRequest
from clearance.plain_yaml import parse_yaml


def read_scene_yaml(asked: SceneRequest) -> SceneContent:
    """The scene in a YAML file.

    Raises:
        BadSyntax: another kind of file, or not YAML, with the place in the file.
    """
    data = asked.files.read(asked.path)
    refuse_foreign(data, asked.shown, Kind.SCENE)
    raw = parse_yaml(data, asked.shown)
    if isinstance(raw, dict) and is_planning_scene(raw):
        return planning_scene(raw, asked)
    return SceneContent(raw)

"""Scenes in YAML: read as under `scene:` in a case file, or as MoveIt's PlanningScene; and a scene that was read,
from whatever format, to our YAML and the meshes that were written out in its file.

Every number stands as the reader gave it, so that what is read back is the same scene. Not for: its keys, nor what
its file says of robots, which a case holds (`new_case.text`) or a conversion tells (`conversion`).
"""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from pathlib import Path
from typing import Any, NamedTuple

from clearance.errors import shown
from clearance.formats.files.brought import is_brought
from clearance.formats.files.input_files import path_from
from clearance.formats.known_formats import Kind, refuse_foreign
from clearance.formats.scene.moveit.planning_scene import is_planning_scene, planning_scene
from clearance.formats.scene.request import SceneContent, SceneRequest
from clearance.formats.text.yaml_text import flow
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


class WrittenScene(NamedTuple):
    """The content of a scene file, and of the mesh files that lie beside it, by name."""

    content: bytes
    meshes: Mapping[str, bytes]


def written_scene(
    content: SceneContent,
    asked: SceneRequest,
    folder: Path,
    made_by: str,
    remarks: Sequence[str] = (),
) -> WrittenScene:
    """The files of a scene in `folder`, which need not be there.

    Args:
        asked: what `content` was read from. made_by: the command, for the first line. remarks: comments after it.
    """
    paths = _Paths(asked, folder)
    lines = [*_head(content, asked.shown, made_by, remarks), *_obstacles(content, paths)]
    return WrittenScene("\n".join([*lines, ""]).encode(), paths.contents)


def rows_of(content: SceneContent) -> list[dict[str, Any]]:
    """The obstacles of a scene that its reader has checked."""
    assert isinstance(content.scene, dict)
    return content.scene["obstacles"]


def _head(content: SceneContent, given: str, made_by: str, remarks: Sequence[str]) -> Iterator[str]:
    yield f"# Made by `{made_by}` from {shown(given)}; yours to edit. Metres and radians."
    yield from (f"# {shown(line)}" for line in (*content.notes, *remarks))
    if content.frame:
        yield f"frame: {flow(content.frame)}  # of the poses; taken for the world"
    if content.notices:
        yield "warnings:  # each check repeats them until they are removed here"
        yield from (f"- {flow(shown(notice.text))}" for notice in content.notices)


def _obstacles(content: SceneContent, paths: _Paths) -> Iterator[str]:
    rows = rows_of(content)
    yield "obstacles:" if rows else "obstacles: []"
    yield from (f"- {flow(_moved(row, paths))}" for row in rows)


class _Paths:
    """Turns paths as seen from the scene's file into those from a folder; meshes not on disk get a file there."""

    def __init__(self, asked: SceneRequest, folder: Path) -> None:
        self._asked, self._folder = asked, folder
        self.contents: dict[str, bytes] = {}

    def written(self, given: str) -> str:
        """How a path is written in the folder."""
        if is_brought(given):
            return given
        path, files = self._asked.path.parent / given, self._asked.files
        if not files.is_in_memory(path):
            return path_from(self._folder, path)
        self.contents[path.name] = files.read(path)
        return path.name


def _moved(row: Mapping[str, Any], paths: _Paths) -> dict[str, Any]:
    """An obstacle with paths as they are to be written."""
    moved = dict(row)
    for key in {"mesh", "points", "moves"} & set(row):
        given = row[key]
        if isinstance(given, str):
            moved[key] = paths.written(given)
        else:
            moved[key] = {**given, "file": paths.written(given["file"])}
    return moved

"""A case file, and the scene file that it names, to the schema's `Case`. Not for: other files (`case_file`)."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from dataclasses import dataclass, replace
from pathlib import Path

from clearance.errors import BadPack, Contradiction, at
from clearance.formats.files.input_files import InputFiles
from clearance.formats.known_formats import Kind, refuse_foreign
from clearance.formats.scene.request import (
    SceneContent,
    SceneRequest,
    includes_of,
    read_scene,
    with_own_words,
)
from clearance.formats.schema import case as schema
from clearance.formats.schema.strict_model import validated
from clearance.plain_yaml import parse_yaml

_NOTHING = SceneContent(None)
"""Of a scene that is in the case file itself."""


@dataclass(frozen=True)
class ScenePlace:
    """Where the obstacles are written: file and field for errors, folder for the files that they name; the
    field as seen from the case file; and what their file says beside them.
    """

    place: str
    folder: Path
    field: str = "scene."
    content: SceneContent = _NOTHING


def read_schema(
    path: Path, files: InputFiles, model: type[schema.Case] = schema.Case
) -> tuple[schema.Case, ScenePlace]:
    """The checked content of a case file, its scene's file in place of that file's name.

    Args:
        model: what it must be.

    Raises:
        BadInput: with the file and the field.
    """
    data = files.read(path)
    if data.startswith(b"PK\3\4"):
        valid = "clearance check takes what clearance pack wrote; for all else unzip it"
        raise BadPack("a zip is given", where=path.name, valid=valid)
    refuse_foreign(data, path.name, Kind.CASE)
    raw = parse_yaml(data, path.name)
    scene_at = ScenePlace(f"{path.name}: scene", path.parent)
    if isinstance(raw, dict) and isinstance(raw.get("scene"), str):
        scene_at = _scene_of(raw, path, files)
        raw = {**raw, "scene": scene_at.content.scene}
        return validated(model, raw, path.name), scene_at
    case = validated(model, raw, path.name)
    if case.includes:
        raise Contradiction(
            "the scene stands in the case itself, and includes nothing",
            where=f"{path.name}: includes",
            valid="includes of a scene in an SDF file",
        )
    return case, replace(scene_at, content=with_own_words(scene_at.content, case.scene))


def _scene_of(raw: dict[str, object], path: Path, files: InputFiles) -> ScenePlace:
    with at(f"{path.name}: scene"):
        asked = scene_request(raw, files)
        content = read_scene(asked)
    return ScenePlace(
        f"{path.name}: scene: {asked.shown}",
        asked.path.parent,
        f"scene: {asked.shown}: ",
        content,
    )


def scene_request(raw: Mapping[str, object], files: InputFiles) -> SceneRequest:
    """What is asked of the reader of the scene that a case names; the case is not checked yet."""
    package_dirs = tuple(map(files.resolved, _package_dirs(raw)))
    includes = raw.get("includes")
    said = includes_of(includes, files.folder) if isinstance(includes, dict) else {}
    return SceneRequest(files.resolved(str(raw["scene"])), files, package_dirs, said)


def _package_dirs(raw: Mapping[str, object]) -> Iterator[str]:
    """The package folders of all robots in a case that is not checked yet, each once."""
    robots = [raw.get("robot"), *_list(raw.get("robots"))]
    given = [_list(robot.get("package_dirs")) for robot in robots if isinstance(robot, dict)]
    yield from dict.fromkeys(text for texts in given for text in texts if isinstance(text, str))


def _list(given: object) -> list[object]:
    return given if isinstance(given, list) else []

"""The scene of a new case: our YAML of what a scene file holds, or that file where our YAML would say less.

Not for: reading it (`scene.request`), nor the text of it (`scene.scene_yaml`).
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any

from clearance.case.new_case.robot import NewCaseRequest
from clearance.case.scene_rows import with_attached_parts, with_scene_rows
from clearance.formats.files.input_files import path_from, resolved
from clearance.formats.mesh_store import MeshStore
from clearance.formats.scene.obstacles import make_obstacles
from clearance.formats.scene.request import (
    SKIP,
    SceneContent,
    SceneRequest,
    includes_of,
    read_scene,
)
from clearance.formats.scene.scene_yaml import written_scene
from clearance.formats.schema.obstacle import Scene
from clearance.formats.schema.strict_model import validated
from clearance.formats.text.notes import counted
from clearance.world.carry import Carry
from clearance.world.case import Case
from clearance.world.placed_robot import PlacedRobot

SCENE = "scene.yaml"


@dataclass(frozen=True)
class NewScene:
    """What a new case says of its scene.

    Attributes:
        name: the scene's file; None where nothing stands around the robot. remark: beside it.
        contents: of the files to write, by name.
        carry, allow, padding: what its file says of links. taken, notes: a line each. includes: as in a case.
    """

    name: str | None
    remark: str
    contents: Mapping[str, bytes] = field(default_factory=dict)
    carry: Sequence[Mapping[str, Any]] = ()
    allow: Sequence[tuple[str, str]] = ()
    padding: Mapping[str, float] = field(default_factory=dict)
    taken: Sequence[str] = ()
    notes: Sequence[str] = ()
    includes: Mapping[str, str] = field(default_factory=dict)


def new_scene(
    given: NewCaseRequest,
    placed: PlacedRobot,
    meshes: MeshStore,
    folder: Path,
) -> NewScene:
    """The scene in a file, as a case in `folder` is to name it.

    A file whose reader warns of something is named as it is, so that each check warns of it too.

    Raises:
        BadInput: as its reader says.
    """
    if given.scene is None:
        return NewScene(None, "assumed: nothing stands around the robot")
    package_dirs = tuple(Path(one) for one in given.package_dirs)
    said = includes_of(given.includes, Path())
    asked = SceneRequest(resolved(given.scene, Path()), meshes.files, package_dirs, said)
    content = read_scene(asked)
    rows = content.scene["obstacles"]  # type: ignore[index]  # as the reader checked
    heading = f"scene from {asked.shown}: {counted(len(rows), 'obstacle')}"
    case, notes = _with_rows(content, asked, placed, meshes)
    if content.notices or case.notices:
        headings = (f"{heading}; it stays the file that it is, since it brings a warning",)
        return NewScene(
            path_from(folder, given.scene),
            "as it is, since it brings a warning",
            taken=headings,
            includes=_seen_from(folder, given.includes),
        )
    made = written_scene(content, asked, folder, "clearance new")
    return NewScene(
        SCENE,
        f"from {asked.shown}",
        {SCENE: made.content, **made.meshes},
        [_carried(carry) for carry in case.carries],
        [row.between for row in case.allow],
        case.robots[0].padding,
        (heading,),
        (*content.notes, *notes),
    )


def _with_rows(
    content: SceneContent, asked: SceneRequest, placed: PlacedRobot, meshes: MeshStore
) -> tuple[Case, list[str]]:
    """The case with what the scene's file says of links, and notes on that."""
    scene = validated(Scene, content.scene, asked.shown)
    obstacles, _ = make_obstacles(scene.obstacles, asked.path.parent, meshes)
    case, row_notes = with_scene_rows(Case("new", (placed,), obstacles), content)
    case, attached_notes = with_attached_parts(case, content)
    return case, [*row_notes, *attached_notes]


def _seen_from(folder: Path, includes: Mapping[str, str]) -> dict[str, str]:
    """What is taken for models, paths as a case in a folder has them."""
    return {
        uri: model if model == SKIP or "://" in model else path_from(folder, model)
        for uri, model in includes.items()
    }


def _carried(carry: Carry) -> dict[str, Any]:
    """A part that is carried all the time, as a case file has it."""
    touch = {"touch": list(carry.touch)} if carry.touch else {}
    return {"part": carry.part, "by": carry.by, "from": carry.window.start, **touch}

"""A scene file of any format to a scene file of ours, and what of it has no place there.

A scene of ours holds obstacles, a frame and warnings. What a file says of robots is left out, each with a line and
with what a case would say in its place; where leaving it out makes clearances larger, each check of the new scene
warns of it. Not for: a whole case (`new_case.files`).
"""

from __future__ import annotations

import re
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import replace
from pathlib import Path
from typing import Any, NamedTuple

from clearance.errors import BadInput, BadShape, at
from clearance.formats.files.input_files import InputFiles
from clearance.formats.known_formats import Kind, suffixes_written
from clearance.formats.mesh_store import MeshStore
from clearance.formats.scene.obstacles import make_obstacles
from clearance.formats.scene.request import ANY, SceneContent, SceneRequest, read_scene
from clearance.formats.scene.scene_yaml import rows_of, written_scene
from clearance.formats.schema.obstacle import Scene
from clearance.formats.schema.strict_model import validated
from clearance.formats.text.notes import counted
from clearance.formats.text.yaml_text import flow
from clearance.world.notice import Notice, Severity, listed
from clearance.world.rules import matches

_SHOWN = 6
"""Rows that a line shows; the file has all."""


class ConvertedFiles(NamedTuple):
    """What a conversion made.

    Attributes:
        files: contents by name, the target's and those that are to lie beside it.
        amount: of samples, poses or obstacles, in words.
        notes, warnings: a line each; warnings bear on what a check will find.
    """

    files: Mapping[str, bytes]
    amount: str
    notes: tuple[str, ...]
    warnings: tuple[str, ...] = ()


def converted_scene(asked: SceneRequest, target: Path) -> ConvertedFiles:
    """The scene of a file, to be written at `target`; it is read once more before it is handed over.

    Raises:
        BadInput: as its reader says; suspect input, of which the new file would say nothing. BadShape: no
        obstacle.
    """
    content = read_scene(asked)
    rows = rows_of(content)
    if not rows:
        raise BadShape("there is no obstacle in it", where=asked.shown, valid="a scene with some")
    _refuse_suspect(content, asked.shown)
    losses = [*_on_comments(asked), *_losses_of(content)]
    content = replace(content, notices=(*content.notices, *_on_padding(content, asked.shown)))
    remarks = [line for one in losses for line in one.remarks]
    made = written_scene(content, asked, target.parent, "clearance convert", remarks)
    files = {target.name: made.content, **made.meshes}
    _read_back(files, target, asked)
    return ConvertedFiles(
        files,
        counted(len(rows), "obstacle"),
        (*content.notes, *(f"{asked.shown}: {one.note}" for one in losses)),
        tuple(notice.line for notice in content.notices),
    )


class _Loss(NamedTuple):
    """A line on what has no place in a scene, and the lines of a case that would say it."""

    note: str
    remarks: tuple[str, ...] = ()


def _on_comments(asked: SceneRequest) -> Iterator[_Loss]:
    is_yaml = asked.path.suffix.lower() in suffixes_written(Kind.SCENE)
    if is_yaml and re.search(rb"^[ \t]*#", asked.files.read(asked.path), re.MULTILINE):
        yield _Loss("left out: its comments")


def _losses_of(content: SceneContent) -> list[_Loss]:
    """What makes clearances no larger where it is left out: more is measured then."""
    found = []
    named = [pair for pair in content.allow if ANY not in pair]
    pairs = [list(pair) for pair in named if _is_of_obstacle(pair, content)]
    if pairs:
        found.append(_rows("allow", "which pairs may touch", pairs))
    if len(named) < len(content.allow):
        whose = listed([pair[0] for pair in content.allow if ANY in pair], 6)
        found.append(_Loss(f"left out: defaults by which bodies may touch all others: {whose}"))
    n_links = len(named) - len(pairs)
    if n_links:
        found.append(_Loss(f"left out: {n_links} pairs of links that may touch, which srdf says"))
    if content.attached:
        found.append(_rows("carry", "that links carry what rides on them", list(_carries(content))))
    return found


def _carries(content: SceneContent) -> Iterator[dict[str, Any]]:
    for one in content.attached:
        touch = {"touch": list(one.touch)} if one.touch else {}
        yield {"part": one.part, "by": one.link, "from": 0.0, **touch}


def _is_of_obstacle(pair: tuple[str, str], content: SceneContent) -> bool:
    names = [row["name"] for row in rows_of(content)]
    return any(matches(name, pattern) for pattern in pair for name in names)


def _rows(key: str, what: str, rows: Sequence[object]) -> _Loss:
    """Rows of a case, some of them in the line and all of them among the remarks."""
    shown = listed([flow(row) for row in rows], _SHOWN)
    note = f"left out: {what}; a case says it: {key}: [{shown}]"
    return _Loss(note, (f"left out; a case says it: {key}:", *(f"- {flow(row)}" for row in rows)))


def _on_padding(content: SceneContent, given: str) -> Iterator[Notice]:
    """A warning, since clearances come out larger without the padding."""
    if content.link_padding:
        text = (
            f"padding of links that {given} gives is left out of the scene made from it, so clearances come out "
            f"larger; a case says it: robot: {{padding: {flow(content.link_padding)}}}"
        )
        yield Notice(Severity.WARNING, "padding", text)


def _refuse_suspect(content: SceneContent, given: str) -> None:
    """Nothing, if no notice of the reader makes a verdict suspect: the new file's numbers would not show why."""
    for notice in content.notices:
        if notice.severity is Severity.SUSPECT:
            raise BadInput(
                notice.text,
                where=given,
                valid=f"mend it, or name the file in a case with accept: [{notice.kind}]",
            )


def _read_back(files: Mapping[str, bytes], target: Path, asked: SceneRequest) -> None:
    """Nothing, if the files that are not there yet make the obstacles of a case.

    Raises:
        BadInput: a shape, a mesh or a table that no solid can have or follow.
    """
    back = InputFiles(target.parent)
    for name, content in files.items():
        back.put(target.parent / name, content)
    scene = validated(Scene, read_scene(SceneRequest(target, back)).scene, target.name)
    with at(asked.shown):
        make_obstacles(scene.obstacles, target.parent, MeshStore(back))
    asked.files.add_sources(back)

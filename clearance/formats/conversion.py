"""A trajectory, a scene or poses from one format to another: what a file holds, the files to write, and what is
to be known of them.

A file is known by its suffix and its first lines; reading it may find otherwise. A scene of ours holds
obstacles, a frame and warnings. What a file says of robots is left out, each with a line and with what a case
would say in its place; where leaving it out makes clearances larger, each check of the new scene warns of it. Not
for: writing the files, nor a whole case (`new_case.files`).
"""

from __future__ import annotations

import re
from collections.abc import Callable, Iterator, Mapping, Sequence
from dataclasses import dataclass, field, replace
from pathlib import Path
from typing import Any, NamedTuple

from clearance.errors import BadInput, BadShape, Contradiction, at
from clearance.formats.files.input_files import InputFiles
from clearance.formats.known_formats import (
    FORMATS,
    WANTED,
    Kind,
    foreign,
    formats_in,
    suffixes_written,
    written_as,
)
from clearance.formats.mesh_store import MeshStore
from clearance.formats.motion import pose_writer, trajectory_writer
from clearance.formats.motion.requests import is_bag
from clearance.formats.motion.trajectory_writer import untold
from clearance.formats.scene.obstacles import make_obstacles
from clearance.formats.scene.request import ANY, SceneContent, SceneRequest, read_scene
from clearance.formats.scene.scene_yaml import rows_of, written_scene
from clearance.formats.schema.obstacle import Scene
from clearance.formats.schema.strict_model import validated
from clearance.formats.schema.timed import Choice
from clearance.formats.text.file_start import LONGEST, POSE_COLUMNS
from clearance.formats.text.notes import counted
from clearance.formats.text.yaml_text import flow
from clearance.formats.timed_files import load_samples, load_trajectory
from clearance.world.notice import Notice, Severity, listed
from clearance.world.rules import matches
from clearance.world.timing import time_text


@dataclass(frozen=True)
class Conversion:
    """What is asked for.

    Attributes:
        source: the file to read, through `files`. target: the file to be made.
        choice: of a trajectory. package_dirs, includes: of a scene, as in `SceneRequest`.
    """

    source: Path
    target: Path
    files: InputFiles
    choice: Choice
    package_dirs: tuple[Path, ...] = ()
    includes: Mapping[str, str] = field(default_factory=dict)


def converted(asked: Conversion, kind: Kind) -> ConvertedFiles:
    """The files of a conversion.

    Raises:
        BadInput: what cannot be read, or cannot be written so.
    """
    written_as(kind, asked.target.name)
    _refuse_idle(asked, kind)
    return _CONVERTERS[kind](asked)


def _refuse_idle(asked: Conversion, kind: Kind) -> None:
    """Nothing, if all that is said is of use.

    Raises:
        BadInput: the first option that says nothing about a file of this kind.
    """
    is_motion, is_scene = kind is Kind.TRAJECTORY, kind is Kind.SCENE
    for option, is_given, is_used in (
        ("--which", asked.choice.which is not None, is_motion),
        ("--topic", asked.choice.topic is not None, is_motion),
        ("--package-dir", bool(asked.package_dirs), is_scene),
        ("--include", bool(asked.includes), is_scene),
    ):
        if is_given and not is_used:
            raise Contradiction(
                f"{option} says nothing about {WANTED[kind]}",
                where=asked.source.name,
                valid=f"leave {option} out",
            )


def _trajectory(asked: Conversion) -> ConvertedFiles:
    trajectory, notes = load_trajectory(asked.source, asked.choice, asked.files)
    with at(asked.source.name):
        for line in untold(trajectory, asked.target.name):
            valid = "mend it, or name the file itself in a case, as trajectory"
            raise BadInput(line, valid=valid)
        content, changes = trajectory_writer.written(trajectory, asked.target.name)
    n_joints = counted(len(trajectory.joint_names), "joint")
    samples = trajectory_writer.samples_in(trajectory, asked.target.name)
    amount = f"{counted(len(samples.times), 'sample')} of {n_joints}"
    if set(POSE_COLUMNS[1:4]) <= {*trajectory.joint_names}:
        changes += (f"x, y and z are joints; poses also need {', '.join(POSE_COLUMNS[4:])}",)
    notes = (*notes, *_of_target(asked, changes))
    stamp = _stamp_lost(asked, trajectory.began)
    return ConvertedFiles({asked.target.name: content}, amount, notes, stamp)


def _poses(asked: Conversion) -> ConvertedFiles:
    samples, notes = load_samples(asked.source, asked.files)
    with at(asked.source.name):
        content, changes = pose_writer.written_poses(samples, asked.target.name)
    of_source = (f"{asked.source.name}: {note}" for note in notes)
    amount = counted(len(samples.times), "pose")
    notes = (*of_source, *_of_target(asked, changes))
    is_kept = written_as(Kind.POSES, asked.target.name).is_message
    stamp = () if is_kept else _stamp_lost(asked, samples.table().began)
    return ConvertedFiles({asked.target.name: content}, amount, notes, stamp)


def converted_scene(asked: Conversion) -> ConvertedFiles:
    """The scene of a file; it is read once more before it is handed over.

    Raises:
        BadInput: as its reader says; suspect input, of which the new file would say nothing. BadShape: no
        obstacle.
    """
    request = SceneRequest(asked.source, asked.files, asked.package_dirs, asked.includes)
    target = asked.target
    content = read_scene(request)
    rows = rows_of(content)
    if not rows:
        raise BadShape("there is no obstacle in it", where=request.shown, valid="a scene with some")
    _refuse_suspect(content, request.shown)
    losses = [*_on_comments(request), *_losses_of(content)]
    content = replace(content, notices=(*content.notices, *_on_padding(content, request.shown)))
    remarks = [line for one in losses for line in one.remarks]
    made = written_scene(content, request, target.parent, "clearance convert", remarks)
    files = {target.name: made.content, **made.meshes}
    _read_back(files, target, request)
    return ConvertedFiles(
        files,
        counted(len(rows), "obstacle"),
        (*content.notes, *(f"{request.shown}: {one.note}" for one in losses)),
        tuple(notice.line for notice in content.notices),
    )


def _stamp_lost(asked: Conversion, began: float | None) -> tuple[str, ...]:
    """A warning, if the clock of a recording is no more known from the new file."""
    says = (
        "which it cannot say: checks no longer see that another recording begins at another time; "
        "give the delay between them as `start:` beside the file"
    )
    lost = () if began is None else (f"the first sample is stamped {time_text(began)} s, {says}",)
    return _of_target(asked, lost)


def _of_target(asked: Conversion, changes: tuple[str, ...]) -> tuple[str, ...]:
    return tuple(f"{asked.target.name}: {change}" for change in changes)


_CONVERTERS: dict[Kind, Callable[[Conversion], ConvertedFiles]] = {
    Kind.TRAJECTORY: _trajectory,
    Kind.SCENE: converted_scene,
    Kind.POSES: _poses,
}


CONVERTED = (Kind.TRAJECTORY, Kind.SCENE, Kind.POSES)
"""What can be converted."""

_DOCUMENTS = {".yaml", ".yml", ".json"}

_KEY = re.compile(rb"""(?:^|[{,])[ \t-]*(["']?)([A-Za-z_]+)\1[ \t]*:""", re.MULTILINE)
_COMMENT = re.compile(rb"(?:^|(?<=\s))#[^\n]*")
_QUOTED = re.compile(rb"""("(?:[^"\\\n]|\\.)*"|'[^'\n]*')([ \t]*:)?""")
"""Text in quotes, which may say anything where it is no key."""

_WANTED = "a trajectory, a scene or poses"


def kind_of(path: Path, files: InputFiles) -> Kind:
    """What a file holds.

    Raises:
        MissingFile: it is not there. BadSyntax: another kind of file, and what to do with it. BadShape: it is
        empty. BadInput: nothing says what it is.
    """
    if is_bag(path):
        return Kind.TRAJECTORY
    shown = files.shown(path)
    with files.unread(path)() as file:
        head = file.read(LONGEST)
    if not head.removeprefix(b"\xef\xbb\xbf").strip():
        raise BadShape("the file is empty", where=shown, valid=_WANTED)
    known = formats_in(head, shown)
    kinds = [one.kind for one in known if one.kind in CONVERTED]
    if known and not kinds:
        raise foreign(known[0], shown, _WANTED)
    if kinds:
        return kinds[0]
    if path.suffix.lower() not in _DOCUMENTS:
        return Kind.TRAJECTORY
    found = _of_keys(head)
    if found is None:
        raise BadInput(
            "the content of this file is not recognised",
            where=shown,
            valid=f"--kind says it: {', '.join(CONVERTED)}",
        )
    return found


def _of_keys(head: bytes) -> Kind | None:
    """By the first key that only one of them has; nested ones count, since messages hold messages."""
    says = {key: one.kind for one in FORMATS for key in one.keys}
    keys = _QUOTED.sub(lambda text: text[0] if text[2] else b"", _COMMENT.sub(b"", head))
    found = (says.get(key[2].decode()) for key in _KEY.finditer(keys))
    return next((kind for kind in found if kind is not None), None)


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

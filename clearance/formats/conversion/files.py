"""A trajectory, a scene or poses from one format to another: what a file holds, the files to write, and what is
to be known of them.

A file is known by its suffix and its first lines; reading it may find otherwise. Not for: writing the files.
"""

from __future__ import annotations

import re
from collections.abc import Callable, Mapping
from dataclasses import dataclass, field
from pathlib import Path

from clearance.errors import BadInput, BadShape, Contradiction, at
from clearance.formats.conversion.scene import ConvertedFiles, converted_scene
from clearance.formats.files.input_files import InputFiles
from clearance.formats.known_formats import FORMATS, WANTED, Kind, foreign, formats_in, written_as
from clearance.formats.motion import pose_writer, trajectory_writer
from clearance.formats.motion.requests import is_bag
from clearance.formats.motion.trajectory_writer import untold
from clearance.formats.scene.request import SceneRequest
from clearance.formats.schema.timed import Choice
from clearance.formats.text.file_start import LONGEST, POSE_COLUMNS
from clearance.formats.text.notes import counted
from clearance.formats.timed_files import load_samples, load_trajectory
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


def _scene(asked: Conversion) -> ConvertedFiles:
    request = SceneRequest(asked.source, asked.files, asked.package_dirs, asked.includes)
    return converted_scene(request, asked.target)


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
    Kind.SCENE: _scene,
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

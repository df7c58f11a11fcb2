"""A trajectory, a scene or poses from one format to another: the files to write, and what is to be known of them.

Not for: which of these a file is (`file_kind`), nor writing the files.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import dataclass, field
from pathlib import Path
from typing import NamedTuple

from clearance.errors import BadInput, at
from clearance.formats.conversion.scene import converted_scene
from clearance.formats.files.input_files import InputFiles
from clearance.formats.known_formats import WANTED, Kind, written_as
from clearance.formats.motion import pose_writer, trajectory_writer
from clearance.formats.motion.trajectory_request import Choice
from clearance.formats.scene.request import SceneRequest
from clearance.formats.text.notes import counted
from clearance.formats.timed_files import load_samples, load_trajectory
from clearance.world.trajectory import Trajectory


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


class ConvertedFiles(NamedTuple):
    """What was made.

    Attributes:
        files: contents by name, the target's and those that are to lie beside it.
        told: how much it is. notes, warnings: a line each; warnings bear on what a check will find.
    """

    files: Mapping[str, bytes]
    told: str
    notes: tuple[str, ...]
    warnings: tuple[str, ...] = ()


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
            raise BadInput(
                f"{option} says nothing about {WANTED[kind]}",
                where=asked.source.name,
                valid=f"leave {option} out",
            )


def _trajectory(asked: Conversion) -> ConvertedFiles:
    trajectory, notes = load_trajectory(asked.source, asked.choice, asked.files)
    with at(asked.source.name):
        _refuse_holes(trajectory)
        content, changes = trajectory_writer.written(trajectory, asked.target.name)
    n_joints = counted(len(trajectory.joint_names), "joint")
    samples = trajectory_writer.samples_in(trajectory, asked.target.name)
    told = f"{counted(len(samples.times), 'sample')} of {n_joints}"
    return ConvertedFiles({asked.target.name: content}, told, (*notes, *_of_target(asked, changes)))


def _refuse_holes(trajectory: Trajectory) -> None:
    """Nothing, if a table can say all that is known.

    Raises:
        BadInput: a recording with a hole, which samples alone would bridge.
    """
    for hole in trajectory.holes:
        if hole.end <= trajectory.times[0] or hole.start >= trajectory.times[-1]:
            continue  # not in the table
        raise BadInput(
            f"{hole.text}; a table would bridge it by a straight line",
            valid="a recording without holes, or the file itself in a case, with gaps:",
        )


def _poses(asked: Conversion) -> ConvertedFiles:
    samples, notes = load_samples(asked.source, asked.files)
    with at(asked.source.name):
        content, changes = pose_writer.written_poses(samples, asked.target.name)
    of_source = (f"{asked.source.name}: {note}" for note in notes)
    told = counted(len(samples.times), "pose")
    return ConvertedFiles(
        {asked.target.name: content}, told, (*of_source, *_of_target(asked, changes))
    )


def _scene(asked: Conversion) -> ConvertedFiles:
    request = SceneRequest(asked.source, asked.files, asked.package_dirs, asked.includes)
    made = converted_scene(request, asked.target)
    return ConvertedFiles(
        made.files, counted(made.n_obstacles, "obstacle"), made.notes, made.warnings
    )


def _of_target(asked: Conversion, changes: tuple[str, ...]) -> tuple[str, ...]:
    return tuple(f"{asked.target.name}: {change}" for change in changes)


_CONVERTERS: dict[Kind, Callable[[Conversion], ConvertedFiles]] = {
    Kind.TRAJECTORY: _trajectory,
    Kind.SCENE: _scene,
    Kind.POSES: _poses,
}

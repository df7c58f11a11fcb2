"""The files that say how a robot or an obstacle moves, found and read. Not for: their format (`motion.requests`),
nor which joints there are (`robots`).
"""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import replace
from pathlib import Path
from typing import TypeVar

from clearance.errors import BadInput, at
from clearance.formats.files.input_files import InputFiles, resolved
from clearance.formats.known_formats import Kind, refuse_foreign
from clearance.formats.motion.joint_columns import without_followers
from clearance.formats.motion.recording_gaps import as_recorded
from clearance.formats.motion.requests import (
    PoseRequest,
    ReadSamples,
    ReadTrajectory,
    TrajectoryRequest,
    files_of,
    is_bag,
    read_samples,
    read_trajectory,
)
from clearance.formats.schema.timed import Choice, PoseFile, TrajectoryFile
from clearance.formats.table.csv_table import Opener
from clearance.formats.text.notes import counted
from clearance.world.joint_positions import turns
from clearance.world.notice import listed
from clearance.world.pose_table import PoseTable, require_samples_to_loop
from clearance.world.reach import require_few_turns
from clearance.world.robot import Robot, require_moving_joints
from clearance.world.trajectory import AS_WRITTEN, SHORTEST
from clearance.world.wrap import long_steps, meant, wrapping_joints

Table = TypeVar("Table")


def trajectory_of(
    given: TrajectoryFile,
    field: str,
    robot: Robot,
    files: InputFiles,
    *,
    recorded: bool = False,
) -> ReadTrajectory:
    """The trajectory that a case file names for a robot.

    Args:
        field: where it is named. recorded: True for what a robot did, which a table does not show by itself.

    Raises:
        BadInput: with the field and the file.
    """

    kinds = {joint.name: turns(joint) for joint in robot.moving_joints}
    wrapping = frozenset() if given.wrap == AS_WRITTEN else wrapping_joints(robot)
    follow = {joint.name: turns(joint) for joint in robot.joints if joint.mimic is not None}

    def read(opened: Opener, shown: str) -> ReadTrajectory:
        request = TrajectoryRequest(opened, bool(kinds), given, kinds | follow, robot)
        found = read_trajectory(request, shown)
        return as_recorded(found, given.gaps) if recorded or given.gaps else found

    path = files.resolved(given.file)
    with at(f"{field}.file"):
        found = (
            _of_bag(path, files, given, kinds | follow, wrapping)
            if is_bag(path)
            else _read(path, files, read, Kind.TRAJECTORY)
        )
        with at(files.shown(path)):
            trajectory, notes = without_followers(robot, found.trajectory)
            require_moving_joints(robot, trajectory.joint_names)
            require_few_turns(robot, trajectory.joint_names, trajectory)
    with at(field), at(files.shown(path)):
        require_samples_to_loop(trajectory.n_steps, given.timing)
        given.timing.run_times(trajectory.times)
    named = (f"{files.shown(path)}: {note}" for note in notes)
    found = ReadTrajectory(trajectory, (*found.notes, *named))
    wrap = given.wrap or (SHORTEST if recorded or given.gaps else trajectory.wrap)
    return found if wrap is None else _with_wrap(found, wrap, robot, files.shown(path))


def _with_wrap(found: ReadTrajectory, wrap: str, robot: Robot, shown: str) -> ReadTrajectory:
    """The trajectory whose steps of more than half a turn go one way or the other, and a note on those."""
    asked = replace(found.trajectory, wrap=wrap)
    steps = long_steps(robot, asked)
    joints = listed([f"{one.joint!r} in {counted(one.n_steps, 'step')}" for one in steps], 8)
    way = "the shortest way" if wrap == SHORTEST else "as written"
    note = f"{shown}: steps of more than half a turn go {way} (wrap: {wrap}): joint {joints}"
    return ReadTrajectory(meant(robot, asked), (*found.notes, note) if steps else found.notes)


def load_trajectory(path: Path, choice: Choice, files: InputFiles | None = None) -> ReadTrajectory:
    """The trajectory in a file, whatever robot it is for.

    Args:
        files: what it is read through, if that is to be known afterwards.

    Raises:
        BadInput: with the place in the file.
    """
    files = files or InputFiles(path.parent)
    if is_bag(path):
        return _of_bag(path, files, choice, {})

    def read(opened: Opener, shown: str) -> ReadTrajectory:
        return read_trajectory(TrajectoryRequest(opened, choice=choice), shown)

    return _read(path, files, read, Kind.TRAJECTORY)


def load_samples(path: Path, files: InputFiles, length: str | None = None) -> ReadSamples:
    """The poses in a file, as they stand there, which something can follow.

    Args:
        length: as in `PoseRequest`.

    Raises:
        BadInput: with the place in the file.
    """

    def read(opened: Opener, shown: str) -> ReadSamples:
        return read_samples(PoseRequest(opened, length), shown)

    return _read(path, files, read, Kind.POSES)


def _of_bag(
    path: Path,
    files: InputFiles,
    choice: Choice,
    kinds: Mapping[str, bool],
    wrapping: frozenset[str] | None = None,
) -> ReadTrajectory:
    """What is in a bag, whose files are not kept."""
    from clearance.formats.motion.rosbag_file import read_bag

    shown = files.shown(path)
    for one in files_of(path):
        files.unread(one)
    with at(shown):
        trajectory, notes = read_bag(path, choice, kinds, wrapping)
    return ReadTrajectory(trajectory, tuple(f"{shown}: {note}" for note in notes))


def pose_table_of(
    given: PoseFile, folder: Path, files: InputFiles
) -> tuple[PoseTable, tuple[str, ...]]:
    """The table of poses that a case file names for an obstacle in `moves`, and notes on how it was read.

    Args:
        folder: against which the path is looked up.

    Raises:
        BadInput: with the field and the file.
    """
    path = resolved(given.file, folder)
    with at("moves.file"):
        samples, notes = load_samples(path, files, given.length)
    with at("moves"), at(files.shown(path)):
        given.timing.run_times(samples.times)
        return replace(samples.table(), timing=given.timing), notes


def _read(path: Path, files: InputFiles, read: Callable[[Opener, str], Table], kind: Kind) -> Table:
    """What is in a file, which is not kept; where it cannot be read, its content may say why."""
    shown = files.shown(path)
    opened = files.unread(path)
    try:
        return read(opened, shown)
    except BadInput:
        with opened() as file:
            refuse_foreign(file.read(65536), shown, kind)
        raise

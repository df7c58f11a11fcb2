"""A robot's file, its motion and its scene, in whatever formats they are, to the files of a new case.

Everything is read by the readers that a case's own keys use; what the new case says is loaded once more before it
is handed over. Not for: writing the files, nor the text of the case (`text`).
"""

from __future__ import annotations

import os
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass, replace
from pathlib import Path
from typing import Any, NamedTuple

import numpy as np

from clearance.case.case_file import read_case
from clearance.case.new_case.robot import NewCaseRequest, NewRobot, new_robot
from clearance.case.new_case.text import TOUCHING, CaseText, NewScene, new_scene, text_of
from clearance.errors import BadInput, MissingKey, NothingToMeasure, at
from clearance.formats.files.input_files import InputFiles, path_from, resolved
from clearance.formats.mesh_store import MeshStore
from clearance.formats.motion.trajectory_writer import untold, written
from clearance.formats.robot.srdf import (
    NamedStates,
    bases_in_states,
    names_of,
    positions_in_states,
    states_known,
)
from clearance.formats.text.notes import counted
from clearance.formats.text.yaml_text import flow
from clearance.world.case import Case, Source
from clearance.world.names import checked_name
from clearance.world.notice import START, Severity, listed
from clearance.world.plausible_motion import notices_on_motion
from clearance.world.plausible_recordings import notices_on_holes
from clearance.world.plausible_wrap import notices_on_wrap
from clearance.world.robot import Robot
from clearance.world.timing import time_text
from clearance.world.trajectory import Trajectory

CASE, TRAJECTORY = "case.yaml", "trajectory.csv"
MESSAGE = "trajectory.yaml"
"""What has accelerations, which no table has."""


@dataclass(frozen=True)
class NewCase:
    """A new case.

    Attributes:
        files: content by name. case: what they say. sources: the files that were read.
        taken, assumed: a line each. notes: on what is read anew with each check. lost: notes that are not, but
            stand in the files as comments. text: what the case file says.
    """

    files: Mapping[str, bytes]
    case: Case
    sources: tuple[Source, ...]
    taken: tuple[str, ...]
    assumed: tuple[str, ...]
    notes: tuple[str, ...]
    lost: tuple[str, ...]
    text: CaseText

    def proposing(self, touching: Sequence[tuple[str, str]]) -> NewCase:
        """The same with pairs that touch at every step as a comment in the case file, to be allowed by hand."""
        if not touching:
            return self
        text = replace(self.text, touching=touching)
        pairs = listed([" - ".join(pair) for pair in touching], 6)
        lost = (
            f"{TOUCHING}: {pairs}; where that is meant, {CASE} has the rows of allow in a comment"
        )
        files = {**self.files, CASE: text_of(text).encode()}
        return replace(self, files=files, text=text, lost=(*self.lost, lost))


def new_case(given: NewCaseRequest, folder: Path) -> NewCase:
    """The files of a case in `folder`, which need not be there.

    Raises:
        BadInput: something that was given cannot be used. MissingKey: nothing moves. NothingToMeasure: nothing is
        left to measure.
    """
    folder = Path(os.path.abspath(folder))
    files = InputFiles(Path())
    meshes = MeshStore(files)
    robot = new_robot(given, meshes)
    trajectory, source = _motion(given, robot, files)
    with at("states"):
        taken = bases_in_states(
            _states(given, robot, files), [*given.states, *given.rest], robot.placed.robot
        )
    robot = robot.standing(taken)
    with at("scene"):
        moving = replace(robot.placed, trajectory=trajectory)
        scene = new_scene(given, moving, meshes, folder)
    motion = _Motion(
        trajectory, f"from {source}: {_described(trajectory)}", _notes_of(given, robot, files)
    )
    text = _text(given, robot, scene, motion, folder, files)
    contents = {CASE: text_of(text).encode(), **scene.contents}
    name = text.trajectory.get("file")
    if name in (TRAJECTORY, MESSAGE):
        contents[name] = written(trajectory, name).content
    try:
        case = _read_back(contents, folder)
    except NothingToMeasure:
        if scene.name is not None:
            raise
        raise NothingToMeasure(
            "no two links are left to measure against each other, and nothing stands around the robot",
            valid="--scene FILE",
        ) from None
    return NewCase(
        contents,
        case,
        files.sources,
        (*robot.taken, f"trajectory {motion.source}", *scene.taken),
        (
            *robot.assumed(trajectory, scene.name is None),
            *_assumed(given),
        ),
        tuple(dict.fromkeys(note for note in robot.notes if note not in motion.notes)),
        (*motion.notes, *scene.notes),
        text,
    )


class _Motion(NamedTuple):
    """What the robot does, where that is from, and what was noted of its file."""

    trajectory: Trajectory
    source: str
    notes: Sequence[str]


def _notes_of(given: NewCaseRequest, robot: NewRobot, files: InputFiles) -> list[str]:
    """The notes on the trajectory's file, which begin with its name; a program is read anew with each check."""
    if given.trajectory is None or "program" in given.trajectory:
        return []
    begins = f"{files.shown(Path(given.trajectory['file']))}: "
    return [note for note in robot.notes if note.startswith(begins)]


def _motion(given: NewCaseRequest, robot: NewRobot, files: InputFiles) -> tuple[Trajectory, str]:
    """What the robot does, and where that is from."""
    if robot.placed.trajectory is not None and given.trajectory is not None:
        topic = given.trajectory.get("topic")
        shown = files.shown(Path(given.motion_file or ""))
        return robot.placed.trajectory, shown + (f", topic {topic}" if topic else "")
    if not given.states:
        raise MissingKey(
            "nothing moves: no trajectory is given",
            valid="--trajectory FILE (a CSV of two rows will do: time and the joints), "
            "--program FILE, or --srdf FILE and --states home,ready",
        )
    with at("states"):
        known = _states(given, robot, files)
        if given.srdf is None and not known.states:
            raise MissingKey(f"state {given.states[0]!r} is in no file", valid="--srdf FILE")
        trajectory = motion_between(known, given.states, robot.placed.robot)
    return trajectory, f"{known.shown}, states {', '.join(given.states)}"


def _described(trajectory: Trajectory) -> str:
    start, end = trajectory.times[[0, -1]].tolist()
    n_joints = counted(len(trajectory.joint_names), "joint")
    n_samples = counted(len(trajectory.written.times), "sample")
    return f"{n_samples} of {n_joints}, {time_text(start)} to {time_text(end)} s"


def _assumed(given: NewCaseRequest) -> Iterator[str]:
    """What it means that nobody gives a motion, or asks for a clearance."""
    if given.trajectory is None:
        yield f"from state to state all joints move straight, {PERIOD:g} s each; a planner would do otherwise"
    if given.limits.get("fail") is None:
        yield (
            "fail limit 0 mm: only contact fails, any gap passes; --fail-mm 5, or limits: in case.yaml, asks for "
            "5 mm"
        )


def _text(
    given: NewCaseRequest,
    robot: NewRobot,
    scene: NewScene,
    motion: _Motion,
    folder: Path,
    files: InputFiles,
) -> CaseText:
    """What the case file says."""
    named = (given.keys["urdf"], given.motion_file, given.scene, given.srdf)
    resting = robot.resting(motion.trajectory)
    states = [] if given.rest or not resting else names_of(_states(given, robot, files).states)
    return CaseText(
        name=checked_name(folder.name) or "case",
        made_from=[files.shown(resolved(one, Path())) for one in named if one is not None],
        robot=robot.written(folder, scene.name is None)
        | ({"padding": scene.padding} if scene.padding else {}),
        link=robot.first_body,
        resting=resting,
        states=states,
        scene=scene,
        trajectory=_trajectory_keys(given, motion.trajectory, folder),
        motion=motion.source,
        motion_notes=motion.notes,
        motion_keys=_open_keys(robot, motion.trajectory),
        remarks=robot.remarks(motion.trajectory),
        limits=given.limits,
    )


def _trajectory_keys(given: NewCaseRequest, trajectory: Trajectory, folder: Path) -> dict[str, Any]:
    """The keys of the trajectory: a file of the case's own, or the one given if that says what samples do not. A
    program stays the file that it is.
    """
    if "program" in (given.trajectory or {}):
        keys = dict(given.trajectory or {})
        program = {**keys["program"], "file": path_from(folder, keys["program"]["file"])}
        program |= {"beside": [path_from(folder, one) for one in program.get("beside", ())]}
        program = {key: value for key, value in program.items() if value != []}
        return {**keys, "program": program if len(program) > 1 else program["file"]}
    name = TRAJECTORY if trajectory.points is None else MESSAGE
    if given.trajectory is not None and any(untold(trajectory, name)):
        keys = dict(given.trajectory)
        return {**keys, "file": path_from(folder, keys["file"])}
    return {"file": name}


def _open_keys(robot: NewRobot, trajectory: Trajectory) -> list[tuple[str, str]]:
    """Keys of the trajectory that would answer what is suspect about it, and what that is."""
    moving = replace(robot.placed, trajectory=trajectory)
    found = [("wrap: shortest", f"or as_written: {one.text}") for one in notices_on_wrap(moving)]
    found += [
        ("gaps: hold", f"or linear, or not_measured: {one.text}")
        for one in notices_on_holes(moving)
        if one.severity is Severity.SUSPECT
    ]
    start = flow(dict.fromkeys(trajectory.joint_names, 0.0))
    goals = (one for one in notices_on_motion(moving) if one.kind == START)
    return [*found, *((f"start_state: {start}", f"or elsewhere: {one.text}") for one in goals)]


def _states(given: NewCaseRequest, robot: NewRobot, files: InputFiles) -> NamedStates:
    """The states of the SRDF or of the robot's own file."""
    srdf = None if given.srdf is None else resolved(given.srdf, Path())
    placed = robot.placed
    return states_known(srdf, placed.robot, Path(placed.urdf_path), files)


def _read_back(contents: Mapping[str, bytes], folder: Path) -> Case:
    """What the files say, though they are not there yet."""
    files = InputFiles(folder)
    for name, content in contents.items():
        files.put(folder / name, content)
    return read_case(folder / CASE, files)


PERIOD = 2.0
"""[s] From one state to the next."""


def motion_between(known: NamedStates, states: Sequence[str], robot: Robot) -> Trajectory:
    """The robot in each state in turn, joints moving linearly; one that a state leaves alone stays where it was.

    Raises:
        BadInput: as `positions_in_states`, or fewer than two states.
    """
    if len(states) < 2:
        raise BadInput(
            f"{len(states)} state is given", valid="two or more, for a motion between them"
        )
    found = [positions_in_states(known, [state], robot).positions for state in states]
    names = [joint.name for joint in robot.moving_joints if any(joint.name in one for one in found)]
    rows = np.array(
        [[_state_position(name, i, found) for name in names] for i in range(len(found))]
    )
    return Trajectory(PERIOD * np.arange(len(states)), tuple(names), rows)


def _state_position(name: str, i_state: int, found: Sequence[dict[str, float]]) -> float:
    """Where a joint is: by this state, else by the last before it, else by the first that says so."""
    before = [one[name] for one in found[: i_state + 1] if name in one]
    return before[-1] if before else next(one[name] for one in found if name in one)

"""A recorded run in place of what a robot was asked: its errors become the tracking of the case's tolerances.

Not for: comparing (`world.recording`), nor the formats (`timed_files`).
"""

from __future__ import annotations

import math
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import replace
from pathlib import Path

import numpy as np

from clearance.errors import BadMotion, BadTime, UnknownRobot, at
from clearance.formats.files.input_files import InputFiles
from clearance.formats.schema.strict_model import validated
from clearance.formats.schema.timed import TrajectoryFile
from clearance.formats.schema.tolerance import MOST
from clearance.formats.timed_files import trajectory_of
from clearance.world.budget import Budget, JointTolerance, RobotTolerance
from clearance.world.case import Case, index_of_robot
from clearance.world.cubic import positions_along
from clearance.world.joint_positions import turns
from clearance.world.notice import GAPS, Notice, Severity, listed
from clearance.world.placed_robot import PlacedRobot
from clearance.world.recording import Recording, motion_left_out, recording_of
from clearance.world.timing import AS_GIVEN, time_text
from clearance.world.trajectory import Trajectory
from clearance.world.wrap import wrapping_joints


def with_recorded(
    case: Case,
    path: str | Path,
    offset: float = 0.0,
    robot: str | None = None,
    gaps: str | None = None,
    columns: Mapping[str, str] | Sequence[str] | None = None,
) -> Case:
    """The case in which a robot does what was recorded, its errors being the tracking of its joints.

    Args:
        path: a bag or a table. offset: [s] added to its times to have the run's; none is estimated.
        robot: whose run it is; needed where several move by trajectories.
        gaps: what joints do in holes of it: one of `world.notice.GAPS`. columns: of a table, as of a trajectory.

    Raises:
        BadInput: with the file; joints that are not recorded, no time in common, errors of a size that only
            another offset explains, a motion of such a size that it leaves out.
    """
    i_robot = _robot_of(case, robot)
    placed, path = case.robots[i_robot], Path(path)
    if not math.isfinite(offset):
        raise BadTime(f"an offset of {offset} s", valid="a finite number of seconds")
    files = InputFiles(path.parent)
    shown = files.shown(path)
    if gaps is not None and gaps not in GAPS:
        raise BadMotion(f"gaps is {gaps!r:.60}", valid=f"one of {', '.join(GAPS)}")
    said = {} if columns is None else {"columns": columns}
    given = validated(TrajectoryFile, {"file": path.name, **said}, "recorded")
    given = given.model_copy(update={"gaps": gaps})
    read, notes = trajectory_of(given, "recorded", placed.robot, files, recorded=True)
    with at(f"recorded: {shown}"):
        driven = _near_what_was_asked(read.shifted(offset), placed)
        resting = placed.fixed_positions
        found = recording_of(shown, offset, driven, placed.given_trajectory, placed.timing, resting)
        notices = [*_of_motion_left_out(placed, found), *_of_others(case, placed, found)]
        budget = _with_tracking(case.tolerance or Budget(), placed, found)
    robots = [*case.robots]
    robots[i_robot] = replace(
        placed, trajectory=driven, timing=AS_GIVEN, recording=found, trajectory_path=str(path)
    )
    return replace(
        case,
        robots=tuple(robots),
        tolerance=budget,
        sources=files.sources_beside(case.sources),
        notes=(*case.notes, *notes, *_notes(found)),
        notices=(*case.notices, *notices),
    )


def _near_what_was_asked(driven: Trajectory, placed: PlacedRobot) -> Trajectory:
    """The recording with whole turns on joints that have no limits, so that it begins next to what was asked."""
    asked, timing = placed.given_trajectory, placed.timing
    start = np.array([max(driven.times[0], timing.run_times(asked.times)[0])])
    own = positions_along(asked, timing.table_times(start))[0].tolist()
    wanted = placed.fixed_positions | dict(zip(asked.joint_names, own, strict=True))
    was, positions = positions_along(driven, start)[0], driven.positions.copy()
    for i, name in enumerate(driven.joint_names):
        if name in wrapping_joints(placed.robot):
            turns = np.round((wanted.get(name, 0.0) - was[i]) / (2.0 * np.pi))
            positions[:, i] += 2.0 * np.pi * turns
    return replace(driven, positions=positions)


def _robot_of(case: Case, robot: str | None) -> int:
    moving = [one.robot.name for one in case.robots if one.trajectory is not None]
    if robot is None and len(moving) == 1:
        robot = moving[0]
    if robot is None:
        raise UnknownRobot(
            f"{len(moving)} robots move, and one was recorded",
            valid=f"its name: --recorded-robot {' or '.join(moving)}",
        )
    i_robot = index_of_robot(case.robots, robot)
    if case.robots[i_robot].trajectory is None:
        raise UnknownRobot(
            f"robot {case.robots[i_robot].robot.name!r} was asked for nothing",
            valid="a robot with a trajectory",
        )
    return i_robot


def _with_tracking(budget: Budget, placed: PlacedRobot, found: Recording) -> Budget:
    """The budget with the greatest error of each joint as its tracking.

    Raises:
        BadInput: an error beyond what tolerances may be.
    """
    name = placed.robot.name
    robot = budget.robots.get(name, RobotTolerance())
    joints, units = dict(robot.joints), _units(placed)
    for one in found.joints:
        most = MOST[units[one.joint]]
        if one.greatest > most:
            raise BadMotion(
                f"joint {one.joint!r} is {one.greatest:.3g} {units[one.joint]} off the commanded motion at "
                f"{one.time:.3f} s",
                valid=f"at most {most:g} {units[one.joint]}, of joints with the zeros and signs of the URDF "
                "(`axes` of a program is not applied); --recorded-offset, if its clock is another",
            )
        joints[one.joint] = replace(joints.get(one.joint, JointTolerance()), tracking=one.greatest)
    source = f"tracking: the greatest errors of the run {found.path}"
    robots = {**budget.robots, name: replace(robot, joints=joints)}
    return replace(budget, robots=robots, sources=(*budget.sources, source))


def _of_motion_left_out(placed: PlacedRobot, found: Recording) -> list[Notice]:
    """A warning where joints were to move before the recording begins or after it ends.

    Raises:
        BadInput: one by more than tolerances may be.
    """
    left_out, units = motion_left_out(found), _units(placed)
    times = found.timing.run_times(found.commanded.times)
    span = f"recorded from {found.start:.3f} to {found.end:.3f} s"
    asked = f"of {times[0]:.3f} to {times[-1]:.3f} s"
    for one in left_out:
        most = MOST[units[one.joint]]
        if one.greatest > most:
            raise BadMotion(
                f"it is {span} {asked}; in the rest joint {one.joint!r} was to move by {one.greatest:.3g} "
                f"{units[one.joint]}",
                valid=f"a recording that misses at most {most:g} {units[one.joint]} of it",
            )
    if not left_out:
        return []
    worst = max(left_out, key=lambda one: one.greatest)
    rest = max(found.start - times[0], 0.0) + max(times[-1] - found.end, 0.0)
    text = (
        f"{found.path} is {span} {asked}: nothing is said of the other {rest:.3g} s, in which joint "
        f"{worst.joint!r} was to move by {worst.greatest:.3g} {units[worst.joint]}"
    )
    return [Notice(Severity.WARNING, "recorded run", text, placed.robot.name)]


def _of_others(case: Case, placed: PlacedRobot, found: Recording) -> Iterator[Notice]:
    """A warning where another robot moves too and no tolerance says how far it is off."""
    robots = {} if case.tolerance is None else case.tolerance.robots
    names = [
        other.robot.name
        for other in case.robots
        if other is not placed and other.trajectory is not None and other.trajectory.n_steps > 1
    ]
    exact = [name for name in names if name not in robots or not robots[name].joints]
    if exact:
        text = (
            f"{found.path} is a run of {placed.robot.name} alone: {listed(exact)} is taken to move exactly as "
            "commanded; tolerances of tracking say otherwise"
        )
        yield Notice(Severity.WARNING, "recorded run", text, placed.robot.name)


def _units(placed: PlacedRobot) -> dict[str, str]:
    return {joint.name: "rad" if turns(joint) else "m" for joint in placed.robot.joints}


def _notes(found: Recording) -> list[str]:
    span = f"from {found.start:.3f} to {found.end:.3f} s"
    clock = "its clock is taken as the run's" if found.offset == 0.0 else (
        f"{time_text(found.offset)} s are added to its times"
    )  # fmt: skip
    end = float(found.timing.run_times(found.commanded.times)[-1])
    start = float(found.timing.run_times(found.commanded.times)[0])
    short = "" if (found.start, found.end) == (start, end) else f", of {start:.3f} to {end:.3f} s"
    return [
        f"recorded run {found.path}: compared with what was asked {span}{short}; {clock}, no offset is estimated",
        "what is proven holds for every run that stays as near to this one as this one to what was asked",
    ]

"""The start at 0 s of a trajectory whose first sample is later, as the case file gives it: by value, or by states.

Not for: the start in a message (`motion.message_beside`), nor joints that rest (`resting`).
"""

from __future__ import annotations

from collections.abc import Mapping
from pathlib import Path

import numpy as np

from clearance.case.resting import positions_asked
from clearance.errors import BadInput, BadTime, MissingKey, at
from clearance.formats.files.input_files import InputFiles
from clearance.formats.schema import case as schema
from clearance.formats.schema.pose import TrajectoryFile
from clearance.world.moving_joints import require_moving_joints
from clearance.world.notice import listed
from clearance.world.robot import Robot
from clearance.world.start import started
from clearance.world.trajectory import Trajectory


def with_start(
    entry: schema.RobotEntry, trajectory: Trajectory, robot: Robot, folder: Path, files: InputFiles
) -> tuple[Trajectory, tuple[str, ...]]:
    """The trajectory with a sample at 0 s added, if its entry gives a start; and a note.

    Args:
        folder: against which paths are looked up.

    Raises:
        BadTime: the trajectory begins at 0 s itself. BadInput: no such state, or joints that do not move.
        MissingKey: a joint that moves has no start.
    """
    asked = entry.trajectory
    if asked is None or asked.start_state is None:
        return trajectory, ()
    with at(f"{entry.trajectory_field}.start_state"):
        if trajectory.times[0] <= 0.0:
            raise BadTime(
                f"the trajectory begins at {trajectory.times[0]:g} s itself", valid="no start_state"
            )
        positions = _positions(entry, asked, trajectory, robot, folder, files)
    first = f"the first sample at {trajectory.times[0]:g} s"
    note = f"joints start from rest in start_state at 0 s and go to {first} as between samples"
    return started(trajectory, np.array(positions)), (note,)


def _positions(
    entry: schema.RobotEntry,
    asked: TrajectoryFile,
    trajectory: Trajectory,
    robot: Robot,
    folder: Path,
    files: InputFiles,
) -> list[float]:
    given = asked.start_state
    if isinstance(given, Mapping):
        found = dict(given)
        require_moving_joints(robot, found)
        idle = [name for name in found if name not in trajectory.joint_names]
        if idle:
            raise BadInput(
                f"the trajectory does not move {listed([*map(repr, idle)])}",
                valid=f"{entry.field}.joints says where other joints rest",
            )
    else:
        names = [given] if isinstance(given, str) else list(given or ())
        found = positions_asked(entry, names, robot, folder, files)[1].positions
    missing = [name for name in trajectory.joint_names if name not in found]
    if missing:
        raise MissingKey(
            f"it has no position of {listed([*map(repr, missing)])}",
            valid="a position of each joint that the trajectory moves",
        )
    return [found[name] for name in trajectory.joint_names]

"""Where the joints rest that a trajectory does not move, and where a robot starts before its first sample: by the
values of a case file, then by states of an SRDF or of the robot's own file.

Not for: the states themselves (`srdf`), nor the start in a message (`motion.joint_points`).
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence

import numpy as np

from clearance.errors import BadInput, BadTime, DuplicateName, MissingKey, at
from clearance.formats.files.input_files import InputFiles
from clearance.formats.robot.srdf import (
    NamedStates,
    StatePositions,
    bases_in_states,
    positions_in_states,
    states_known,
)
from clearance.formats.schema import case as schema
from clearance.formats.schema.case import states_of
from clearance.formats.schema.timed import TrajectoryFile
from clearance.world.notice import listed
from clearance.world.quintic import started
from clearance.world.robot import Robot, require_moving_joints
from clearance.world.timing import time_text
from clearance.world.trajectory import Trajectory


def resting_positions(
    entry: schema.RobotEntry, robot: Robot, moved: Sequence[str], files: InputFiles
) -> StatePositions:
    """Positions by joint, those given by value first; and notes on what a state gave.

    Args:
        moved: the joints of the trajectory.

    Raises:
        BadInput: a joint that cannot be set, or is moved. MissingKey: a state that no file names.
    """
    given, field = entry.robot, f"{entry.field}.joints"
    by_value, names = given.joints, states_of(given.joints)
    with at(field):
        require_moving_joints(robot, by_value)
        for name in by_value:
            if name in moved:
                fault = f"joint {name!r} is also a column of the trajectory"
                raise DuplicateName(fault, valid="give it in one place")
    if not names:
        return StatePositions(dict(by_value), ())
    with at(f"{field}.state"):
        shown, (found, notes) = positions_asked(entry, names, robot, files)
    of_states = {name: found[name] for name in found if name not in by_value and name not in moved}
    others = [name for name in found if name not in of_states]
    return StatePositions(
        {**by_value, **of_states}, (*notes, _note(shown, names, of_states, others))
    )


def positions_asked(
    entry: schema.RobotEntry, names: Sequence[str], robot: Robot, files: InputFiles
) -> tuple[str, StatePositions]:
    """The positions that states give, and the file that they are from, as it is shown.

    Raises:
        MissingKey: no file names states. BadInput: no such state, or two that do not agree.
    """
    if not names:
        raise BadInput("[] is given", valid="names of states")
    if entry.robot.srdf is None and not robot.states:
        raise MissingKey(f"state {names[0]!r} is in no file", valid=f"{entry.field}.srdf: the file")
    known = _known(entry, robot, files)
    return known.shown, positions_in_states(known, names, robot)


def bases_asked(entry: schema.RobotEntry, robot: Robot, files: InputFiles) -> dict[str, np.ndarray]:
    """(4, 4) [m] by virtual joint: where the states that the entry takes put the robot's base.

    Raises:
        BadInput: two that do not agree.
    """
    start = entry.trajectory.start_state if entry.trajectory else None
    starts = [start] if isinstance(start, str) else start if isinstance(start, list) else []
    names = [*states_of(entry.robot.joints), *starts]
    if not names:
        return {}
    with at(entry.field):
        return bases_in_states(_known(entry, robot, files), names, robot)


def _known(entry: schema.RobotEntry, robot: Robot, files: InputFiles) -> NamedStates:
    given = entry.robot
    srdf = None if given.srdf is None else files.resolved(given.srdf)
    return states_known(srdf, robot, files.resolved(given.urdf), files)


def _note(
    shown: str, names: Sequence[str], of_states: dict[str, float], others: Sequence[str]
) -> str:
    rest = (
        listed([f"{name} {position:g}" for name, position in of_states.items()], 12) or "no joint"
    )
    text = f"{shown}: by state {listed([*map(repr, names)])} rest {rest}"
    return text + (
        f"; the case or the trajectory says more of {listed(others, 8)}" if others else ""
    )


def with_start(
    entry: schema.RobotEntry, trajectory: Trajectory, robot: Robot, files: InputFiles
) -> tuple[Trajectory, tuple[str, ...]]:
    """The trajectory with a sample at 0 s added, if its entry gives a start; and a note.

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
                f"the trajectory begins at {time_text(trajectory.times[0])} s itself",
                valid="no start_state",
            )
        positions = _positions(entry, asked, trajectory, robot, files)
    first = f"the first sample at {time_text(trajectory.times[0])} s"
    note = f"joints start from rest in start_state at 0 s and go to {first} as between samples"
    return started(trajectory, np.array(positions)), (note,)


def _positions(
    entry: schema.RobotEntry,
    asked: TrajectoryFile,
    trajectory: Trajectory,
    robot: Robot,
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
        found = positions_asked(entry, names, robot, files)[1].positions
    missing = [name for name in trajectory.joint_names if name not in found]
    if missing:
        raise MissingKey(
            f"it has no position of {listed([*map(repr, missing)])}",
            valid="a position of each joint that the trajectory moves",
        )
    return [found[name] for name in trajectory.joint_names]

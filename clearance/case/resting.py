"""Where the joints rest that a trajectory does not move: by the values of a case file, then by states of an SRDF
or of the robot's own file.

Not for: the states themselves (`srdf_states`).
"""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path

from clearance.case.motion_names import check_not_given_twice
from clearance.errors import MissingKey, at
from clearance.formats.files.input_files import InputFiles, resolved
from clearance.formats.robot.srdf_states import StatePositions, positions_in_states, states_known
from clearance.formats.schema import case as schema
from clearance.formats.schema.joints import states_of
from clearance.world.moving_joints import require_moving_joints
from clearance.world.notice import listed
from clearance.world.robot import Robot


def resting_positions(
    entry: schema.RobotEntry, robot: Robot, moved: Sequence[str], folder: Path, files: InputFiles
) -> StatePositions:
    """Positions by joint, those given by value first; and notes on what a state gave.

    Args:
        moved: the joints of the trajectory. folder: against which the SRDF's path is looked up.

    Raises:
        BadInput: a joint that cannot be set, or is moved. MissingKey: a state that no file names.
    """
    given, field = entry.robot, f"{entry.field}.joints"
    by_value, names = given.joints, states_of(given.joints)
    with at(field):
        require_moving_joints(robot, by_value)
        check_not_given_twice(by_value, moved)
    if not names:
        return StatePositions(dict(by_value), ())
    with at(f"{field}.state"):
        shown, (found, notes) = positions_asked(entry, names, robot, folder, files)
    taken = {name: found[name] for name in found if name not in by_value and name not in moved}
    others = [name for name in found if name not in taken]
    return StatePositions({**by_value, **taken}, (*notes, _note(shown, names, taken, others)))


def positions_asked(
    entry: schema.RobotEntry, names: Sequence[str], robot: Robot, folder: Path, files: InputFiles
) -> tuple[str, StatePositions]:
    """The positions that states give, and the file that they are from, as it is shown.

    Raises:
        MissingKey: no file names states. BadInput: no such state, or two that do not agree.
    """
    given = entry.robot
    if given.srdf is None and not robot.states:
        raise MissingKey(f"state {names[0]!r} is in no file", valid=f"{entry.field}.srdf: the file")
    srdf = None if given.srdf is None else resolved(given.srdf, folder)
    known = states_known(srdf, robot, resolved(given.urdf, folder), files)
    return known.shown, positions_in_states(known, names, robot)


def _note(shown: str, names: Sequence[str], taken: dict[str, float], others: Sequence[str]) -> str:
    rest = listed([f"{name} {position:g}" for name, position in taken.items()], 12) or "no joint"
    told = f"{shown}: by state {listed([*map(repr, names)])} rest {rest}"
    return told + (
        f"; the case or the trajectory says more of {listed(others, 8)}" if others else ""
    )

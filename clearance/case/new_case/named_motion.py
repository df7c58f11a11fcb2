"""A motion between named states, for who has no trajectory yet. Not for: planning one."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from clearance.errors import BadInput
from clearance.formats.robot.srdf_states import NamedStates, positions_in_states
from clearance.world.robot import Robot
from clearance.world.trajectory import Trajectory

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
    rows = np.array([[_held(name, i, found) for name in names] for i in range(len(found))])
    return Trajectory(PERIOD * np.arange(len(states)), tuple(names), rows)


def _held(name: str, i_state: int, found: Sequence[dict[str, float]]) -> float:
    """Where a joint is: by this state, else by the last before it, else by the first that says so."""
    before = [one[name] for one in found[: i_state + 1] if name in one]
    return before[-1] if before else next(one[name] for one in found if name in one)

"""The direction of a continuous joint in a step of more than half a turn: as written, or the shortest way.

A planner that interpolates angles goes the shortest way, a controller's spline may follow the numbers; what was
recorded in (-pi, pi] went the shortest way. Half a turn, down to rounding, is as long either way and goes as
written.

Source: MoveIt 2, RevoluteJointModel::interpolate. Not for: joints with limits, which cannot choose.
"""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import replace
from typing import NamedTuple

import numpy as np

from clearance.world.quintic import with_accelerations
from clearance.world.robot import JointKind, Robot
from clearance.world.trajectory import SHORTEST, Trajectory

ROUNDING = 1e-9
"""[rad] A step that is longer than half a turn by less than this is half a turn."""


class LongStep(NamedTuple):
    """The longest of the steps by more than half a turn of a continuous joint.

    Attributes:
        start, end: [s] in the table's time. before, after: [rad] as written. n_steps: how many there are.
    """

    joint: str
    start: float
    end: float
    before: float
    after: float
    n_steps: int

    @property
    def shortest(self) -> float:
        """[rad] how far it turns the shortest way."""
        step = self.after - self.before
        return float(step - 2.0 * np.pi * _whole_turns(np.array([step]))[0])


def wrapping_joints(robot: Robot) -> frozenset[str]:
    """The joints that a trajectory can move and that can go either way round."""
    return frozenset(j.name for j in robot.moving_joints if j.kind is JointKind.CONTINUOUS)


def whole_turns(positions: np.ndarray) -> np.ndarray:
    """(n,) whole turns to subtract from each position [rad], so that no step is more than half a turn."""
    return np.concatenate(([0.0], np.cumsum(_whole_turns(np.diff(positions)))))


def long_steps(robot: Robot, asked: Trajectory) -> list[LongStep]:
    """Those of the joints that a trajectory moves."""
    return [_longest(asked, i, steps) for i, steps in _columns(robot, asked)]


def meant(robot: Robot, asked: Trajectory) -> Trajectory:
    """The trajectory with its continuous joints going the shortest way, if `wrap` says so; else unchanged.

    Exactness: whole turns are subtracted, each to the rounding of a position.
    """
    if asked.wrap != SHORTEST:
        return asked
    own = asked.written
    positions = own.positions.copy()
    for i, _ in _columns(robot, asked):
        positions[:, i] -= 2.0 * np.pi * whole_turns(own.positions[:, i])
    if np.array_equal(positions, own.positions):
        return asked
    extents = np.stack([own.positions.min(axis=0), own.positions.max(axis=0)])
    asked = replace(asked, given_extents=extents)
    if isinstance(own, Trajectory):
        return replace(asked, positions=positions)
    plain = replace(asked, times=own.times, positions=positions, velocities=own.velocities)
    return with_accelerations(plain, own.accelerations)


def _columns(robot: Robot, asked: Trajectory) -> Iterator[tuple[int, np.ndarray]]:
    """The column of each continuous joint with steps of more than half a turn, and these steps."""
    turning = wrapping_joints(robot)
    for i, name in enumerate(asked.joint_names):
        if name in turning:
            steps = np.flatnonzero(_whole_turns(np.diff(asked.written.positions[:, i])))
            if len(steps):
                yield i, steps


def _whole_turns(steps: np.ndarray) -> np.ndarray:
    """(n,) whole turns to subtract from each of some steps [rad], so that half a turn or less remains."""
    beyond = (np.abs(steps) - ROUNDING) / (2.0 * np.pi) - 0.5
    return np.sign(steps) * np.maximum(np.ceil(beyond), 0.0)


def _longest(asked: Trajectory, i: int, steps: np.ndarray) -> LongStep:
    own = asked.written.positions[:, i]
    worst = int(steps[np.argmax(np.abs(np.diff(own))[steps])])
    ends = slice(worst, worst + 2)
    start, end = asked.written.times[ends].tolist()
    before, after = own[ends].tolist()
    return LongStep(asked.joint_names[i], start, end, before, after, len(steps))

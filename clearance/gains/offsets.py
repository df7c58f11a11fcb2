"""A change of path: smooth offsets of a robot's joints over its table, and the limits that they keep.

They are as large as the greatest offset of any joint at any sample, on cubics of what encloses them between
samples too, slides counted by `SLIDE`. Not for: what is sought (`path_change`).
"""

from __future__ import annotations

from dataclasses import dataclass, field, replace
from functools import cached_property
from typing import Any

import numpy as np

from clearance.errors import BadChange
from clearance.formats.motion.trajectory_writer import untold
from clearance.gains.basis import Basis
from clearance.gains.grasp import Grasps
from clearance.gains.joint_rows import joint_rows
from clearance.gains.programme import Inequalities
from clearance.gains.tool_poses import ToolKeep, ToolPoses
from clearance.simulate.answers.approaches import Approach
from clearance.simulate.answers.point_motion import has_joint_between, motion_of_frame
from clearance.simulate.answers.transfers import Transfers
from clearance.world.case import Case
from clearance.world.forest import link_poses_at
from clearance.world.knots import knots_of
from clearance.world.pairs import Pair
from clearance.world.phase import Phase
from clearance.world.placed_robot import PlacedRobot
from clearance.world.timeline import Timeline
from clearance.world.tool import tool_of

SLIDE = 2.0
"""[rad/m] A slide of half a metre counts as one radian: what a turn moves at the reach of a small arm."""

FIRST_REACH = 0.05
"""[rad] How far the first step may go at each spline."""

ARM = 0.5
"""[m] How far what comes near is from the joints, to guess what a step may bring near."""

PER_INTERVAL = 6
"""Samples of each interval of the splines at which the greatest offset is sought."""


@dataclass(frozen=True, eq=False)
class JointOffsets:
    """Offsets of a robot's joints: for each joint that its table names, a spline over the table's times.

    Attributes:
        i_robot: which robot. basis: the splines.
        tool_keeps: moments at which the tool stays about where it is. tool: its link; None for the usual one.
    """

    case: Case
    i_robot: int
    basis: Basis
    tool_keeps: tuple[ToolKeep, ...] = ()
    tool: str | None = None
    weights: np.ndarray = field(init=False)

    def __post_init__(self) -> None:
        kinds = {joint.name: joint.kind for joint in self.placed.robot.moving_joints}
        named = (kinds[name] for name in self.placed.given_trajectory.joint_names)
        slides = np.array([SLIDE if kind == "prismatic" else 1.0 for kind in named])
        object.__setattr__(self, "weights", slides)

    @cached_property
    def transfers(self) -> Transfers:
        """The parts that it hands over elsewhere."""
        return Transfers(self.case, (False, self.i_robot))

    @property
    def placed(self) -> PlacedRobot:
        """The robot as it was."""
        return self.case.robots[self.i_robot]

    @property
    def n_joints(self) -> int:
        """Of the table."""
        return len(self.weights)

    @property
    def n_splines(self) -> int:
        """Of each joint."""
        return len(self.basis.free)

    @cached_property
    def first_reach(self) -> np.ndarray:
        return np.repeat(FIRST_REACH / self.weights, self.n_splines)

    @cached_property
    def _samples(self) -> np.ndarray:
        return self.basis.at(self.placed.given_trajectory.times)

    @cached_property
    def _sized(self) -> np.ndarray:
        """(r, m) what no offset exceeds: samples and, on cubics, the Bernstein coefficients between."""
        asked, samples = self.placed.given_trajectory, self._samples
        if asked.velocities is None:
            return samples
        thirds = np.diff(asked.times)[:, None] / 3.0
        rates = self.basis.at(asked.times, 1)
        between = (samples[:-1] + thirds * rates[:-1], samples[1:] - thirds * rates[1:])
        rows = np.stack([samples[:-1], *between], axis=1)
        return np.concatenate([*rows, samples[-1:]])

    @cached_property
    def few_samples(self) -> np.ndarray:
        """The same at some of the rows, as many as the splines can tell apart."""
        n_rows, wanted = len(self._sized), PER_INTERVAL * self.basis.n_intervals + 1
        few = np.unique(np.linspace(0, n_rows - 1, min(n_rows, wanted)).astype(int))
        return self._sized[few]

    def offsets(self, x: np.ndarray) -> np.ndarray:
        """(n, k) [rad or m] of the samples of the table."""
        return np.asarray(self._samples @ x.reshape(self.n_joints, -1).T)

    def placed_of(self, x: np.ndarray) -> PlacedRobot:
        """The robot with the path that is changed."""
        asked = self.placed.given_trajectory
        velocities = asked.velocities
        if velocities is not None:
            rates = self.basis.at(asked.times, 1)
            velocities = velocities + rates @ x.reshape(self.n_joints, -1).T
        positions = asked.positions + self.offsets(x)
        changed = replace(
            asked, positions=positions, velocities=velocities, path_error=0.0, points=None
        )  # which is what a table of its samples says
        return replace(self.placed, trajectory=changed)

    def moves(self, case: Case, pair: Pair) -> bool:
        by_joint = has_joint_between(case, pair, self.columns)
        return by_joint or self.transfers.has_of(case, pair)

    def gradient(self, approach: Approach, timeline: Timeline | None = None) -> np.ndarray | None:
        if timeline is not None and self.transfers.has(approach):
            size = self.n_joints * self.n_splines
            return Grasps(timeline, self._of_frame, size).gradient(approach)
        if not has_joint_between(approach.case, approach.pair, self.columns):
            return None
        by_joint = approach.by_columns()[:, self.columns]
        splines = self._between_samples(self.placed.timing.table_times(approach.times))
        return np.asarray((by_joint[:, :, None] * splines[:, None, :]).reshape(len(splines), -1))

    def _of_frame(
        self, phase: Phase, frame: int, steps: np.ndarray, points: np.ndarray
    ) -> np.ndarray:
        """(k, m, 3) how points that a link carries move with the variables."""
        poses = link_poses_at(phase.case, phase.motions, steps)
        by_joint = motion_of_frame(phase.case, poses, frame, points)[:, self.columns]
        splines = self._between_samples(self.placed.timing.table_times(phase.times[steps]))
        moved = by_joint[:, :, None, :] * splines[:, None, :, None]
        return np.asarray(moved.reshape(len(points), -1, 3))

    def _between_samples(self, times: np.ndarray) -> np.ndarray:
        """(k, m) what a spline adds at times of the table (k,) [s], on the lines or cubics between its samples."""
        asked = self.placed.given_trajectory
        rates = None if asked.velocities is None else self.basis.at(asked.times, 1)
        return knots_of(asked.times, self._samples, rates).values_at(times)

    @cached_property
    def columns(self) -> list[int]:
        """The column of the case's forest of each joint of the table."""
        return columns_of(self.case, self.i_robot)

    def size(self, x: np.ndarray) -> float:
        offsets = self._sized @ x.reshape(self.n_joints, -1).T
        return float((np.abs(offsets) * self.weights).max(initial=0.0))

    @cached_property
    def tool_poses(self) -> ToolPoses | None:
        """What is kept of the tool's poses; None for nothing."""
        if not self.tool_keeps:
            return None
        placed, asked = self.placed, self.placed.given_trajectory
        times = np.array([one.time for one in self.tool_keeps])
        own = placed.timing.table_times(times)
        positions = knots_of(asked.times, asked.positions, asked.velocities).values_at(own)
        tool = tool_of(placed, self.tool)
        return ToolPoses(tool, self.tool_keeps, positions, self._between_samples(own))

    def swing(self, reach: np.ndarray) -> float:
        farthest = reach.reshape(self.n_joints, -1).max(axis=1, initial=0.0)
        return ARM * float((farthest * self.weights).max())

    @property
    def sized(self) -> Any:
        """(r, m) sparse: what no offset exceeds, by its weight, of some samples."""
        from scipy.sparse import csr_array, kron

        return kron(csr_array(np.diag(self.weights)), csr_array(self.few_samples))

    @property
    def weight_of_each(self) -> np.ndarray:
        """(m,) of each variable."""
        return np.repeat(self.weights, self.n_splines)

    @cached_property
    def inequalities(self) -> Inequalities:
        """The limits of joints, of their speeds and of their accelerations, at the samples and between."""
        return joint_rows(self.placed, self.basis)


def joint_offsets(
    case: Case,
    i_robot: int,
    n_intervals: int,
    fixed: tuple[tuple[float, float], ...],
    tool_keeps: tuple[ToolKeep, ...] = (),
    tool: str | None = None,
) -> JointOffsets:
    """Offsets of a robot's joints, 0 in some windows of its table's times [s].

    Args:
        tool_keeps, tool: as of `JointOffsets`.

    Raises:
        BadInput: it has no table, one that it goes through again and again, or one with holes.
    """
    placed = case.robots[i_robot]
    require_path(placed)
    if placed.timing.after == "loop":
        raise BadChange(
            f"robot {placed.robot.name!r} goes through its path again and again",
            valid="a path that ends",
        )
    return JointOffsets(
        case, i_robot, Basis(placed.given_trajectory.times, n_intervals, fixed), tool_keeps, tool
    )


def require_path(placed: PlacedRobot) -> None:
    """Nothing, if a robot has a path that can be written otherwise.

    Raises:
        BadInput: it has none, or one of which no table can say all, as a recording with holes.
    """
    if placed.trajectory is None or placed.trajectory.n_steps < 2:
        raise BadChange(f"robot {placed.robot.name!r} has no path", valid="a robot that moves")
    if placed.trajectory.holes:
        raise BadChange(
            f"the recording of robot {placed.robot.name!r} has holes",
            valid="a path that is known everywhere",
        )
    for line in untold(placed.trajectory, "trajectory.csv"):
        raise BadChange(
            f"robot {placed.robot.name!r}: {line}",
            valid="kind timing, obstacle or base, or mend it",
        )


def columns_of(case: Case, i_robot: int) -> list[int]:
    """The column of the case's forest of each joint of a robot's table."""
    before = sum(len(one.robot.moving_joints) for one in case.robots[:i_robot])
    names = [joint.name for joint in case.robots[i_robot].robot.moving_joints]
    return [
        before + names.index(name) for name in case.robots[i_robot].given_trajectory.joint_names
    ]

"""The links from a root that stands down to one that carries a body, and where they are at any instant of a phase.

Whatever moves is in it: a robot's own joints, those of what the robot stands on, and the slides and the ball joint
of an obstacle that moves by itself. Instants are counted in the phase's steps.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import NamedTuple

import numpy as np
from scipy.spatial.transform import Rotation

from clearance.kernels.motion.kinematics import BALL, NO_COLUMN, NO_PARENT, Links
from clearance.world.case import Case
from clearance.world.cubic import Cubics, cubics_of, position_on
from clearance.world.forest import carried_by, forest_of
from clearance.world.kinematics import poses_by_link, rates_by_link, values_by_link
from clearance.world.motion import Motion
from clearance.world.pose_table import PoseTable
from clearance.world.slerp import arcs_between, slerp


class Course(NamedTuple):
    """The joints above the links of a chain about the middles of n intervals, at middle + s half, |s| <= 1.

    position(s) = position + speed s + bend s^2 / 2 + jerk s^3 / 6; linear motion has neither bend nor jerk. A ball
    joint turns from one step to the next about one axis at constant speed; its position is the angle since then.

    Attributes:
        position, speed, bend, jerk: (n, links) each [rad] or [m].
        fixed: of each link (4, 4) `parent_from_joint` [m]; of a ball joint (n, 4, 4), as it is at the step before.
        axes: of each link (3,) the joint's unit axis; of a ball joint (n, 3).
    """

    position: np.ndarray
    speed: np.ndarray
    bend: np.ndarray
    jerk: np.ndarray
    fixed: tuple[np.ndarray, ...]
    axes: tuple[np.ndarray, ...]


@dataclass(frozen=True, eq=False)
class Chain:
    """Links behind one another, and what moves them in a phase.

    Attributes:
        links: root first, each on the one before; their columns are those of the case's forest.
        case, motions: of the phase.
    """

    links: Links
    case: Case
    motions: tuple[Motion, ...]

    @property
    def n_links(self) -> int:
        """How many there are."""
        return len(self.links.parents)

    @property
    def n_steps(self) -> int:
        """Steps of the phase."""
        return self.motions[0].n_steps

    def poses_at(self, instant: np.ndarray) -> np.ndarray:
        """(k, links, 4, 4) `world_from_link` [m] at instants (k,)."""
        return poses_by_link(self.links, self.columns_at(instant))

    def columns_at(self, instant: np.ndarray) -> np.ndarray:
        """(k, columns) the positions of all columns of the forest at instants (k,)."""
        moving = [columns_at(o.moves, instant) for o in self.case.obstacles if o.moves is not None]
        robots = [positions_at(motion, instant) for motion in self.motions]
        return (
            np.concatenate([*robots, *moving], axis=1) if len(robots) > 1 or moving else robots[0]
        )

    def course(self, low: np.ndarray, high: np.ndarray) -> Course:
        """The motion about the middles of intervals from `low` to `high` (n,), none across a step."""
        middle, half = 0.5 * (low + high), 0.5 * (high - low)
        position, start, end = (
            values_by_link(self.links, self.columns_at(at)) for at in (middle, low, high)
        )
        speed, bend, jerk = 0.5 * (end - start), np.zeros_like(position), np.zeros_like(position)
        columns, rates = self._rates(low, high)
        cubic = np.isin(self.links.columns, columns) & (self.links.kinds != BALL)
        for found, rate in zip((speed, bend, jerk), rates, strict=True):
            found[:, cubic] = rates_by_link(self.links, rate)[:, cubic]
        fixed, axes = list(self.links.parent_from_joint), list(self.links.axes)
        for i in np.flatnonzero(self.links.kinds == BALL).tolist():
            step, share = located(middle, self.n_steps)
            fixed[i], axes[i], angle = self._turn(i, step)
            position[:, i], speed[:, i] = share[:, 0] * angle, half * angle
        return Course(position, speed, bend, jerk, tuple(fixed), tuple(axes))

    def _rates(self, low: np.ndarray, high: np.ndarray) -> tuple[list[int], list[np.ndarray]]:
        """Which columns go on cubics, and speed, bend and jerk (n, columns) of all, zero where they do not."""
        widths = [motion.positions.shape[1] for motion in self.motions]
        starts = np.cumsum([0, *widths]).tolist()
        n_moving = sum(obstacle.moves is not None for obstacle in self.case.obstacles)
        rates = [np.zeros((len(low), starts[-1] + 7 * n_moving)) for _ in range(3)]
        columns: list[int] = []
        for motion, start, width in zip(self.motions, starts, widths, strict=False):
            if motion.velocities is not None and motion.n_steps > 1:
                columns += range(start, start + width)
                for all_rates, own in zip(rates, rates_about(motion, low, high), strict=True):
                    all_rates[:, start : start + width] = own
        return columns, rates

    def _turn(self, i: int, step: np.ndarray) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
        """Turns of a ball joint from some steps to the next: (n, 4, 4) fixed part, (n, 3) axis, (n,) angle."""
        first = int(self.links.columns[i])
        ahead = np.minimum(step + 1, self.n_steps - 1)
        before, after = (
            self.columns_at(at.astype(float))[:, first : first + 4] for at in (step, ahead)
        )
        arcs = arcs_between(before, after)
        fixed = np.tile(np.eye(4), (len(step), 1, 1))
        fixed[:, :3, :3] = Rotation.from_quat(before).as_matrix()
        return self.links.parent_from_joint[i] @ fixed, arcs[:, :3], arcs[:, 3]


def chain_of(case: Case, motions: Sequence[Motion], link: int) -> Chain:
    """The chain down to a link of the case's forest."""
    forest = forest_of(case)
    path = list(carried_by(forest, link))[::-1]
    own = Links(*(column[path] for column in forest.links))
    parents = np.arange(-1, len(path) - 1)
    assert parents[0] == NO_PARENT and own.columns[0] == NO_COLUMN, "a root stands"
    return Chain(own._replace(parents=parents), case, tuple(motions))


def positions_at(motion: Motion, instant: np.ndarray) -> np.ndarray:
    """(k, joints) positions at instants (k,), in steps; the steps' own to the last bit."""
    step, share = located(instant, motion.n_steps)
    ahead = np.minimum(step + 1, motion.n_steps - 1)
    if motion.velocities is None or motion.n_steps == 1:
        return motion.positions[step] * (1.0 - share) + motion.positions[ahead] * share
    found = position_on(_cubics(motion, motion.velocities, step), share)
    return np.where(share == 1.0, motion.positions[ahead], found)


def columns_at(table: PoseTable, instant: np.ndarray) -> np.ndarray:
    """(k, 7) position [m] and quaternion of an obstacle at instants (k,), in steps; the steps' own likewise."""
    step, share = located(instant, len(table))
    ahead = np.minimum(step + 1, len(table) - 1)
    places = table.positions[step] * (1.0 - share) + table.positions[ahead] * share
    turned = slerp(table.quaternions[step], table.quaternions[ahead], share[:, 0])
    return np.concatenate([places, turned], axis=1)


def rates_about(
    motion: Motion, low: np.ndarray, high: np.ndarray
) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """Speed, bend and jerk (n, joints) on the cubics, as in `chain.Course`; no interval goes across a step."""
    middle, half = 0.5 * (low + high), 0.5 * (high - low)[:, None]
    step, share = located(middle, motion.n_steps)
    assert motion.velocities is not None
    cubic, rest = _cubics(motion, motion.velocities, step), 1.0 - share
    slope = (
        cubic.step + rest * (1.0 - 3.0 * share) * cubic.e0 + share * (3.0 * share - 2.0) * cubic.e1
    )
    curve = 2.0 * ((3.0 * share - 2.0) * cubic.e0 + (3.0 * share - 1.0) * cubic.e1)
    return half * slope, half**2 * curve, half**3 * 6.0 * (cubic.e0 + cubic.e1)


def located(instant: np.ndarray, n_steps: int) -> tuple[np.ndarray, np.ndarray]:
    """The step before each instant (the last interval's for the end), and the share (k, 1) run through."""
    step = np.clip(np.floor(instant).astype(int), 0, max(0, n_steps - 2))
    return step, (instant - step)[:, None]


def _cubics(motion: Motion, velocities: np.ndarray, step: np.ndarray) -> Cubics:
    found = cubics_of(motion.times, motion.positions, velocities)
    return Cubics(*(part[step] for part in found))

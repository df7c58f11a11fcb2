"""A change of place of a robot's base with the path of its tool kept in the world: its joints make up for the
base.

At each sample the joints are solved for from where they were; where they cannot follow the change is none. Not
for: how far the tool is off between samples (`tool_path_error`), limits of joints (`tool_limits`).
"""

from __future__ import annotations

from dataclasses import dataclass, field, fields, replace
from functools import cached_property

import numpy as np

from clearance.errors import BadChange
from clearance.gains.offsets import columns_of, require_path
from clearance.gains.shift import Shift
from clearance.gains.shortfalls import Rows
from clearance.gains.tool_limits import limit_rows
from clearance.gains.turn import ARM
from clearance.geometry.pose import inverse
from clearance.programs.inverse import MOST_FROM_AFAR, joints_at, least_motion
from clearance.simulate.answers.approaches import Approach
from clearance.world.case import Case
from clearance.world.forest import WORLD, forest_of
from clearance.world.knots import knots_of
from clearance.world.pairs import BodyIndex, Pair
from clearance.world.placed_robot import PlacedRobot
from clearance.world.timeline import Timeline
from clearance.world.tool import Tool, tool_of
from clearance.world.trajectory import Trajectory

STILL = 1e-7
"""[m per m] What joints that follow move bodies by less, and what they miss of a pose by less, is rounding."""

UNREACHED = 10.0
"""[m] What counts as missing where a pose cannot be reached: more than any clearance makes good."""


REACHED = 1e-9
"""[m] and [rad]: a pose that is this near is reached."""


@dataclass(frozen=True, eq=False)
class FollowedPath:
    """The joints with the base at another place.

    Attributes:
        followed: (n, k, m) what each joint moves by with each variable, at the samples.
        missed: (n, 6, m) what the tool then moves by all the same. residual: of the poses, at worst.
    """

    trajectory: Trajectory
    followed: np.ndarray
    missed: np.ndarray
    residual: float


@dataclass(frozen=True, eq=False)
class ToolPathKept(Shift):
    """A shift of a base, and a turn, in which the tool goes the same way through the world.

    Attributes:
        tool: what is kept.
    """

    tool: Tool = field(kw_only=True)
    _known: dict[bytes, FollowedPath] = field(default_factory=dict, kw_only=True)

    @property
    def i_robot(self) -> int:
        """Which robot."""
        return self.thing[1]

    @property
    def placed(self) -> PlacedRobot:
        """The robot as it was."""
        return self.case.robots[self.i_robot]

    def swing(self, reach: np.ndarray) -> float:
        return 2.0 * super().swing(reach)

    def case_of(self, x: np.ndarray) -> Case:
        moved = super().case_of(x)
        robots = list(moved.robots)
        solved = self.solved(self.pose_in(moved))
        robots[self.i_robot] = replace(robots[self.i_robot], trajectory=solved.trajectory)
        return replace(moved, robots=tuple(robots))

    def solved(self, base: np.ndarray) -> FollowedPath:
        """What the joints come to with the base at a pose (4, 4) [m]."""
        key = base.tobytes()
        if key not in self._known:
            self._known[key] = self._solution(base)
        return self._known[key]

    def _solution(self, base: np.ndarray) -> FollowedPath:
        asked, residual, velocities = self.placed.given_trajectory, 0.0, None
        if not np.array_equal(base, self.placed.world_from_base):
            wanted = inverse(base) @ self.world_from_tool
            at, missed = joints_at(self.tool, wanted, asked.positions, None, MOST_FROM_AFAR)
            residual = float(missed.max())
            velocities = asked.velocities
            asked = replace(asked, positions=at, path_error=0.0, points=None)
        poses, rates = self.tool.poses_and_rates(asked.positions)
        rates = _seen_from_world(rates, base)
        if velocities is not None:
            more = self._twists - np.einsum("nij,nj->ni", rates, velocities)
            more = least_motion(rates, more[:, :, None])[:, :, 0]
            asked = replace(asked, velocities=velocities + more)
        by_base = self._by_base(base @ poses, base)
        followed = -least_motion(rates, by_base)
        return FollowedPath(asked, followed, by_base + rates @ followed, residual)

    @cached_property
    def world_from_tool(self) -> np.ndarray:
        """(n, 4, 4) [m] what is kept."""
        placed = self.placed
        return np.asarray(
            placed.world_from_base @ self.tool.poses(placed.given_trajectory.positions)
        )

    @cached_property
    def _twists(self) -> np.ndarray:
        """(n, 6) how fast the tool moves and turns at the samples, in the table's time, world."""
        placed, asked = self.placed, self.placed.given_trajectory
        assert asked.velocities is not None
        rates = _seen_from_world(
            self.tool.poses_and_rates(asked.positions)[1], placed.world_from_base
        )
        return np.einsum("nij,nj->ni", rates, asked.velocities)

    def _by_base(self, world_from_tool: np.ndarray, base: np.ndarray) -> np.ndarray:
        """(n, 6, m) how the tool moves and turns with the base, its joints as they are."""
        by_unit = np.zeros((len(world_from_tool), 6, self.size_of_x))
        by_unit[:, :3, :3] = np.eye(3)
        if self.pivot is not None:
            by_unit[:, :3, 3] = self.pivot.by_unit(world_from_tool[:, :3, 3], base)
            by_unit[:, 3:, 3] = self.pivot.turn.direction / ARM
        return by_unit

    def moves(self, case: Case, pair: Pair) -> bool:
        stay = all(self._stays(case, body) for body in pair)
        return not stay or self.transfers.has_of(case, pair)

    def gradient(self, approach: Approach, timeline: Timeline | None = None) -> np.ndarray | None:
        if all(self._stays(approach.case, body) for body in approach.pair):
            return None
        solved = self.solved(self.pose_in(approach.case))
        own = self.placed.timing.table_times(approach.times)
        n_samples, *each = solved.followed.shape
        flat = solved.followed.reshape(n_samples, -1)
        between = knots_of(self.placed.given_trajectory.times, flat).values_at(own)
        followed = between.reshape(len(own), *each)
        found = np.einsum("kj,kjm->km", self._by_joint(approach), followed)
        by_base = super().gradient(approach)
        if by_base is not None:
            found += by_base
        found[np.abs(found) < STILL] = 0.0
        return found

    def _by_joint(self, approach: Approach) -> np.ndarray:
        return approach.by_columns()[:, columns_of(self.case, self.i_robot)]

    def _stays(self, case: Case, body: BodyIndex) -> bool:
        """True if a body does not move with the base, or is fixed to the tool."""
        if not self.moved(case, body):
            return True
        forest = forest_of(case)
        tool, frame = forest.robot_starts[self.i_robot] + self.tool.link, body.frame_in(case)
        return frame != WORLD and forest.rigid_part(frame) == forest.rigid_part(tool)

    def is_of_place(self, approach: Approach) -> bool:
        """True if the base alone moves the bodies of an approach against each other, and no joint of its path."""
        return super().gradient(approach) is not None and not self._by_joint(approach).any()

    def other_rows(self, x: np.ndarray, beyond: float) -> Rows | None:
        solved = self.solved(self.pose_in(super().case_of(x)))
        changed = replace(self.placed, trajectory=solved.trajectory)
        parts = [limit_rows(self.placed, changed, solved.followed, beyond), _same_poses(solved)]
        if solved.residual > REACHED:
            parts.append(Rows(np.array([UNREACHED + solved.residual]), np.zeros((1, len(x)))))
        missing, gradients = zip(*parts, strict=True)
        return Rows(np.concatenate(missing), np.concatenate(gradients))


def _same_poses(solved: FollowedPath) -> Rows:
    """Rows that leave out the directions in which the joints cannot make up for the base."""
    flat = solved.missed.reshape(-1, solved.missed.shape[2])
    _, sizes, directions = np.linalg.svd(flat, full_matrices=False)
    barred = directions[sizes > STILL * np.sqrt(len(flat))]
    return Rows(np.full(2 * len(barred), -1e-12), np.concatenate([barred, -barred]))


def _seen_from_world(rates: np.ndarray, base: np.ndarray) -> np.ndarray:
    """(n, 6, k) rates of a tool seen from the root, in the axes of the world."""
    turned = np.zeros((6, 6))
    turned[:3, :3] = turned[3:, 3:] = base[:3, :3]
    return np.asarray(turned @ rates)


def tool_path_kept(shift: Shift, name: str | None) -> ToolPathKept:
    """The shift of a base with the path of a tool kept.

    Raises:
        BadInput: the robot has no path, one with holes, or joints that cannot make up for any change of its base.
            UnknownLink: no such tool, with the nearest name.
    """
    placed = shift.case.robots[shift.thing[1]]
    require_path(placed)
    known = {one.name: getattr(shift, one.name) for one in fields(Shift)}
    found = ToolPathKept(**known, tool=tool_of(placed, name))
    free = found.box.low < found.box.high
    barred = _same_poses(found.solved(placed.world_from_base)).gradients
    if np.linalg.matrix_rank(np.vstack([barred, np.eye(len(free))[~free]]), 1e-6) == len(free):
        raise BadChange(
            f"the joints of robot {placed.robot.name!r} cannot keep the path of {found.tool.name!r} wherever its "
            "base is moved",
            valid="a tool path that is moved, or an arm of six joints or more",
        )
    return found

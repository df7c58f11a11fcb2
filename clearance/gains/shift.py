"""A change of place: an obstacle or a robot's base is moved along x, y and z of the world, and turned if that is
allowed.

A change is as large as the root of the sum of the squares of its shift and of its angle, half a metre for one rad.

Not for: by how much (`search`).
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, replace
from functools import cached_property

import numpy as np

from clearance.errors import BadChange, UnknownObstacle, nearest_name
from clearance.gains.grasp import Grasps
from clearance.gains.programme import Box, least_norm
from clearance.gains.shortfalls import Rows
from clearance.gains.turn import ARM, Pivot, Turn
from clearance.geometry.pose import inverse, pose_from_quaternion
from clearance.simulate.answers.approaches import Approach
from clearance.simulate.answers.point_motion import Thing, owners_of
from clearance.simulate.answers.transfers import Transfers
from clearance.world.body import Obstacle
from clearance.world.case import Case
from clearance.world.extents import reach_of
from clearance.world.forest import carried_by, forest_of
from clearance.world.knots import knots_of_poses, looped
from clearance.world.pairs import BodyIndex, Pair
from clearance.world.phase import Phase
from clearance.world.pose_table import PoseTable
from clearance.world.timeline import Timeline

FIRST_REACH = 0.02
"""[m] How far the first step may go along each axis."""


@dataclass(frozen=True, eq=False)
class Shift:
    """Something that is moved along x, y and z, and turned.

    Attributes:
        thing: what it is. place: the case with it moved by (3,) [m], or (4,) with its angle times `turn.ARM`.
        pose_in: (4, 4) where it stands in a case [m]. box: [m] how far it may be moved.
        radius: [m] from its origin to the farthest that moves with it, roughly.
        pivot: None where it is not turned. inequalities: kept beside the box.
        price: at first, of a metre of clearance that is missing, beside the size of a change.
        bends: whether a motion between two steps may be changed otherwise than they are.
    """

    case: Case
    thing: Thing
    place: Callable[[Case, np.ndarray], Case]
    pose_in: Callable[[Case], np.ndarray]
    box: Box
    radius: float
    pivot: Pivot | None = None
    price: float = 30.0
    inequalities: None = None
    bends: bool = False

    @cached_property
    def transfers(self) -> Transfers:
        """The parts that it hands over elsewhere."""
        return Transfers(self.case, self.thing)

    @property
    def size_of_x(self) -> int:
        """Number of the variables."""
        return 3 if self.pivot is None else 4

    @property
    def farthest(self) -> float:
        """[m] The size of the largest change in the box."""
        return self.size(np.maximum(-self.box.low, self.box.high))

    def change_of(self, x: np.ndarray) -> np.ndarray:
        """The shift [m] and, where a turn is allowed, the angle [rad]."""
        return np.append(x[:3], x[3:] / ARM)

    @property
    def first_reach(self) -> np.ndarray:
        """(m,) how far a first step may go."""
        return np.full(self.size_of_x, FIRST_REACH)

    def case_of(self, x: np.ndarray) -> Case:
        """The changed case."""
        return self.place(self.case, x)

    def moved(self, case: Case, body: BodyIndex) -> bool:
        """Whether a body moves with it."""
        return self.thing in owners_of(case, body)

    def moves(self, case: Case, pair: Pair) -> bool:
        """False for a pair, of the plain case of a part of the run, that stays as near whatever is changed."""
        one_moves = self.moved(case, pair.a) != self.moved(case, pair.b)
        return one_moves or self.transfers.has_of(case, pair)

    def gradient(self, approach: Approach, timeline: Timeline | None = None) -> np.ndarray | None:
        """(k, m) what clearances grow by; None where nothing of it changes them.

        Args:
            timeline: of the run, for parts that change hands; None where they are not asked about.
        """
        is_obstacle, _ = self.thing
        if timeline is not None and not is_obstacle and self.transfers.has(approach):
            return Grasps(timeline, self._of_frame, self.size_of_x).gradient(approach)
        case = approach.case
        a, b = (self.moved(case, body) for body in approach.pair)
        if a == b:
            return None
        along = approach.directions * (1.0 if b else -1.0)
        if self.pivot is None:
            return along
        moved = self.pivot.by_unit(approach.points[:, int(b)], self.pose_in(case))
        return np.column_stack([along, np.einsum("ki,ki->k", moved, along)])

    def _of_frame(
        self, phase: Phase, frame: int, steps: np.ndarray, points: np.ndarray
    ) -> np.ndarray:
        """(k, m, 3) how points that a link carries move with the variables of a base."""
        moved, forest = np.zeros((len(points), self.size_of_x, 3)), forest_of(phase.case)
        if forest.robot_starts[self.thing[1]] in carried_by(forest, frame):
            moved[:, :3] = np.eye(3)
            if self.pivot is not None:
                moved[:, 3] = self.pivot.by_unit(points, self.pose_in(phase.case))
        return moved

    def is_of_place(self, approach: Approach) -> bool:
        """True if its place alone moves the bodies of an approach against each other, and no joint."""
        return True

    def factors(self, approach: Approach) -> np.ndarray | float:
        """[-] How far both bodies move against each other at most, as a multiple of the size of a change."""
        if self.pivot is None:
            return 1.0
        case, pair = approach.case, approach.pair
        body = pair.b if self.moved(case, pair.b) else pair.a
        return self.pivot.factors(approach, body, self.pose_in(case))

    def size(self, x: np.ndarray) -> float:
        """How large a change is, in its unit."""
        return float(np.linalg.norm(x))

    def least(self, rows: Rows, x: np.ndarray, box: Box) -> np.ndarray | None:
        """(m,) the least change in a box that keeps all rows, linear about x; None if none does."""
        return least_norm(rows, x, box)

    def other_rows(self, x: np.ndarray, beyond: float) -> Rows | None:
        """What is kept beside clearances; None for nothing. `beyond` [m] is to cover rounding."""
        return None

    def swing(self, reach: np.ndarray) -> float:
        """[m] What no clearance changes more by, where no variable changes by more than (m,) `reach`."""
        turned = 0.0 if self.pivot is None else float(reach[3]) / ARM * self.radius
        return float(np.linalg.norm(reach[:3])) + turned


ANYWHERE = Box(np.full(3, -np.inf), np.full(3, np.inf))


def obstacle_shift(case: Case, name: str, box: Box = ANYWHERE, turn: Turn | None = None) -> Shift:
    """The shift of an obstacle, and of what stands on it.

    Raises:
        UnknownObstacle: with the nearest name. BadInput: it is carried, or rides on something.
    """
    names = [obstacle.name for obstacle in case.obstacles]
    if name not in names:
        raise UnknownObstacle(f"there is no obstacle {name!r}", valid=nearest_name(name, names))
    i_obstacle = names.index(name)
    if case.obstacles[i_obstacle].mount is not None or name in {c.part for c in case.carries}:
        raise BadChange(
            f"obstacle {name!r} is carried, or rides on something",
            valid="what stands in the world, or moves by a table of its own",
        )

    asked = case.obstacles[i_obstacle]
    start = asked.world_from_body if asked.moves is None else first_pose(asked.moves)
    pivot = None if turn is None else Pivot(turn, start)

    def place(whole: Case, x: np.ndarray) -> Case:
        obstacles = list(whole.obstacles)
        obstacles[i_obstacle] = _moved_obstacle(obstacles[i_obstacle], x, pivot)
        return replace(whole, obstacles=tuple(obstacles))

    def pose_in(plain: Case) -> np.ndarray:
        now = plain.obstacles[i_obstacle]
        if asked.moves is None or now.moves is None:
            return now.world_from_body
        return _moved_by(asked.moves, now.moves) @ start

    radius = float(np.linalg.norm(np.abs(asked.body.shape.bounds).max(axis=0)))
    if asked.moves is not None and pivot is not None:
        radius += float(np.linalg.norm(asked.moves.positions - pivot.at, axis=1).max())
    return _shift(Shift(case, (True, i_obstacle), place, pose_in, box, radius), pivot)


def base_shift(case: Case, i_robot: int, box: Box = ANYWHERE, turn: Turn | None = None) -> Shift:
    """The shift of a robot's base, its joints as they are.

    Raises:
        BadInput: it stands on something.
    """
    asked = case.robots[i_robot]
    if asked.mount is not None:
        fault = f"robot {asked.robot.name!r} stands on something"
        raise BadChange(fault, valid="one that stands in the world")
    pivot = None if turn is None else Pivot(turn, asked.world_from_base)

    def place(whole: Case, x: np.ndarray) -> Case:
        robots = list(whole.robots)
        moved_base = _moved(robots[i_robot].world_from_base, x, pivot)
        robots[i_robot] = replace(robots[i_robot], world_from_base=moved_base)
        return replace(whole, robots=tuple(robots))

    def pose_in(plain: Case) -> np.ndarray:
        return plain.robots[i_robot].world_from_base

    return _shift(Shift(case, (False, i_robot), place, pose_in, box, reach_of(asked)), pivot)


def _shift(plain: Shift, pivot: Pivot | None) -> Shift:
    """The shift with a turn, which is one more variable."""
    if pivot is None:
        return plain
    most = ARM * pivot.turn.most
    box = Box(np.append(plain.box.low, -most), np.append(plain.box.high, most))
    return replace(plain, pivot=pivot, box=box)


def _moved_obstacle(obstacle: Obstacle, x: np.ndarray, pivot: Pivot | None) -> Obstacle:
    if obstacle.moves is None:
        return replace(obstacle, world_from_body=_moved(obstacle.world_from_body, x, pivot))
    table = obstacle.moves
    if pivot is None or x[3] == 0.0:
        return replace(obstacle, moves=table.at_places(table.positions + x[:3]))
    positions, quaternions = pivot.moved_table(table, x)
    return replace(obstacle, moves=replace(table, positions=positions, quaternions=quaternions))


def first_pose(table: PoseTable) -> np.ndarray:
    """(4, 4) [m] of a table's first sample."""
    return pose_from_quaternion(table.positions[0].tolist(), table.quaternions[0].tolist())


def _moved_by(asked: PoseTable, now: PoseTable) -> np.ndarray:
    """(4, 4) [m] what a whole motion was moved by, all its poses alike.

    Args:
        asked: as it was. now: a stretch of it as it is, at times of the run: it is looked at half-way between two
            of its samples, where it does not jump.
    """
    middle = np.array([0.5 * (now.times[0] + now.times[min(1, len(now) - 1)])])
    knots = knots_of_poses(asked)
    if asked.timing.after == "loop":
        knots = looped(knots, float(middle[0]) + 1e-9)
    was, place = knots.values_at(middle)[0], now.after(0, 0.5)
    before, after = (
        pose_from_quaternion(one[:3].tolist(), (one[3:] / np.linalg.norm(one[3:])).tolist())
        for one in (was, place)
    )
    return np.asarray(after @ inverse(before))


def _moved(pose: np.ndarray, x: np.ndarray, pivot: Pivot | None) -> np.ndarray:
    if pivot is not None:
        return pivot.moved(x)
    moved = pose.copy()
    moved[:3, 3] += x
    return moved

"""A change of place: an obstacle or a robot's base is moved along x, y and z of the world.

Not for: by how much (`search`).
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, replace

import numpy as np

from clearance.errors import BadInput, UnknownObstacle, UnknownRobot, nearest_name
from clearance.gains.programme import Box, least_norm
from clearance.gains.shortfalls import Rows
from clearance.simulate.approaches import Approach
from clearance.simulate.handed import Handed
from clearance.simulate.point_motion import moves_with_obstacle, moves_with_robot
from clearance.world.body import Obstacle
from clearance.world.case import Case, PlacedRobot
from clearance.world.pairs import BodyIndex

FIRST_REACH = 0.02
"""[m] How far the first step may go along each axis."""


@dataclass(frozen=True, eq=False)
class Shift:
    """Something that is moved along x, y and z.

    Attributes:
        moved: whether a body moves with it. place: the case with it moved by (3,) [m].
        box: [m] how far it may be moved. handed: the parts that it hands over elsewhere.
    """

    case: Case
    handed: Handed
    moved: Callable[[Case, BodyIndex], bool]
    place: Callable[[Case, np.ndarray], Case]
    box: Box
    price: float = 30.0
    kept: None = None

    @property
    def first_reach(self) -> np.ndarray:
        return np.full(3, FIRST_REACH)

    def case_of(self, x: np.ndarray) -> Case:
        return self.place(self.case, x)

    def gradient(self, approach: Approach) -> np.ndarray | None:
        case = approach.case
        a, b = (self.moved(case, body) for body in approach.pair)
        return None if a == b else approach.directions * (1.0 if b else -1.0)

    def size(self, x: np.ndarray) -> float:
        return float(np.linalg.norm(x))

    def least(self, rows: Rows, x: np.ndarray, box: Box) -> np.ndarray | None:
        return least_norm(rows, x, box)

    def swing(self, reach: np.ndarray) -> float:
        return float(np.linalg.norm(reach))


ANYWHERE = Box(np.full(3, -np.inf), np.full(3, np.inf))


def obstacle_shift(case: Case, name: str, box: Box = ANYWHERE) -> Shift:
    """The shift of an obstacle, and of what stands on it.

    Raises:
        UnknownObstacle: with the nearest name. BadInput: it is carried, or rides on something.
    """
    names = [obstacle.name for obstacle in case.obstacles]
    if name not in names:
        raise UnknownObstacle(f"there is no obstacle {name!r}", valid=nearest_name(name, names))
    i_obstacle = names.index(name)
    if case.obstacles[i_obstacle].mount is not None or name in {c.part for c in case.carries}:
        raise BadInput(
            f"obstacle {name!r} is carried, or rides on something",
            valid="what stands in the world, or moves by a table of its own",
        )

    def place(whole: Case, x: np.ndarray) -> Case:
        obstacles = list(whole.obstacles)
        obstacles[i_obstacle] = _moved_obstacle(obstacles[i_obstacle], x)
        return replace(whole, obstacles=tuple(obstacles))

    def moved(plain: Case, body: BodyIndex) -> bool:
        return moves_with_obstacle(plain, body, i_obstacle)

    return Shift(case, Handed(case, (True, i_obstacle)), moved, place, box)


def base_shift(case: Case, name: str, box: Box = ANYWHERE) -> Shift:
    """The shift of a robot's base, its joints as they are.

    Raises:
        UnknownRobot: with the nearest name. BadInput: it stands on something.
    """
    names = [placed.robot.name for placed in case.robots]
    if name not in names:
        raise UnknownRobot(f"there is no robot {name!r}", valid=nearest_name(name, names))
    i_robot = names.index(name)
    if case.robots[i_robot].mount is not None:
        raise BadInput(f"robot {name!r} stands on something", valid="one that stands in the world")

    def place(whole: Case, x: np.ndarray) -> Case:
        robots = list(whole.robots)
        robots[i_robot] = _moved_base(robots[i_robot], x)
        return replace(whole, robots=tuple(robots))

    def moved(plain: Case, body: BodyIndex) -> bool:
        return moves_with_robot(plain, body, i_robot)

    return Shift(case, Handed(case, (False, i_robot)), moved, place, box)


def _moved_obstacle(obstacle: Obstacle, x: np.ndarray) -> Obstacle:
    if obstacle.moves is None:
        return replace(obstacle, world_from_body=_moved(obstacle.world_from_body, x))
    table = obstacle.moves
    return replace(obstacle, moves=replace(table, positions=table.positions + x))


def _moved_base(placed: PlacedRobot, x: np.ndarray) -> PlacedRobot:
    return replace(placed, world_from_base=_moved(placed.world_from_base, x))


def _moved(pose: np.ndarray, x: np.ndarray) -> np.ndarray:
    moved = pose.copy()
    moved[:3, 3] += x
    return moved

"""About where robots and obstacles are in a case, whatever moves them, and how far they ever are from there.

Not for: exact poses at a time (`kinematics`), nor what reads them as units (`plausible_sizes`).
"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from clearance.world.body import Mount
from clearance.world.case import Case
from clearance.world.extents import chain_of
from clearance.world.forest import owner_of, resolved_mount


class Place(NamedTuple):
    """About where something is.

    Attributes:
        pose: (4, 4) in the world [m], at one time or amid all. travel: [m] its origin never is farther from there.
    """

    pose: np.ndarray
    travel: float


def bases_of(case: Case) -> list[Place]:
    """About where each robot stands."""
    return [robot_place(case, i) for i in range(len(case.robots))]


def robot_place(case: Case, i_robot: int) -> Place:
    """About where the base of a robot is."""
    placed = case.robots[i_robot]
    if placed.mount is None:
        return Place(placed.world_from_base, 0.0)
    return _mounted(case, placed.mount)


def obstacle_place(case: Case, i_obstacle: int, at_first: bool = False) -> Place:
    """About where an obstacle is; with `at_first` until a robot picks it up."""
    moves, below = case.obstacles[i_obstacle].moves, ground_of(case, i_obstacle, at_first)
    if moves is None:
        return below
    positions, middle = moves.positions, np.eye(4)
    middle[:3, 3] = 0.5 * (positions.min(axis=0) + positions.max(axis=0))
    travelled = float(np.linalg.norm(positions - middle[:3, 3], axis=1).max())
    return Place(below.pose @ middle, below.travel + travelled)


def ground_of(case: Case, i_obstacle: int, at_first: bool = False) -> Place:
    """About where the frame is in which an obstacle has its own poses over time, or else its own place."""
    obstacle = case.obstacles[i_obstacle]
    below = Place(obstacle.world_from_body, 0.0)
    if obstacle.mount is not None:
        below = _mounted(case, obstacle.mount)
    own = [carry for carry in case.carries if carry.part == obstacle.name]
    first = min(own, key=lambda one: one.window.start, default=None)
    stays = first is None or (at_first and not owner_of(case, Mount(first.by))[0])
    return Place(below.pose, below.travel if stays else np.inf)


def _mounted(case: Case, mount: Mount) -> Place:
    """About where what stands on a mount is; a link is somewhere in the reach of its robot."""
    is_obstacle, i = owner_of(case, mount)
    mount = resolved_mount(case, mount)
    below = obstacle_place(case, i) if is_obstacle else robot_place(case, i)
    travel = below.travel + (0.0 if is_obstacle else chain_of(case.robots[i]))
    return Place(below.pose @ mount.pose, travel)

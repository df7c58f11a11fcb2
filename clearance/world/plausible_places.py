"""Places that look like millimetres: obstacles that stand, ride or move where no robot of the case gets.

Not for: bodies that are too long or too short (`plausible_sizes`).
"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from clearance.world.body import Obstacle
from clearance.world.case import Case
from clearance.world.extents import chain_of, greatest, length_of, metres, reach_of
from clearance.world.forest import owner_of, resolved_mount
from clearance.world.mount import Mount
from clearance.world.notice import listed

FAR = 20.0
"""[-] An obstacle farther away than this many times the reach, and than this many metres, is not its own."""

HALL, WALL = 100.0, 5.0
"""[m] No cell is so large. [-] Within it, what is no farther away than this many times its length is a wall."""


class Place(NamedTuple):
    """About where something is.

    Attributes:
        pose: (4, 4) in the world [m], at one time. travel: [m] its origin is no farther from there at any other.
    """

    pose: np.ndarray
    travel: float


def odd_places(case: Case) -> list[str]:
    """Obstacles, or else a base, that stand where no robot of the case gets."""
    bases = [_robot_place(case, i) for i in range(len(case.robots))]
    reaches = [reach_of(placed) for placed in case.robots]
    far = []
    for i, obstacle in enumerate(case.obstacles):
        place = _obstacle_place(case, i)
        gaps = [_gap(obstacle, place, base) for base in bases]
        near = any(gap <= FAR * max(1.0, reach) for gap, reach in zip(gaps, reaches, strict=True))
        if not near and min(gaps) > min(HALL, WALL * length_of(obstacle.body)):
            far.append((min(gaps), obstacle.name))
    return _in_words(case, greatest(far), bases) if far else []


def _in_words(case: Case, far: list[tuple[float, str]], bases: list[Place]) -> list[str]:
    base = max(float(np.abs(place.pose[:3, 3]).max()) for place in bases)
    hint = "lengths are in metres, is this millimetres?"
    whose = "the robot's base" if len(bases) == 1 else "every robot's base"
    if len(far) == len(case.obstacles) and base > FAR:
        gap_text = f"{metres(far[-1][0])} m from the nearest obstacle"
        return [f"{whose} stands {metres(base)} m away, {gap_text}; {hint}"]
    stand = [f"obstacle {name!r} stands {metres(gap)} m away from {whose}" for gap, name in far]
    return [f"{listed(stand)}; {hint}"]


def _gap(obstacle: Obstacle, place: Place, base: Place) -> float:
    """[m] Nothing of an obstacle ever is nearer to a base."""
    pose = place.pose
    local = pose[:3, :3].T @ (base.pose[:3, 3] - pose[:3, 3])
    if obstacle.stands:
        gap = float(np.linalg.norm(local - np.clip(local, *obstacle.body.shape.bounds)))
    else:  # it may be turned
        gap = float(
            np.linalg.norm(local) - np.linalg.norm(obstacle.body.shape.bounds, axis=1).max()
        )
    return gap - place.travel - base.travel


def _robot_place(case: Case, i_robot: int) -> Place:
    placed = case.robots[i_robot]
    if placed.mount is None:
        return Place(placed.world_from_base, 0.0)
    return _mounted(case, placed.mount)


def _obstacle_place(case: Case, i_obstacle: int) -> Place:
    obstacle = case.obstacles[i_obstacle]
    below = Place(obstacle.world_from_body, 0.0)
    if obstacle.mount is not None:
        below = _mounted(case, obstacle.mount)
    carriers = [carry.by for carry in case.carries if carry.part == obstacle.name]
    travel = below.travel if not carriers else np.inf
    if obstacle.moves is None:
        return Place(below.pose, travel)
    positions, own = obstacle.moves.positions, np.eye(4)
    own[:3, 3] = positions[0]
    travelled = float(np.linalg.norm(positions - positions[0], axis=1).max())
    return Place(below.pose @ own, travel + travelled)


def _mounted(case: Case, mount: Mount) -> Place:
    """About where what stands on a mount is; a link is somewhere in the reach of its robot."""
    is_obstacle, i = owner_of(case, mount)
    mount = resolved_mount(case, mount)
    below = _obstacle_place(case, i) if is_obstacle else _robot_place(case, i)
    travel = below.travel + (0.0 if is_obstacle else chain_of(case.robots[i]))
    return Place(below.pose @ mount.pose, travel)

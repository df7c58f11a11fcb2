"""How points of bodies move with what moves them: by each column of a case's forest, by an actor's place.

Not for: what that does to a clearance (`approaches`).
"""

from __future__ import annotations

import numpy as np

from clearance.kernels.motion.kinematics import SLIDING, TURNING
from clearance.world.case import Case
from clearance.world.forest import WORLD, carried_by, forest_of
from clearance.world.pairs import BodyIndex


def motion_by_columns(
    case: Case, poses: np.ndarray, body: BodyIndex, points: np.ndarray
) -> np.ndarray:
    """How points that a body carries move with the columns of the forest, in first order.

    Args:
        poses: (n, links, 4, 4) `world_from_link` [m] of the forest. points: (n, 3) one at each of them [m], world.

    Returns:
        (n, columns, 3) [m] for each rad or m of a column; 0 for the columns of tables of poses.
    """
    forest = forest_of(case)
    links = forest.links
    moved = np.zeros((len(points), int(links.columns.max(initial=-1)) + 1, 3))
    frame = body.frame_in(case)
    if frame == WORLD:
        return moved
    for link in carried_by(forest, frame):
        kind, column = links.kinds[link], links.columns[link]
        if kind not in (TURNING, SLIDING):
            continue
        axes = poses[:, link, :3, :3] @ links.axes[link]
        if kind == TURNING:
            axes = np.cross(axes, points - poses[:, link, :3, 3])
        moved[:, column] += links.factors[link] * axes
    return moved


def moves_with_robot(case: Case, body: BodyIndex, i_robot: int) -> bool:
    """True if a body is carried by a robot's root link, so that it moves where that is placed elsewhere."""
    frame = body.frame_in(case)
    forest = forest_of(case)
    return frame != WORLD and forest.robot_starts[i_robot] in carried_by(forest, frame)


def moves_with_obstacle(case: Case, body: BodyIndex, i_obstacle: int) -> bool:
    """True if a body is an obstacle, or rides on it, so that it moves where that is placed elsewhere."""
    if body == BodyIndex(-1, i_obstacle):
        return True
    return _stands_on(case, body, case.obstacles[i_obstacle].name)


def _stands_on(case: Case, body: BodyIndex, name: str) -> bool:
    """True if mounts lead from a body to an obstacle called so."""
    obstacles = {obstacle.name: obstacle for obstacle in case.obstacles}
    owner = case.obstacles[body.i_body] if body.is_obstacle else case.robots[body.i_robot]
    mount = owner.mount
    while mount is not None:
        if mount.on == name:
            return True
        if mount.on not in obstacles:
            return False
        mount = obstacles[mount.on].mount
    return False

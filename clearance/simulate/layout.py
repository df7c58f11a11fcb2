"""Lays all measured bodies into one searchable surface, and says where they are at given steps.

Not for: the measuring (`measure`) and the motion itself (`kinematic`, `bullet`).
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from clearance.geometry.tree import join
from clearance.kernels.surface import Surface
from clearance.kernels.sweep import World
from clearance.world.case import Case
from clearance.world.motion import Motion
from clearance.world.pairs import Pair


@dataclass(frozen=True, eq=False)
class Layout:
    """All measured bodies behind one another: links first, then obstacles.

    Attributes:
        n_frames: links of all robots, measured or not.
        frames: (bodies,) which of them carries the body, robot by robot, or -1 for one that stands.
        standing: (bodies, 4, 4) poses of the bodies that stand [m].
        pairs: (p, 2) bodies to measure against each other.
    """

    surface: Surface
    n_frames: int
    frames: np.ndarray
    standing: np.ndarray
    pairs: np.ndarray

    def world(self, motions: Sequence[Motion], steps: np.ndarray) -> World:
        """Where everything is at `steps` (k,), in that order."""
        moving = [motion.poses_at(steps) for motion in motions]
        poses = moving[0] if len(moving) == 1 else np.concatenate(moving, axis=1)
        return World(self.frames, self.standing, poses, self.pairs)


def lay_out(case: Case, pairs: Sequence[Pair]) -> Layout:
    """The layout of the bodies in `pairs`."""
    links = sorted({(pair.i_robot, pair.i_body) for pair in pairs})
    obstacles = sorted({pair.i_obstacle for pair in pairs})
    shapes = [case.robots[i].robot.bodies[j].shape for i, j in links]
    shapes += [case.obstacles[k].body.shape for k in obstacles]
    place_of_link = {link: place for place, link in enumerate(links)}
    place_of_obstacle = {k: len(links) + place for place, k in enumerate(obstacles)}
    measured = [
        (place_of_link[pair.i_robot, pair.i_body], place_of_obstacle[pair.i_obstacle]) for pair in pairs
    ]
    return Layout(
        surface=join(shapes),
        n_frames=sum(len(placed.robot.link_names) for placed in case.robots),
        frames=np.array([*(_frame(case, i, j) for i, j in links), *[-1] * len(obstacles)], dtype=np.int64),
        standing=_standing(case, len(links), obstacles),
        pairs=np.array(measured, dtype=np.int64),
    )


def _frame(case: Case, i_robot: int, i_body: int) -> int:
    robot = case.robots[i_robot].robot
    before = sum(len(placed.robot.link_names) for placed in case.robots[:i_robot])
    return before + robot.link_names.index(robot.bodies[i_body].name)


def _standing(case: Case, n_links: int, obstacles: Sequence[int]) -> np.ndarray:
    standing = np.tile(np.eye(4), (n_links + len(obstacles), 1, 1))
    for place, k in enumerate(obstacles, start=n_links):
        standing[place] = case.obstacles[k].world_from_body
    return standing

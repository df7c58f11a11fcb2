"""Lays all measured bodies into one searchable surface, and says what moves them.

Not for: the measuring (`measure`) and the motion itself (`kinematic`, `bullet`).
"""

from __future__ import annotations

import itertools
from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from clearance.geometry.tree import join
from clearance.kernels.mesh.surface import Surface
from clearance.kernels.motion.world import World
from clearance.world.case import Case
from clearance.world.kinematics import joined_links
from clearance.world.motion import Motion
from clearance.world.pairs import Pair


@dataclass(frozen=True, eq=False)
class Layout:
    """All measured bodies behind one another: links first, then obstacles.

    Attributes:
        surface: their trees and faces.
        world: what carries each body, and which to measure against each other.
    """

    surface: Surface
    world: World


def lay_out(case: Case, pairs: Sequence[Pair]) -> Layout:
    """The layout of the bodies in `pairs`."""
    links = sorted({(pair.i_robot, pair.i_body) for pair in pairs})
    obstacles = sorted({pair.i_obstacle for pair in pairs})
    shapes = [case.robots[i].robot.bodies[j].shape for i, j in links]
    shapes += [case.obstacles[k].body.shape for k in obstacles]
    place_of_link = {link: place for place, link in enumerate(links)}
    place_of_obstacle = {k: len(links) + place for place, k in enumerate(obstacles)}
    measured = np.empty((len(pairs), 2), dtype=np.int64)
    measured[:, 0] = [place_of_link[pair.i_robot, pair.i_body] for pair in pairs]
    measured[:, 1] = [place_of_obstacle[pair.i_obstacle] for pair in pairs]
    frames = _frames(case, links)
    n_bodies = len(links) + len(obstacles)
    world = World(
        solids=np.arange(n_bodies),
        groups=np.arange(n_bodies),
        frames=np.array([*frames, *[-1] * len(obstacles)], dtype=np.int64),
        standing=_standing(case, len(links), obstacles),
        pairs=measured,
        links=joined_links(case.robots),
    )
    return Layout(join(shapes), world)


def positions_at(motions: Sequence[Motion], steps: np.ndarray | range) -> np.ndarray:
    """(k, columns) [rad or m] the positions of the moving joints of all robots, robot by robot; a copy."""
    these = slice(steps.start, steps.stop) if isinstance(steps, range) else steps
    if len(motions) == 1:
        return np.array(motions[0].positions[these], dtype=np.float64, order="C")
    return np.concatenate([motion.positions[these] for motion in motions], axis=1)


def _frames(case: Case, links: Sequence[tuple[int, int]]) -> list[int]:
    """The links that carry bodies, given as (robot, body), counted over all robots."""
    robots = [placed.robot for placed in case.robots]
    before = list(itertools.accumulate((len(robot.link_names) for robot in robots), initial=0))
    return [before[i] + robots[i].link_names.index(robots[i].bodies[j].name) for i, j in links]


def _standing(case: Case, n_links: int, obstacles: Sequence[int]) -> np.ndarray:
    standing = np.empty((n_links + len(obstacles), 4, 4))
    standing[:] = np.eye(4)
    for place, k in enumerate(obstacles, start=n_links):
        standing[place] = case.obstacles[k].world_from_body
    return standing

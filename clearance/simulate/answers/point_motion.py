"""How points of bodies move with what moves them: by each column of a case's forest, by an actor's place."""

from __future__ import annotations

from collections.abc import Collection

import numpy as np

from clearance.kernels.motion.kinematics import SLIDING, TURNING
from clearance.world.case import Case
from clearance.world.forest import carried_by, forest_of, owner_of
from clearance.world.pairs import BodyIndex, Pair
from clearance.world.tool import movers, rates_of

Thing = tuple[bool, int]
"""An obstacle (True, its place among those of the case) or a robot (False, its place)."""


def motion_of_frame(case: Case, poses: np.ndarray, frame: int, points: np.ndarray) -> np.ndarray:
    """How points that a link of the forest carries move with its columns, in first order; of `WORLD` they stand.

    Args:
        poses: (n, links, 4, 4) `world_from_link` [m] of the forest. points: (n, 3) one at each of them [m], world.

    Returns:
        (n, columns, 3) [m] for each rad or m of a column; 0 for the columns of tables of poses.
    """
    links = forest_of(case).links
    n_columns = int(links.columns.max(initial=-1)) + 1
    moved_by = movers(links, frame, range(n_columns))
    return rates_of(links, poses, points, moved_by, n_columns)[:, :3].swapaxes(1, 2)


def moves_with_joints(case: Case, body: BodyIndex, columns: Collection[int]) -> bool:
    """True if a joint that follows one of some columns of the forest moves a body."""
    return _has_joint(case, carrying_links(case, body), columns)


def has_joint_between(case: Case, pair: Pair, columns: Collection[int]) -> bool:
    """True if a joint that follows one of some columns of the forest is between two bodies.

    If none is, these joints never change their distance. A joint that carries both is not between them.
    """
    return _has_joint(case, carrying_links(case, pair.a) ^ carrying_links(case, pair.b), columns)


def carrying_links(case: Case, body: BodyIndex) -> set[int]:
    """The links of the forest that carry a body."""
    return set(carried_by(forest_of(case), body.frame_in(case)))


def _has_joint(case: Case, under: set[int], columns: Collection[int]) -> bool:
    links = forest_of(case).links
    return any(
        links.kinds[link] in (TURNING, SLIDING) and links.factors[link] != 0.0
        for link in under
        if links.columns[link] in columns
    )


def owners_of(case: Case, body: BodyIndex) -> tuple[Thing, ...]:
    """The obstacle or robot that a body is of, and all that it stands on, nearest first.

    It moves where one of them is placed elsewhere.
    """
    return things_under(case, body.thing)


def things_under(case: Case, thing: Thing) -> tuple[Thing, ...]:
    """An obstacle or robot, and all that it stands on by mounts, nearest first."""
    found = [thing]
    while True:
        is_obstacle, i = found[-1]
        mount = case.obstacles[i].mount if is_obstacle else case.robots[i].mount
        if mount is None:
            return tuple(found)
        found.append(owner_of(case, mount))

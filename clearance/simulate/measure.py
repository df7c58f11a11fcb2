"""Measures a motion exactly: the least clearance of every step and of every pair.

Lays all bodies into one searchable surface and lets the compiled sweep run over chunks of steps, so that
progress can be shown and a run interrupted. Not for: where the motion comes from (`kinematic`, `bullet`).
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from typing import NamedTuple

import numpy as np

from clearance.geometry.tree import join
from clearance.kernels.minima import pair_minima, travelled
from clearance.kernels.surface import Surface
from clearance.kernels.sweep import StepRows, World, sweep
from clearance.world.case import Case
from clearance.world.motion import Motion
from clearance.world.pairs import Pair

Progress = Callable[[int, int], None]
"""Called with the number of steps done and of all steps."""

CHUNK = 256
"""Steps a compiled call; fixed, so that counters do not depend on the machine."""

COUNTERS = ("pairs_skipped", "queries", "node_tests", "polygon_tests")


class Minima(NamedTuple):
    """One row a pair: least clearance [m], the first step that has it, witness points in the world [m]."""

    clearance: np.ndarray
    step: np.ndarray
    points: np.ndarray  # (p, 2, 3)


@dataclass(frozen=True, eq=False)
class Measurement:
    """The least clearances of a motion.

    Attributes:
        clearance: (n,) [m].
        pair: (n,) index of the pair that attains it.
        points: (n, 2, 3) witness points [m] in the world frame: on the link, on the obstacle.
        tally: counters by name.
        find_minima: measures the least clearance of each pair; not done until it is called.
        may_cut_pairs: True if a pair can be left out by rules without proof (the paper's).
    """

    clearance: np.ndarray
    pair: np.ndarray
    points: np.ndarray
    tally: dict[str, int]
    find_minima: Callable[[], Minima]
    may_cut_pairs: bool = False


def measure(
    case: Case, motions: Sequence[Motion], pairs: Sequence[Pair], progress: Progress | None = None
) -> Measurement:
    """The exact clearances of `pairs` over `motions` (one for each robot, with the same steps)."""
    surface, world = _lay_out(case, motions, pairs)
    n_steps = len(world.poses)
    tally = np.zeros(4, dtype=np.int64)
    rows = StepRows(
        np.empty(n_steps),
        np.empty(n_steps, dtype=np.int64),
        np.empty((n_steps, 2), dtype=np.int64),
        np.empty((n_steps, 2, 3)),
    )
    for first in range(0, n_steps, CHUNK):
        last = min(first + CHUNK, n_steps)
        sweep(surface, world, first, last, rows, tally)
        if progress:
            progress(last, n_steps)
    counts = dict(zip(COUNTERS, tally.tolist(), strict=True))
    return Measurement(
        rows.clearance, rows.pair, rows.points, counts, lambda: _pair_minima(surface, world)
    )


def _pair_minima(surface: Surface, world: World) -> Minima:
    n_pairs = len(world.pairs)
    found = Minima(np.empty(n_pairs), np.empty(n_pairs, dtype=np.int64), np.empty((n_pairs, 2, 3)))
    faces = np.empty((n_pairs, 2), dtype=np.int64)
    tally = np.zeros(len(COUNTERS), dtype=np.int64)
    travel = travelled(surface, world)
    pair_minima(surface, world, travel, found.clearance, found.step, faces, found.points, tally)
    return found


def _lay_out(
    case: Case, motions: Sequence[Motion], pairs: Sequence[Pair]
) -> tuple[Surface, World]:
    """One surface of all measured bodies, and where they are: links move, obstacles stand."""
    links = sorted({(pair.i_robot, pair.i_body) for pair in pairs})
    obstacles = sorted({pair.i_obstacle for pair in pairs})
    shapes = [case.robots[i].robot.bodies[j].shape for i, j in links]
    shapes += [case.obstacles[k].body.shape for k in obstacles]
    place_of_link = {link: place for place, link in enumerate(links)}
    place_of_obstacle = {k: len(links) + place for place, k in enumerate(obstacles)}
    world = World(
        frames=np.array([*range(len(links)), *[-1] * len(obstacles)], dtype=np.int64),
        standing=_standing(case, len(links), obstacles),
        poses=_moving(case, motions, links),
        pairs=np.array(
            [
                (place_of_link[pair.i_robot, pair.i_body], place_of_obstacle[pair.i_obstacle])
                for pair in pairs
            ],
            dtype=np.int64,
        ),
    )
    return join(shapes), world


def _standing(case: Case, n_links: int, obstacles: Sequence[int]) -> np.ndarray:
    standing = np.tile(np.eye(4), (n_links + len(obstacles), 1, 1))
    for place, k in enumerate(obstacles, start=n_links):
        standing[place] = case.obstacles[k].world_from_body
    return standing


def _moving(
    case: Case, motions: Sequence[Motion], links: Sequence[tuple[int, int]]
) -> np.ndarray:
    """(steps, links, 4, 4) `world_from_link` of the measured links."""
    columns = []
    for i_robot, motion in enumerate(motions):
        robot = case.robots[i_robot].robot
        index = {name: i for i, name in enumerate(robot.link_names)}
        chosen = [index[robot.bodies[j].name] for i, j in links if i == i_robot]
        columns.append(motion.poses()[:, chosen])
    return np.ascontiguousarray(np.concatenate(columns, axis=1))

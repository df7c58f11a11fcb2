"""Pairs of bodies that move by two clocks: which is on which side, and where all is at the steps of either."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace
from functools import cached_property

import numpy as np

from clearance.world.case import Case, Limits
from clearance.world.motion import Motion
from clearance.world.pairs import OBSTACLE, BodyIndex, Pair


@dataclass(frozen=True, eq=False)
class ClockMotion:
    """How all that moves by one clock moves, from step to step of that clock.

    Attributes:
        case: obstacles that move have a sample at each of its steps. motions: of the case's robots at its steps.
    """

    case: Case
    motions: Sequence[Motion]

    @property
    def times(self) -> np.ndarray:
        """(n,) [s] of its steps."""
        return self.motions[0].times


@dataclass(frozen=True, eq=False)
class PairsOfTwoClocks:
    """Pairs whose first bodies move by one clock, and whose second bodies move by another.

    Attributes:
        a, b: how all moves by either clock.
        actors_of_b: the robots (body 0 of each) and the obstacles that move by the second clock, whether they are
            of a pair or only carry what is.
        pairs: no actor is on both sides.
        limits: of the pairs' distances. slack: [s] by which the clocks differ at most; infinite where nothing ties
            them.
    """

    a: ClockMotion
    b: ClockMotion
    actors_of_b: frozenset[BodyIndex]
    pairs: Sequence[Pair]
    limits: Limits
    slack: float

    @cached_property
    def case(self) -> Case:
        """The case in which each body is as it is by its own clock."""
        moved = {actor.i_body for actor in self.actors_of_b if actor.is_obstacle}
        both = zip(self.a.case.obstacles, self.b.case.obstacles, strict=True)
        obstacles = tuple(of_b if i in moved else of_a for i, (of_a, of_b) in enumerate(both))
        if obstacles == self.a.case.obstacles:
            return self.a.case
        return replace(self.a.case, obstacles=obstacles)

    def columns(self) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
        """Positions and rates (n_b + n_a + 1, columns), first at the steps of clock b, and (columns,) which are
        cubic.

        The last row is that before it once more. What does not move by a clock has any numbers at its steps.
        """
        robots = [
            self._rows(i, BodyIndex(i, 0), [side.motions[i].positions for side in (self.b, self.a)])
            for i in range(len(self.case.robots))
        ]
        rates = [self._rates(i) for i in range(len(self.case.robots))]
        moving = [
            self._rows(
                i, BodyIndex(OBSTACLE, i), [_table_of(side.case, i) for side in (self.b, self.a)]
            )
            for i, obstacle in enumerate(self.case.obstacles)
            if obstacle.moves is not None
        ]
        is_cubic = [
            np.full(rows.shape[1], self.a.motions[i].velocities is not None)
            for i, rows in enumerate(robots)
        ]
        still = [np.zeros_like(rows) for rows in moving]
        return (
            np.concatenate([*robots, *moving], axis=1),
            np.concatenate([*rates, *still], axis=1),
            np.concatenate([*is_cubic, *(np.zeros(7, dtype=bool) for _ in moving)]),
        )

    def _rates(self, i_robot: int) -> np.ndarray:
        sides = [side.motions[i_robot] for side in (self.b, self.a)]
        rates = [
            np.zeros_like(one.positions) if one.velocities is None else one.velocities
            for one in sides
        ]
        return self._rows(i_robot, BodyIndex(i_robot, 0), rates)

    def _rows(self, i: int, actor: BodyIndex, sides: Sequence[np.ndarray | None]) -> np.ndarray:
        """(n_b + n_a, k) the rows of an actor: its own where its clock goes, its first elsewhere."""
        n_b, n_a = len(self.b.times), len(self.a.times)
        of_b, of_a = sides
        if actor in self.actors_of_b:
            assert of_b is not None
            return np.concatenate([of_b, np.repeat(of_b[:1], n_a + 1, axis=0)])
        assert of_a is not None
        return np.concatenate([np.repeat(of_a[:1], n_b, axis=0), of_a, of_a[-1:]])


def actor_of(body: BodyIndex) -> BodyIndex:
    """The actor that a body is of: an obstacle itself, or body 0 of its robot."""
    return body if body.is_obstacle else BodyIndex(body.i_robot, 0)


def _table_of(case: Case, i_obstacle: int) -> np.ndarray | None:
    moves = case.obstacles[i_obstacle].moves
    return None if moves is None else moves.columns

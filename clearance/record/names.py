"""What tables and reports call the bodies of a pair, and the columns that they stand in."""

from __future__ import annotations

from collections.abc import Container, Sequence
from dataclasses import dataclass

from clearance.world.case import Case
from clearance.world.cell import once_a_cell
from clearance.world.pairs import Pair

SIDES = ("body_a", "body_b")
"""The names of the two bodies in every table; their points are `a_x` to `b_z`."""

LINK_AND_OBSTACLE = ("link", "obstacle")
"""The same in tables of one robot among obstacles that stand, which have both."""


def pair_names(case: Case, pairs: Sequence[Pair]) -> tuple[list[str], list[str]]:
    """The two bodies of each pair; links carry their robot's name where there are several."""
    return _pair_names(case, tuple(pairs))


@once_a_cell(16)
def _pair_names(case: Case, pairs: tuple[Pair, ...]) -> tuple[list[str], list[str]]:
    return [pair.a.name_in(case) for pair in pairs], [pair.b.name_in(case) for pair in pairs]


def sides_of(case: Case) -> tuple[str, str]:
    """What the first columns of a run's tables call the two bodies."""
    stands = all(obstacle.stands for obstacle in case.obstacles) and not case.carries
    return LINK_AND_OBSTACLE if len(case.robots) == 1 and stands else SIDES


def sides_in(columns: Container[str]) -> tuple[str, str]:
    """What a table with these columns calls the two bodies."""
    return LINK_AND_OBSTACLE if LINK_AND_OBSTACLE[0] in columns else SIDES


@dataclass(frozen=True, eq=False)
class BodyNames:
    """The bodies of pairs by name.

    Attributes:
        a, b: (p,) of each pair. sides: what the columns of the two are called.
    """

    a: Sequence[str]
    b: Sequence[str]
    sides: tuple[str, str]

    @staticmethod
    def of(case: Case, pairs: Sequence[Pair]) -> BodyNames:
        """Those of the pairs of a case."""
        return BodyNames(*pair_names(case, pairs), sides_of(case))

    @property
    def columns(self) -> tuple[str, ...]:
        """The columns of both names, then of both points, x to z."""
        return columns_of(self.sides)


def columns_of(sides: tuple[str, str]) -> tuple[str, ...]:
    """The columns of both names, then of both points, x to z."""
    stems = [side.removeprefix("body_") for side in sides]
    return (*sides, *(f"{stem}_{axis}" for stem in stems for axis in "xyz"))

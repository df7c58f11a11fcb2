"""What rows of tolerances may be of: joints, links, robots, obstacles, clocks, each by the names it goes by.

A pattern that is of nothing is refused. Not for: the numbers in the rows (`block`).
"""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass
from typing import NamedTuple, TypeVar

from clearance.errors import (
    BadInput,
    BadTolerance,
    UnknownJoint,
    UnknownLink,
    UnknownObstacle,
    UnknownRobot,
    nearest_name,
)
from clearance.world.case import Case
from clearance.world.joint_positions import turns
from clearance.world.robot import JointKind
from clearance.world.rules import matches

_Row = TypeVar("_Row")

OF_ALL = ("all", "default")
"""Keys of rows that are of everything of a kind; all other rows go before them."""


class Target(NamedTuple):
    """One thing.

    Attributes:
        owner: its robot; of an obstacle that itself. part: the joint or link; empty for the whole.
        names: what it goes by. unit: of its position, for a joint.
    """

    owner: str
    part: str
    names: tuple[str, ...]
    unit: str = ""


@dataclass(frozen=True)
class Targets:
    """All things of one kind in a case.

    Attributes:
        kind: what one is called. missing: how the fault of an unknown one is named.
    """

    kind: str
    missing: type[BadInput]
    all: tuple[Target, ...]

    def rows(self, given: Mapping[str, _Row]) -> Iterator[tuple[Target, _Row]]:
        """Each row with each thing that it is of: those of all first, then in their order, so that the last holds.

        Raises:
            BadInput: a row of nothing, or both words for all.
        """
        words = [key for key in given if key in OF_ALL]
        if len(words) > 1:
            raise BadTolerance(f"both {' and '.join(words)} are given", valid="one of them")
        for key in (*words, *(key for key in given if key not in words)):
            for target in self._meant(key):
                yield target, given[key]

    def _meant(self, key: str) -> Sequence[Target]:
        if key in OF_ALL:
            return self.all
        meant = [one for one in self.all if any(matches(name, key) for name in one.names)]
        if not meant:
            names = [name for one in self.all for name in one.names]
            raise self.missing(f"no {self.kind} matches {key!r}", valid=nearest_name(key, names))
        return meant


def frames_of(case: Case) -> Targets:
    """All joints, those that are fixed too: each has a frame."""
    return Targets("joint", UnknownJoint, tuple(_joints(case)))


def joints_of(case: Case) -> Targets:
    """The joints that move, those that follow others too."""
    return Targets(
        "joint that moves", UnknownJoint, tuple(one for one in _joints(case) if one.unit)
    )


def _joints(case: Case) -> Iterator[Target]:
    for placed in case.robots:
        before = case.prefix_of(placed)
        for joint in placed.robot.joints:
            unit = "" if joint.kind is JointKind.FIXED else "rad" if turns(joint) else "m"
            yield Target(placed.robot.name, joint.name, _names(before, joint.name), unit)


def links_of(case: Case) -> Targets:
    """The links that have a shape."""
    found = [
        Target(placed.robot.name, body.name, _names(case.prefix_of(placed), body.name))
        for placed in case.robots
        for body in placed.robot.bodies
    ]
    return Targets("link with a shape", UnknownLink, tuple(found))


def _names(before: str, name: str) -> tuple[str, ...]:
    return (before + name, name) if before else (name,)


def robots_of(case: Case) -> Targets:
    """The robots."""
    return Targets("robot", UnknownRobot, tuple(_whole(one.robot.name) for one in case.robots))


def obstacles_of(case: Case) -> Targets:
    """The obstacles, parts among them."""
    return Targets("obstacle", UnknownObstacle, tuple(_whole(one.name) for one in case.obstacles))


def clocks_of(case: Case) -> Targets:
    """What moves by a table of its own: robots, and obstacles that have one."""
    moving = [one.name for one in case.obstacles if one.moves is not None]
    robots = [one.robot.name for one in case.robots]
    return Targets("actor", BadInput, tuple(_whole(name) for name in (*robots, *moving)))


def _whole(name: str) -> Target:
    return Target(name, "", (name,))

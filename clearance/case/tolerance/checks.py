"""A budget made in Python, held against its case as one from a file is. Not for: blocks (`block`)."""

from __future__ import annotations

import math
from collections.abc import Iterable, Iterator

from clearance.case.tolerance.targets import joints_of
from clearance.errors import (
    BadDimension,
    BadInput,
    UnknownJoint,
    UnknownLink,
    UnknownObstacle,
    UnknownRobot,
    at,
    nearest_name,
)
from clearance.formats.schema.tolerance import checked_angle, checked_offset
from clearance.world.budget import Budget, PlacementTolerance
from clearance.world.case import Case


def require_there(budget: Budget, case: Case) -> None:
    """Nothing, if all that it names is there.

    Raises:
        UnknownRobot, UnknownJoint, UnknownLink, UnknownObstacle: with the nearest name.
    """
    robots = {placed.robot.name: placed.robot for placed in case.robots}
    _require(budget.robots, robots, "robot", UnknownRobot)
    names = [obstacle.name for obstacle in case.obstacles]
    _require(budget.obstacles, names, "obstacle", UnknownObstacle)
    for name, one in budget.robots.items():
        with at(name):
            joints = [joint.name for joint in robots[name].joints]
            _require(one.joints, joints, "joint", UnknownJoint)
            _require(one.surfaces, robots[name].link_names, "link", UnknownLink)


def _require(given: Iterable[str], known: Iterable[str], what: str, fault: type[BadInput]) -> None:
    there = set(known)
    for name in given:
        if name not in there:
            raise fault(f"unknown {what} {name!r}", valid=nearest_name(name, there))


def require_numbers(budget: Budget, case: Case) -> None:
    """Nothing, if its numbers are 0 or more and of a believable size.

    Raises:
        BadDimension: the first that is not.
    """
    if not 0.0 < budget.coverage < math.inf:
        raise BadDimension(f"a coverage of {budget.coverage:g}", valid="above 0")
    units = {(one.owner, one.part): one.unit for one in joints_of(case).all}
    for place, value, unit in _numbers(budget, units):
        with at(place):
            if not 0.0 <= value < math.inf:
                raise BadDimension(f"{value:g} {unit} is given", valid="0 or more")
            if unit != "s":
                (checked_angle if unit == "rad" else checked_offset)(value)


def _numbers(budget: Budget, units: dict[tuple[str, str], str]) -> Iterator[tuple[str, float, str]]:
    """Place, value and unit of each."""
    for name, robot in budget.robots.items():
        for joint, one in robot.joints.items():
            unit = units.get((name, joint), "rad")
            yield f"{name}/{joint}", one.position, unit
            yield f"{name}/{joint}", one.tracking, unit
            yield from _placement(f"{name}/{joint}", one.frame)
        yield from _placement(name, robot.base)
        yield from ((f"{name}/{link}", value, "m") for link, value in robot.surfaces.items())
        yield name, robot.timing, "s"
    for name, obstacle in budget.obstacles.items():
        yield from _placement(name, obstacle.place)
        yield name, obstacle.surface, "m"
        yield name, obstacle.timing, "s"


def _placement(place: str, given: PlacementTolerance) -> Iterator[tuple[str, float, str]]:
    yield place, given.xyz, "m"
    yield place, given.angle, "rad"

"""Tolerances that are given beside a case: a file, plain data, or a budget made in Python, held against the
case as one from a file is. Not for: what they mean (`block`).
"""

from __future__ import annotations

import hashlib
import math
from collections.abc import Iterable, Iterator, Mapping
from dataclasses import replace
from os import PathLike
from pathlib import Path
from typing import Any

from clearance.case.tolerance.block import budget_of
from clearance.case.tolerance.targets import joints_of
from clearance.errors import (
    BadDimension,
    BadInput,
    BadTolerance,
    UnknownJoint,
    UnknownLink,
    UnknownObstacle,
    UnknownRobot,
    at,
    nearest_name,
)
from clearance.formats.files.input_files import InputFiles
from clearance.formats.schema.strict_model import validated
from clearance.formats.schema.tolerance import Tolerance, checked_error
from clearance.plain_yaml import parse_yaml
from clearance.world.budget import Budget, PlacementTolerance
from clearance.world.case import Case

KEY = "tolerance"
"""The key of the block in a case; a file may begin with it."""


def with_tolerance(case: Case, given: Budget | Mapping[str, Any] | str | PathLike[str]) -> Case:
    """The case with other tolerances in place of its own, which a note says.

    Args:
        given: a budget, the block of a case file as plain data, or the path of a YAML file with it. Files in plain
            data are looked up from the current folder, those in a file from the folder of that.

    Raises:
        BadInput: with the field and the file.
    """
    if isinstance(given, Budget):
        with at(KEY):
            require_there(given, case)
            require_numbers(given, case)
        return _replaced(case, given, "tolerances that were given")
    if isinstance(given, str | PathLike):
        path = Path(given)
        files = InputFiles(path.parent)
        block, place = _block(path, files)
        return _read(case, block, place, files, f"tolerances of {files.shown(path)}")
    if not isinstance(given, Mapping):
        raise BadTolerance(
            f"tolerances are {given!r:.60}", valid="a mapping, the path of a file, or a Budget"
        )
    files = InputFiles(Path.cwd())
    block = validated(Tolerance, dict(given), KEY)
    return _read(case, block, KEY, files, "tolerances that were given")


def tolerance_digest(path: Path) -> str:
    """sha256 of a file of tolerances and of the file of controllers that it names, if it names one.

    Raises:
        BadInput: with the field and the file; what only a case can tell is not looked at.
    """
    files = InputFiles(path.parent)
    block, place = _block(path, files)
    if block.tracking is not None and block.tracking.file is not None:
        with at(f"{place}: tracking.file"):
            files.read(path.parent / block.tracking.file)
    hashes = [(source.path, source.sha256) for source in files.sources]
    return hashlib.sha256(repr(hashes).encode()).hexdigest()


def _block(path: Path, files: InputFiles) -> tuple[Tolerance, str]:
    """The block in a file, and how messages call it."""
    shown = files.shown(path)
    raw = parse_yaml(files.read(path), shown)
    inside = isinstance(raw, dict) and list(raw) == [KEY]
    place = f"{shown}: {KEY}" if inside else shown
    return validated(Tolerance, raw[KEY] if inside else raw, place), place  # type: ignore[index]


def _read(case: Case, block: Tolerance, place: str, files: InputFiles, what: str) -> Case:
    """The case with the budget of a block, whose files are read through `files`."""
    with at(place):
        budget = budget_of(block, case, files)
    made = _replaced(case, budget, what)
    return replace(made, sources=files.sources_beside(made.sources))


def _replaced(case: Case, budget: Budget, what: str) -> Case:
    """The case with a budget; a note says so where it had another."""
    notes = case.notes
    if case.tolerance is not None:
        notes = (*notes, f"{what} take the place of the case's own")
    return replace(case, tolerance=budget, notes=notes)


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
                checked_error(value, unit)


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

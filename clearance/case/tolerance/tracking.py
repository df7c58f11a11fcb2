"""How far controllers leave joints off their course: numbers, a controllers file, or those of the case's robots.

A joint that a controller does not watch has no number, and one must be given. Not for: the format of the file
(`controllers_file`).
"""

from __future__ import annotations

import math
from collections.abc import Mapping
from dataclasses import dataclass, field
from pathlib import Path

from clearance.case.tolerance.targets import Target, joints_of
from clearance.errors import BadInput, MissingKey, UnknownJoint, at, nearest_name
from clearance.formats.files.input_files import InputFiles, resolved
from clearance.formats.robot.controllers_file import parse_controllers
from clearance.formats.robot.limit_files import widest
from clearance.formats.schema.tolerance import Tracking, checked_angle, checked_offset
from clearance.world.case import Case
from clearance.world.motion_limits import PathTolerance
from clearance.world.notice import listed

_Key = tuple[str, str]


@dataclass(frozen=True)
class TrackingErrors:
    """Errors by robot and joint [rad] or [m], and a line on where they are from."""

    errors: Mapping[_Key, float] = field(default_factory=dict)
    sources: tuple[str, ...] = ()


def tracking_of(
    given: Tracking | None, case: Case, folder: Path, files: InputFiles
) -> TrackingErrors:
    """What a block says of tracking.

    Raises:
        MissingKey: a file, or controllers of the case, that bound no path. UnknownJoint: none of the case's.
        BadInput: a joint that they leave without a bound and nothing else gives one.
    """
    if given is None:
        return TrackingErrors()
    with at("tracking"):
        numbers = _numbers(given, case)
        if given.of_case:
            bounds = _of_case(case)
            return _joined(numbers, bounds, case, "path tolerances of the robots' controllers")
        if given.file is None:
            return TrackingErrors(numbers)
        path = resolved(given.file, folder)
        with at("file"), at(files.shown(path)):
            bounds = _of_file(files.read(path), case)
            told = f"path tolerances of controllers in {files.shown(path)}"
            return _joined(numbers, bounds, case, told)


def _numbers(given: Tracking, case: Case) -> dict[_Key, float]:
    found = {}
    for target, error in joints_of(case).rows(given.rows):
        found[target.owner, target.part] = checked_size(error, target)
    return found


def checked_size(error: float, target: Target) -> float:
    """The error of a joint, if its size is believable in the joint's unit.

    Raises:
        BadDimension: it is too great.
    """
    with at(target.names[0]):
        return checked_angle(error) if target.unit == "rad" else checked_offset(error)


def _of_file(data: bytes, case: Case) -> dict[_Key, PathTolerance]:
    known = widest(parse_controllers(data))
    found = {
        (one.owner, one.part): known[one.part] for one in joints_of(case).all if one.part in known
    }
    if not found:
        first, names = next(iter(known), ""), [one.part for one in joints_of(case).all]
        raise UnknownJoint("it speaks of no joint of the case", valid=nearest_name(first, names))
    return found


def _of_case(case: Case) -> dict[_Key, PathTolerance]:
    found = {
        (placed.robot.name, joint): one
        for placed in case.robots
        for joint, one in placed.path_tolerances.items()
    }
    if not found:
        raise MissingKey("no robot of the case has controllers", valid="robot: {controllers: FILE}")
    return found


def _joined(
    numbers: Mapping[_Key, float], bounds: Mapping[_Key, PathTolerance], case: Case, told: str
) -> TrackingErrors:
    """Numbers before bounds.

    Raises:
        MissingKey: no joint has a bound. BadInput: one has neither.
    """
    if all(one.trajectory == math.inf for one in bounds.values()):
        raise MissingKey(
            "no controller in it bounds how far joints may leave the path",
            valid="constraints: {JOINT: {trajectory: 0.01}}, or numbers for each joint",
        )
    errors = dict(numbers)
    for target in joints_of(case).all:
        key = target.owner, target.part
        if key in bounds and key not in errors:
            if bounds[key].trajectory == math.inf:
                raise BadInput(
                    f"controllers let joint {target.names[0]!r} as far off the path as it goes",
                    valid=f"tracking: {{file: …, {target.part}: 0.01}}",
                )
            errors[key] = checked_size(bounds[key].trajectory, target)
    leaders = {joint.name for one in case.robots for joint in one.robot.moving_joints}
    free = [
        one.names[0]
        for one in joints_of(case).all
        if (one.owner, one.part) not in errors and one.part in leaders
    ]
    told += f"; none of joints {listed(free, 8)}" if free else ""
    return TrackingErrors(errors, (told,))

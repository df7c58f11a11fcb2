"""A block of tolerances, held against its case: patterns and presets to the `Budget` of what is there.

Presets, files of tolerances with their source, come first, in their order; a row of one thing takes the place
of those before it, number by number. How far controllers leave joints off their course is said by numbers, by a
controllers file, or by those of the case's robots; a joint that no controller watches has no number, and one
must be given. Not for: the keys of the block (`schema.tolerance`), what rows are of (`targets`), the format of
a controllers file (`limit_files`).
"""

from __future__ import annotations

import math
from collections.abc import Mapping

from clearance.case.tolerance.targets import (
    Target,
    clocks_of,
    frames_of,
    joints_of,
    links_of,
    obstacles_of,
    robots_of,
)
from clearance.errors import BadTolerance, MissingKey, UnknownJoint, at, nearest_name
from clearance.formats.files.input_files import InputFiles
from clearance.formats.robot.limit_files import parse_controllers, widest
from clearance.formats.schema.strict_model import StrictModel, validated
from clearance.formats.schema.tolerance import (
    FOLDER,
    Tolerance,
    Tracking,
    checked_error,
)
from clearance.plain_yaml import parse_yaml
from clearance.world.budget import (
    Budget,
    JointTolerance,
    ObstacleTolerance,
    PlacementTolerance,
    RobotTolerance,
)
from clearance.world.case import Case
from clearance.world.notice import listed
from clearance.world.placed_robot import PathTolerance


def budget_of(given: Tolerance, case: Case, files: InputFiles) -> Budget:
    """The budget that a block is for a case.

    Args:
        files: reads the files that it names, from their folder.

    Raises:
        BadInput: with the field; a row of nothing that the case has, with the nearest name.
    """
    presets = {name: preset(name) for name in given.presets or ()}
    found: _Errors = {}
    for block in (*(one.tolerance for one in presets.values()), given):
        found |= _errors_in(block, case)
    tracking, on_tracking = _tracking_of(given.tracking, case, files)
    found |= {("tracking", *key): error for key, error in tracking.items()}
    return Budget(
        robots={one.robot.name: _of_robot(found, one.robot.name) for one in case.robots},
        obstacles={one.name: _of_obstacle(found, one.name) for one in case.obstacles},
        coverage=given.coverage,
        is_normal=given.distributions == "normal",
        unproven_ok=given.unproven_ok,
        sources=(*(f"preset {name}: {one.line}" for name, one in presets.items()), *on_tracking),
    )


_Key = tuple[str, str]
"""Owner, and the joint or link of it; empty for the whole."""

_Errors = dict[tuple[str, str, str], float]
"""[m, rad or s] by kind (position, tracking, xyz, angle, surface, timing), owner, and part."""

_ROWS = {
    "joints": joints_of,
    "kinematics": frames_of,
    "base": robots_of,
    "links": links_of,
    "obstacles": obstacles_of,
    "timing": clocks_of,
}
"""Keys of a block, and what their rows are of."""


def _errors_in(given: Tolerance, case: Case) -> _Errors:
    """The errors that the rows of a block name; of several rows of one thing the last holds, number by number."""
    found: _Errors = {}
    for key, targets in _ROWS.items():
        rows = getattr(given, key) or {}
        with at(key):
            for target, row in targets(case).rows(getattr(rows, "rows", rows)):
                if isinstance(row, StrictModel):
                    errors = row.model_dump(exclude_none=True)
                else:
                    errors = {"timing": row} if key == "timing" else {"position": row}
                    _require_believable(row, target)
                found |= {(kind, target.owner, target.part): e for kind, e in errors.items()}
    return found


def _placement(found: _Errors, owner: str, part: str = "") -> PlacementTolerance:
    xyz, angle = (found.get((kind, owner, part), 0.0) for kind in ("xyz", "angle"))
    return PlacementTolerance(xyz, angle)


def _of_robot(found: _Errors, name: str) -> RobotTolerance:
    own = {(kind, part): error for (kind, owner, part), error in found.items() if owner == name}
    joints = dict.fromkeys(part for kind, part in own if part and kind != "surface")
    return RobotTolerance(
        joints={
            joint: JointTolerance(
                own.get(("position", joint), 0.0),
                own.get(("tracking", joint), 0.0),
                _placement(found, name, joint),
            )
            for joint in joints
        },
        base=_placement(found, name),
        surfaces={part: e for (kind, part), e in own.items() if kind == "surface" and part},
        timing=own.get(("timing", ""), 0.0),
    )


def _of_obstacle(found: _Errors, name: str) -> ObstacleTolerance:
    surface, timing = (found.get((kind, name, ""), 0.0) for kind in ("surface", "timing"))
    return ObstacleTolerance(_placement(found, name), surface, timing)


class Preset(StrictModel):
    """Tolerances, and where their numbers come from."""

    source: str
    tolerance: Tolerance

    @property
    def line(self) -> str:
        """The source on one line."""
        return " ".join(self.source.split())


def preset(name: str) -> Preset:
    """The preset of a name, which is there."""
    path = FOLDER / f"{name}.yaml"
    return validated(Preset, parse_yaml(path.read_bytes(), path.name), path.name)


_Tracking = tuple[dict[_Key, float], tuple[str, ...]]
"""Errors [rad or m] by robot and joint, and lines on where they are from."""


def _tracking_of(given: Tracking | None, case: Case, files: InputFiles) -> _Tracking:
    """What a block says of tracking.

    Raises:
        MissingKey: a file, or controllers of the case, that bound no path. UnknownJoint: none of the case's.
        BadInput: a joint that they leave without a bound and nothing else gives one.
    """
    if given is None:
        return {}, ()
    with at("tracking"):
        numbers = {}
        for target, error in joints_of(case).rows(given.rows):
            _require_believable(error, target)
            numbers[target.owner, target.part] = error
        if given.of_case:
            bounds = _of_case(case)
            return _joined(numbers, bounds, case, "path tolerances of the robots' controllers")
        if given.file is None:
            return numbers, ()
        path = files.resolved(given.file)
        with at("file"), at(files.shown(path)):
            bounds = _of_file(files.read(path), case)
            source = f"path tolerances of controllers in {files.shown(path)}"
            return _joined(numbers, bounds, case, source)


def _require_believable(error: float, target: Target) -> None:
    """Nothing, if the error of a joint is of a believable size in the joint's unit.

    Raises:
        BadDimension: it is too great.
    """
    if target.unit:
        with at(target.names[0]):
            checked_error(error, target.unit)


def _of_file(data: bytes, case: Case) -> dict[_Key, PathTolerance]:
    known = widest(parse_controllers(data))
    found = {
        (one.owner, one.part): known[one.part] for one in joints_of(case).all if one.part in known
    }
    if not found:
        first, names = next(iter(known), ""), [one.part for one in joints_of(case).all]
        raise UnknownJoint("it names no joint of the case", valid=nearest_name(first, names))
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
    numbers: Mapping[_Key, float], bounds: Mapping[_Key, PathTolerance], case: Case, source: str
) -> _Tracking:
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
                raise BadTolerance(
                    f"controllers let joint {target.names[0]!r} as far off the path as it goes",
                    valid=f"tracking: {{file: …, {target.part}: 0.01}}",
                )
            _require_believable(bounds[key].trajectory, target)
            errors[key] = bounds[key].trajectory
    leaders = {joint.name for one in case.robots for joint in one.robot.moving_joints}
    free = [
        one.names[0]
        for one in joints_of(case).all
        if (one.owner, one.part) not in errors and one.part in leaders
    ]
    source += f"; none of joints {listed(free, 8)}" if free else ""
    return errors, (source,)

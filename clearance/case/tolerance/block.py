"""A block of tolerances, held against its case: patterns and presets to the `Budget` of what is there.

Presets, files of tolerances with their source, come first, in their order; a row of one thing takes the place
of those before it, number by number. How far controllers leave joints off their course is said by numbers, by a
controllers file, or by those of the case's robots; a joint that no controller watches has no number, and one
must be given. Not for: the keys of the block (`schema.tolerance`), what rows are of (`targets`), the format of
a controllers file (`limit_files`).
"""

from __future__ import annotations

import math
from collections.abc import Iterator, Mapping
from dataclasses import dataclass, field
from pathlib import Path

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
from clearance.formats.files.input_files import InputFiles, resolved
from clearance.formats.robot.limit_files import parse_controllers, widest
from clearance.formats.schema.strict_model import StrictModel, validated
from clearance.formats.schema.tolerance import (
    FOLDER,
    ObstacleRow,
    Placement,
    Tolerance,
    Tracking,
    checked_angle,
    checked_offset,
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
from clearance.world.motion_limits import PathTolerance
from clearance.world.notice import listed


def budget_of(given: Tolerance, case: Case, folder: Path, files: InputFiles) -> Budget:
    """The budget that a block is for a case.

    Args:
        folder: against which the files that it names are looked up. files: reads them.

    Raises:
        BadInput: with the field; a row of nothing that the case has, with the nearest name.
    """
    found, presets = _Numbers(case), []
    for name in given.presets or ():
        presets.append(preset(name))
        found.take(presets[-1].tolerance)
    found.take(given)
    tracked = tracking_of(given.tracking, case, folder, files)
    found.tracking = tracked.errors
    return Budget(
        robots={one.robot.name: found.robot(one.robot.name) for one in case.robots},
        obstacles={one.name: found.obstacle(one.name) for one in case.obstacles},
        coverage=given.coverage,
        is_normal=given.distributions == "normal",
        unproven_ok=given.unproven_ok,
        sources=(*map(_described, presets), *tracked.sources),
    )


def _described(one: Preset) -> str:
    return f"preset {one.name}: {one.source}"


_Key = tuple[str, str]
"""Owner and part."""


@dataclass
class _Numbers:
    """The number that holds of each thing so far, by owner and part."""

    case: Case
    positions: dict[_Key, float] = field(default_factory=dict)
    tracking: Mapping[_Key, float] = field(default_factory=dict)
    frames: dict[_Key, PlacementTolerance] = field(default_factory=dict)
    places: dict[_Key, PlacementTolerance] = field(default_factory=dict)
    surfaces: dict[_Key, float] = field(default_factory=dict)
    timing: dict[_Key, float] = field(default_factory=dict)

    def take(self, given: Tolerance) -> None:
        """Replaces the errors that the rows of a block name."""
        self._take_of_robots(given)
        if given.obstacles:
            with at("obstacles"):
                for target, row in obstacles_of(self.case).rows(given.obstacles):
                    self._place(self.places, target, row)
                    self._surface(target, row)
        if given.timing:
            with at("timing"):
                for target, seconds in clocks_of(self.case).rows(given.timing):
                    self.timing[_key(target)] = seconds

    def _take_of_robots(self, given: Tolerance) -> None:
        if given.joints:
            with at("joints"):
                for target, error in joints_of(self.case).rows(given.joints):
                    self.positions[_key(target)] = checked_size(error, target)
        if given.kinematics:
            with at("kinematics"):
                for target, row in frames_of(self.case).rows(given.kinematics):
                    self._place(self.frames, target, row)
        if given.base:
            with at("base"):
                for target, row in robots_of(self.case).rows(given.base.rows):
                    self._place(self.places, target, row)
        if given.links:
            with at("links"):
                for target, link in links_of(self.case).rows(given.links):
                    self.surfaces[_key(target)] = link.surface

    def _place(self, known: dict[_Key, PlacementTolerance], target: Target, row: Placement) -> None:
        before = known.get(_key(target), PlacementTolerance())
        xyz = before.xyz if row.xyz is None else row.xyz
        angle = before.angle if row.angle is None else row.angle
        known[_key(target)] = PlacementTolerance(xyz, angle)

    def _surface(self, target: Target, row: ObstacleRow) -> None:
        if row.surface is not None:
            self.surfaces[_key(target)] = row.surface

    def robot(self, name: str) -> RobotTolerance:
        """What holds of a robot."""
        return RobotTolerance(
            joints=dict(self._joints(name)),
            base=self.places.get((name, ""), PlacementTolerance()),
            surfaces={
                part: s for (owner, part), s in self.surfaces.items() if owner == name and part
            },
            timing=self.timing.get((name, ""), 0.0),
        )

    def _joints(self, robot: str) -> Iterator[tuple[str, JointTolerance]]:
        known = [self.positions, self.tracking, self.frames]
        keys = dict.fromkeys(key for one in known for key in one if key[0] == robot)
        for key in keys:
            frame = self.frames.get(key, PlacementTolerance())
            position, tracking = self.positions.get(key, 0.0), self.tracking.get(key, 0.0)
            yield key[1], JointTolerance(position, tracking, frame)

    def obstacle(self, name: str) -> ObstacleTolerance:
        """What holds of an obstacle."""
        place = self.places.get((name, ""), PlacementTolerance())
        key = (name, "")
        return ObstacleTolerance(place, self.surfaces.get(key, 0.0), self.timing.get(key, 0.0))


def _key(target: Target) -> _Key:
    return target.owner, target.part


class _File(StrictModel):
    source: str
    tolerance: Tolerance


@dataclass(frozen=True)
class Preset:
    """Tolerances, and where their numbers come from, in one line."""

    name: str
    source: str
    tolerance: Tolerance


def preset(name: str) -> Preset:
    """The preset of a name, which is there."""
    path = FOLDER / f"{name}.yaml"
    read = validated(_File, parse_yaml(path.read_bytes(), path.name), path.name)
    return Preset(name, " ".join(read.source.split()), read.tolerance)


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
            source = f"path tolerances of controllers in {files.shown(path)}"
            return _joined(numbers, bounds, case, source)


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
                raise BadTolerance(
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
    source += f"; none of joints {listed(free, 8)}" if free else ""
    return TrackingErrors(errors, (source,))

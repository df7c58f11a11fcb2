"""A block of tolerances, held against its case: patterns and presets to the `Budget` of what is there.

Presets come first, in their order; a row of one thing takes the place of those before it, number by number.
Not for: the keys of the block (`schema.tolerance`), what rows are of (`targets`).
"""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from dataclasses import dataclass, field
from pathlib import Path

from clearance.case.tolerance.presets import Preset, preset
from clearance.case.tolerance.targets import (
    Target,
    clocks_of,
    frames_of,
    joints_of,
    links_of,
    obstacles_of,
    robots_of,
)
from clearance.case.tolerance.tracking import checked_size, tracking_of
from clearance.errors import at
from clearance.formats.files.input_files import InputFiles
from clearance.formats.schema.tolerance import (
    ObstacleRow,
    Placement,
    Tolerance,
)
from clearance.world.budget import (
    Budget,
    JointTolerance,
    ObstacleTolerance,
    PlacementTolerance,
    RobotTolerance,
)
from clearance.world.case import Case


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
        sources=(*map(_told, presets), *tracked.sources),
    )


def _told(one: Preset) -> str:
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
        """Lets the rows of a block take the place of what they are of."""
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

"""Errors of a real machine, as plain data: patterns and presets are resolved.

Each number is the greatest magnitude of one error, in any direction, at once with all others.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field

COVERAGE = 3.0
"""[-] Standard deviations that the expected value subtracts, if none are given."""


@dataclass(frozen=True)
class PlacementTolerance:
    """How far a frame may be from where it is said to be.

    Attributes:
        xyz: [m] the length of the offset of its origin. angle: [rad] of a turn about any axis through its origin.
    """

    xyz: float = 0.0
    angle: float = 0.0


EXACT = PlacementTolerance()


@dataclass(frozen=True)
class JointTolerance:
    """How far a joint may be from its course, at the link side.

    Attributes:
        position: [rad or m] repeatability and calibration. tracking: [rad or m] what the controller leaves.
        frame: of the frame that the joint hangs on, in its parent link.
    """

    position: float = 0.0
    tracking: float = 0.0
    frame: PlacementTolerance = EXACT


@dataclass(frozen=True)
class RobotTolerance:
    """Of one robot.

    Attributes:
        joints: by name; a joint that is not named is exact, a joint that follows another has its leader's error,
            times its factor, and its own.
        base: of its root link, in what it stands on.
        surfaces: [m] how far the surface of each link may stand out, by link.
        timing: [s] how far its clock may be off those of the other actors.
    """

    joints: Mapping[str, JointTolerance] = field(default_factory=dict)
    base: PlacementTolerance = EXACT
    surfaces: Mapping[str, float] = field(default_factory=dict)
    timing: float = 0.0


@dataclass(frozen=True)
class ObstacleTolerance:
    """Of one obstacle, or part.

    Attributes:
        place: in the world, or in what it stands on; of a part that is carried, in its carrier.
        surface: [m] how far its surface may stand out. timing: [s] of its clock, if it moves by its own table.
    """

    place: PlacementTolerance = EXACT
    surface: float = 0.0
    timing: float = 0.0


@dataclass(frozen=True)
class Budget:
    """All errors of a case.

    Attributes:
        robots, obstacles: by name; what is not named is exact.
        coverage: standard deviations that the expected value subtracts. is_normal: errors are normal with their
            magnitude at three standard deviations; else uniform up to it.
        unproven_ok: a limit that is kept, but not proven with these errors, does not fail the run.
        sources: where its numbers come from, one line each: presets with their source, files.
    """

    robots: Mapping[str, RobotTolerance] = field(default_factory=dict)
    obstacles: Mapping[str, ObstacleTolerance] = field(default_factory=dict)
    coverage: float = COVERAGE
    is_normal: bool = False
    unproven_ok: bool = False
    sources: tuple[str, ...] = ()

"""A question, complete: which robot moves how through which scene, and how close it may come."""

from __future__ import annotations

from dataclasses import dataclass, field
from typing import TYPE_CHECKING

import numpy as np

from clearance.world.body import Obstacle
from clearance.world.notice import Notice
from clearance.world.robot import Robot
from clearance.world.trajectory import Trajectory

if TYPE_CHECKING:
    from clearance.sketch.sketch import Sketch


@dataclass(frozen=True)
class Limits:
    """Two levels of clearance [m]: below `fail` the case is violated, below `warn` it is a near miss."""

    fail: float = 0.0
    warn: float = 0.0


@dataclass(frozen=True)
class Source:
    """A file that the case was made from.

    Attributes:
        path: as it is shown, the same on every machine.
        read_from: where it was found, for nobody but who must not overwrite it.
    """

    path: str
    sha256: str
    n_bytes: int
    read_from: str = field(default="", compare=False, repr=False)


@dataclass(frozen=True)
class Unmeasured:
    """A link or a pair that is left out, and why (`obstacle` is "*" for a whole link)."""

    link: str
    obstacle: str
    reason: str


@dataclass(frozen=True, eq=False)
class PlacedRobot:
    """A robot in the world.

    Attributes:
        world_from_base: (4, 4) pose of the root link [m].
        trajectory: what it is asked to do.
        fixed_positions: values [rad] or [m] of moving joints that the trajectory does not name.
        exclude_links: links that are not measured.
    """

    robot: Robot
    trajectory: Trajectory
    world_from_base: np.ndarray = field(default_factory=lambda: np.eye(4))
    fixed_positions: dict[str, float] = field(default_factory=dict)
    exclude_links: tuple[str, ...] = ()
    urdf_path: str = ""
    package_dirs: tuple[str, ...] = ()


@dataclass(frozen=True, eq=False)
class ReservedSpace:
    """An outline in a plane that what the robot sweeps must keep to.

    Attributes:
        plane: "xy", "xz", "yz" or a point and a normal; `section` cuts there [m] instead of projecting.
        sketch: its closed contours, in the plane's coordinates [m].
        mode: "outside": the sketch contains the sweep; "inside": it stays clear of it; "nearest": the outlines
            differ by no more than the limit.
        limit: [m] the least gap (outside, inside) or the greatest distance (nearest).
        links: names; empty for all.
    """

    name: str
    sketch: Sketch
    plane: str = "xy"
    section: float | None = None
    mode: str = "outside"
    limit: float = 0.0
    links: tuple[str, ...] = ()


@dataclass(frozen=True, eq=False)
class Case:
    """Robots, obstacles, trajectories, limits.

    Attributes:
        robots: at least one.
        obstacles: unique names.
        allow: pairs of name patterns (`fnmatch`) that are not measured.
        contact_response: in simulated motion, obstacles push back.
        sources: every file read, for the summary.
        notes: what loading had to mend or assume, one line each.
        notices: suspect input and warnings, which stand in the headline.
        accept: kinds of suspect input that do not make the verdict suspect.
        profiles: outlines that the sweep must keep to.
    """

    name: str
    robots: tuple[PlacedRobot, ...]
    obstacles: tuple[Obstacle, ...]
    limits: Limits = Limits()
    allow: tuple[tuple[str, str], ...] = ()
    contact_response: bool = False
    sources: tuple[Source, ...] = ()
    notes: tuple[str, ...] = ()
    profiles: tuple[ReservedSpace, ...] = ()
    notices: tuple[Notice, ...] = ()
    accept: tuple[str, ...] = ()

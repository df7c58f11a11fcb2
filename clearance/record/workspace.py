"""The region that several robots pass through. Not for: finding it (`simulate.answers.workspace`)."""

from __future__ import annotations

from dataclasses import dataclass

from clearance.geometry.boolean import ClosedMesh
from clearance.world.robot_in_cell import RobotInCell


@dataclass(frozen=True)
class SharedLinks:
    """Two links of different robots, or obstacles that they carry, with swept pieces in common."""

    robot_a: str
    link_a: str
    robot_b: str
    link_b: str


@dataclass(frozen=True, eq=False)
class Workspace:
    """The region that robots share.

    Attributes:
        robots: each with its name. region: the surface of what more than one passes through, world frame.
        volume: [m^3] of the region: an upper bound. links: which links meet there.
        n_pieces: convex pieces of each robot's sweep. leaves: [m] the most a piece was made wider by.
        excluded: links that were left out, `robot/link`.
        uncounted: what the cases give that widens no sweep: tolerances, paddings.
        carried: names of robots that stand on another one, and of that: what such two share is not counted.
    """

    robots: tuple[RobotInCell, ...]
    region: ClosedMesh
    links: tuple[SharedLinks, ...]
    n_pieces: tuple[int, ...]
    leaves: float
    within: float
    excluded: tuple[str, ...]
    uncounted: str
    carried: tuple[tuple[str, str], ...] = ()

    @property
    def names(self) -> tuple[str, ...]:
        """A name for each robot."""
        return tuple(robot.name for robot in self.robots)

    @property
    def volume(self) -> float:
        """[m^3] an upper bound."""
        return self.region.volume

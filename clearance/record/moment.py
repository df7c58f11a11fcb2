"""Where and when a distance occurs, at a step or between two: the pair, the witness points, the joints."""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np

from clearance.world.rules import DEFAULT


@dataclass(frozen=True)
class Depth:
    """How deep two bodies are in each other.

    Attributes:
        penetration: [m] the shortest way that parts them, or more where it is not `exact`. at_least: [m] or less.
    """

    penetration: float
    at_least: float
    exact: bool


@dataclass(frozen=True, eq=False)
class Moment:
    """One moment of the motion and the clearance that occurs there.

    Attributes:
        step: the step at the moment or the last one before it.
        time: [s]. between: whether the moment is after that step and before the next.
        clearance: [m] of this pair, the nearest there.
        point_link, point_obstacle: witness points in the world frame [m].
        positions: of each robot's moving joints [rad] or [m], columns as `Motion.positions`.
        share: how much of the interval from the step to the next has passed, 0 to 1.
        rule: what judges the pair. touches: whether the bodies themselves touch, not only their paddings.
        time_b: [s] when the second body is there, if its clock is not tied to that of the first; else None.
        depth: of bodies in contact, where it is known.
    """

    step: int
    time: float
    between: bool
    clearance: float
    link: str
    obstacle: str
    point_link: tuple[float, float, float]
    point_obstacle: tuple[float, float, float]
    positions: tuple[np.ndarray, ...]
    share: float = 0.0
    rule: str = DEFAULT
    touches: bool = False
    time_b: float | None = None
    depth: Depth | None = None

    @property
    def padding(self) -> float:
        """[m] By which the clearance is less than the distance of the shapes; 0 where they touch."""
        between = np.subtract(self.point_link, self.point_obstacle)
        less = float(np.linalg.norm(between)) - self.clearance
        return 0.0 if self.touches else max(0.0, less)

    def of_run(self, first: int, padding: float, rule: str) -> Moment:
        """The same moment of a section as the run reports it.

        Args:
            first: the step of the run at which the section begins. padding: [m] by which clearances are reduced.
            rule: what judges the pair.
        """
        return replace(self, step=self.step + first, clearance=self.clearance - padding, rule=rule)

"""Where and when a distance occurs, at a step or between two: the pair, the witness points, the joints.

Not for: finding which moment is the worst (`measure`, `certify`).
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace
from typing import NamedTuple

import numpy as np

from clearance.query.distance import distance
from clearance.world.case import Case
from clearance.world.forest import forest_of, joined_positions, positions_between
from clearance.world.motion import Motion
from clearance.world.pairs import Pair
from clearance.world.rules import DEFAULT


class Depth(NamedTuple):
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

    def of_run(self, first: int, padding: float, rule: str) -> Moment:
        """The same moment of a section as the run reports it.

        Args:
            first: the step of the run at which the section begins. padding: [m] by which clearances are reduced.
            rule: what judges the pair.
        """
        return replace(self, step=self.step + first, clearance=self.clearance - padding, rule=rule)


@dataclass(frozen=True, eq=False)
class MomentQuery:
    """Measures a pair at any moment between two steps of a case's motion."""

    case: Case
    motions: Sequence[Motion]
    pairs: Sequence[Pair]

    def between(self, step: int, share: float, i_pair: int, *, touches: bool = False) -> Moment:
        """The moment that a share (0 to 1) of the interval after `step` lies behind it.

        Args:
            touches: the pair is known to be in contact there, which rounding of the pose could hide.
        """
        return self._measured(
            i_pair,
            _Place(
                step + int(share == 1.0),
                share % 1.0,
                tuple(motion.positions_after(step, share) for motion in self.motions),
                positions_between(self.case, self.motions, step, share),
            ),
            touches,
        )

    def at(self, step: int, i_pair: int) -> Moment:
        """The moment of a step."""
        positions = tuple(motion.positions[step] for motion in self.motions)
        steps = np.array([step])
        columns = joined_positions(self.case, self.motions, steps)[0]
        return self._measured(i_pair, _Place(step, 0.0, positions, columns), touches=False)

    def _measured(self, i_pair: int, at: _Place, touches: bool) -> Moment:
        a, b = self.pairs[i_pair]
        poses = forest_of(self.case).poses(at.columns[None])
        found = distance(
            a.shape_in(self.case),
            b.shape_in(self.case),
            pose_a=a.poses_in(self.case, poses)[0],
            pose_b=b.poses_in(self.case, poses)[0],
        )
        times = self.motions[0].times
        end = times[min(at.step + 1, len(times) - 1)]
        point = tuple(found.point_b.tolist())
        return Moment(
            step=at.step,
            time=float(times[at.step] + at.share * (end - times[at.step])),
            between=at.share > 0.0,
            clearance=0.0 if touches else found.distance,
            link=a.name_in(self.case),
            obstacle=b.name_in(self.case),
            point_link=point if touches else tuple(found.point_a.tolist()),
            point_obstacle=point,
            positions=at.positions,
            share=at.share,
            touches=touches or found.distance <= 0.0,
        )


class _Place(NamedTuple):
    """When all is where: the step, the share of the way to the next, the robots' joints, and all columns."""

    step: int
    share: float
    positions: tuple[np.ndarray, ...]
    columns: np.ndarray

"""Where and when a distance occurs, at a step or between two: the pair, the witness points, the joints.

Not for: finding which moment is the worst (`measure`, `certify`).
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from clearance.query.distance import distance
from clearance.simulate.names import pair_names
from clearance.world.case import Case
from clearance.world.forest import forest_of, positions_between
from clearance.world.motion import Motion
from clearance.world.pairs import Pair
from clearance.world.rules import DEFAULT


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


@dataclass(frozen=True, eq=False)
class Moments:
    """Measures a pair at any moment between two steps of a case's motion."""

    case: Case
    motions: Sequence[Motion]
    pairs: Sequence[Pair]

    def between(self, step: int, share: float, i_pair: int, *, touches: bool = False) -> Moment:
        """The moment that a share (0 to 1) of the interval after `step` lies behind it.

        Args:
            touches: the pair is known to be in contact there, which rounding of the pose could hide.
        """
        pair = self.pairs[i_pair]
        positions = tuple(motion.positions_after(step, share) for motion in self.motions)
        columns = positions_between(self.case, self.motions, step, share)
        poses = forest_of(self.case).poses(columns[None])
        a, b = pair.a, pair.b
        found = distance(
            a.shape_in(self.case),
            b.shape_in(self.case),
            pose_a=a.poses_in(self.case, poses)[0],
            pose_b=b.poses_in(self.case, poses)[0],
        )
        links, obstacles = pair_names(self.case, [pair])
        times = self.motions[0].times
        point = tuple(found.point_b.tolist())
        return Moment(
            step=step + int(share == 1.0),
            time=float(times[step] + share * (times[step + 1] - times[step])),
            between=0.0 < share < 1.0,
            clearance=0.0 if touches else found.distance,
            link=links[0],
            obstacle=obstacles[0],
            point_link=point if touches else tuple(found.point_a.tolist()),
            point_obstacle=point,
            positions=positions,
            share=share % 1.0,
            touches=touches or found.distance <= 0.0,
        )

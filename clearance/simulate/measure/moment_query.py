"""Measures a pair at any moment of a motion. Not for: which moment is the worst (`measure`, `certify`)."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import NamedTuple

import numpy as np

from clearance.query.distance import distance
from clearance.record.moment import Moment
from clearance.world.case import Case
from clearance.world.forest import forest_of, joined_positions, positions_between
from clearance.world.motion import Motion
from clearance.world.pairs import Pair


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

"""Measures a pair at any moment of a motion. Not for: which moment is the worst (`measure`, `certify`)."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any

from clearance.query.distance import distance
from clearance.query.result import Nearest
from clearance.record.moment import Moment
from clearance.world.case import Case
from clearance.world.forest import forest_of, positions_between
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
        a, b = self.pairs[i_pair]
        poses = forest_of(self.case).poses(
            positions_between(self.case, self.motions, step, share)[None]
        )
        found = distance(
            a.shape_in(self.case),
            b.shape_in(self.case),
            pose_a=a.poses_in(self.case, poses)[0],
            pose_b=b.poses_in(self.case, poses)[0],
        )
        positions = tuple(motion.positions_after(step, share) for motion in self.motions)
        step, share = step + int(share == 1.0), share % 1.0
        times = self.motions[0].times
        end = times[min(step + 1, len(times) - 1)]
        return Moment(
            step=step,
            time=float(times[step] + share * (end - times[step])),
            between=share > 0.0,
            link=a.name_in(self.case),
            obstacle=b.name_in(self.case),
            positions=positions,
            share=share,
            **as_seen(found, touches),
        )


def as_seen(found: Nearest, touches: bool) -> dict[str, Any]:
    """The fields of a moment from what is measured of its pair, which may be known to be in contact there."""
    point = tuple(found.point_b.tolist())
    return {
        "clearance": 0.0 if touches else found.distance,
        "point_link": point if touches else tuple(found.point_a.tolist()),
        "point_obstacle": point,
        "touches": touches or found.distance <= 0.0,
    }

"""The moments of steps, as they were measured: of the nearest pair there. Not for: other pairs (`rule_pairs`)."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from clearance.record.measurement import Measurement
from clearance.record.moment import Moment
from clearance.world.motion import Motion


@dataclass(frozen=True, eq=False)
class SampleMoments:
    """The moments of steps; names of the bodies of each pair, and the robots' motions."""

    names: tuple[list[str], list[str]]
    motions: Sequence[Motion]

    def at(self, found: Measurement, rule: str, step: int) -> Moment:
        """The moment of a step whose clearance is known."""
        pair, points = int(found.pair[step]), found.points[step].tolist()
        time_b = None if found.times_b is None else float(found.times_b[step])
        return Moment(
            step=step,
            time=float(self.motions[0].times[step]),
            between=False,
            clearance=float(found.clearance[step]),
            link=self.names[0][pair],
            obstacle=self.names[1][pair],
            point_link=tuple(points[0]),
            point_obstacle=tuple(points[1]),
            positions=tuple(motion.positions[step] for motion in self.motions),
            rule=rule,
            touches=bool(found.touches(slice(step, step + 1))[0]),
            time_b=None if time_b is None or np.isnan(time_b) else time_b,
        )

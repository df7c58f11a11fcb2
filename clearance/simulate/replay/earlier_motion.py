"""The motion before a change, for the replay of the one after it: each body that was elsewhere, seen through.

Bodies are those of the run that is drawn, at the same times; after its end an earlier run stands as it ended. Not
for: what the change is (`gains`).
"""

from __future__ import annotations

import numpy as np

from clearance.record.record import Record
from clearance.record.replay import EarlierBody, Replay
from clearance.simulate.replay.bodies import FramePlace, bodies_of, packed, placed_bodies

APART = 1e-6
"""[m] and, of unit quaternions, [-]: a body that was off by less is not drawn twice."""


def earlier_motion(earlier: Record, replay: Replay) -> list[EarlierBody]:
    """The bodies of a replay that were elsewhere at some frame.

    Args:
        earlier: a run of the same bodies.
    """
    frames = [_place(earlier.timeline.times, time) for time in replay.times]
    drawn = placed_bodies(earlier, bodies_of(earlier.case), frames)
    was = [packed(poses) for poses in drawn.poses]
    return [
        EarlierBody(i, before, shown.astype(np.uint8))
        for i, (before, after, shown) in enumerate(zip(was, replay.poses, drawn.shown, strict=True))
        if (np.abs(before - after) > APART).any()
    ]


def _place(times: np.ndarray, time: float) -> FramePlace:
    """When a time [s] is in a run, at the nearest of its ends where it is beyond."""
    step = int(np.clip(np.searchsorted(times, time, side="right") - 1, 0, len(times) - 1))
    share = 0.0
    if step + 1 < len(times):
        share = float(np.clip((time - times[step]) / (times[step + 1] - times[step]), 0.0, 1.0))
    return FramePlace(step, share, None, (None, None))

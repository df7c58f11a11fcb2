"""Stretches of time in which a path stays as it is, in its table's time and in the run's.

Not for: which splines that leaves (`basis`).
"""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from clearance.errors import BadChange
from clearance.gains.request import Request
from clearance.gains.tool_poses import ToolKeep
from clearance.world.case import Case
from clearance.world.placed_robot import PlacedRobot
from clearance.world.timing import time_text


def require_in_run(windows: Sequence[tuple[float, float]], times: np.ndarray) -> None:
    """Nothing, if a part at least of each stretch that is kept is of the run.

    Raises:
        BadInput: which is not.
    """
    for start, end in windows:
        if end < times[0] or start > times[-1]:
            raise BadChange(
                f"from {time_text(start)} s to {time_text(end)} s is to be kept, which is not in the run",
                valid=f"times from {time_text(times[0])} s to {time_text(times[-1])} s",
            )


def require_in_path(placed: PlacedRobot, tool_keeps: Sequence[ToolKeep]) -> None:
    """Nothing, if the moments at which a tool is kept are of its robot's path.

    Raises:
        BadInput: which is not.
    """
    if placed.trajectory is None:
        return
    start, end = placed.timing.run_times(placed.given_trajectory.times)[[0, -1]]
    for one in tool_keeps:
        if not start <= one.time <= end:
            raise BadChange(
                f"a tool is to be kept at {time_text(one.time)} s, at which its path is not",
                valid=f"a time from {time_text(start)} to {time_text(end)} s",
            )


def fixed_spans(case: Case, i_robot: int, request: Request) -> tuple[tuple[float, float], ...]:
    """The windows of the robot's table [s] in which its path stays as it is: from sample to sample, since those
    next to a window draw the path in it. Samples that follow each other and are kept are one window."""
    timing, times = case.robots[i_robot].timing, case.robots[i_robot].given_trajectory.times
    kept = np.zeros(len(times), dtype=bool)
    for window in request.keep:
        start, end = map(timing.table_times, window)
        before = max(int(np.searchsorted(times, start, side="right")) - 1, 0)
        after = min(int(np.searchsorted(times, end)), len(times) - 1)
        kept[before : after + 1] = True
    if request.keep_ends:
        kept[[0, -1]] = True
    edges = np.flatnonzero(np.diff(kept, prepend=False, append=False))
    starts, ends = times[edges[::2]], times[edges[1::2] - 1]
    return tuple(zip(starts.tolist(), ends.tolist(), strict=True))


def windows_of(case: Case, i_robot: int, request: Request) -> list[tuple[float, float]]:
    """The same in times of the run; before its path begins and after it ends the robot stands at an end that may
    be kept."""
    timing, times = case.robots[i_robot].timing, case.robots[i_robot].given_trajectory.times
    found = []
    for start, end in fixed_spans(case, i_robot, request):
        first = -np.inf if start <= times[0] else timing.start + start / timing.rate
        last = np.inf if end >= times[-1] else timing.start + end / timing.rate
        found.append((float(first), float(last)))
    return found

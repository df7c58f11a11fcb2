"""Tables of one case whose times may come from two clocks: no overlap, or stamps that begin at different times.

Not for: clocks that the case declares unsynchronised (`clocks`).
"""

from __future__ import annotations

import math
from collections.abc import Iterator
from typing import NamedTuple

import numpy as np

from clearance.world.case import Case, PlacedRobot
from clearance.world.notice import Notice, Severity
from clearance.world.pose_table import PoseTable
from clearance.world.timing import Timing

SKEW = 1e-3
"""[s] Recordings that begin within it begin together. Beyond it, and within an interval of theirs, each began with
its first message: that is a warning."""


class _Table(NamedTuple):
    """The owner of a table, and its start and end in the run [s]; the end is infinite if it repeats."""

    start: float
    end: float
    name: str
    timing: Timing

    @property
    def text(self) -> str:
        until = "on" if self.end == math.inf else f"to {self.end:.12g} s"
        return f"{self.name} moves from {self.start:.12g} {until}"


def notices_on_clocks(case: Case) -> list[Notice]:
    """Notices on tables that end before others begin, and on recordings that are shifted against their stamps.

    There is none where the case says `start` or `after`.
    """
    if case.clock.slack == math.inf:
        return []
    tables, found = sorted(_tables(case)), []
    for i, later in enumerate(tables[1:], 1):
        earlier = max(tables[:i], key=lambda table: table.end)
        meant = earlier.timing.says_after or later.timing.says_start
        if earlier.end < later.start and not meant:
            text = (
                f"CHECK CLOCKS: {earlier.text}, {later.text}: they never move together; do their times "
                "come from one clock? If so, give the later table a `start:`, or the earlier one `after: hold`"
            )
            found.append(Notice(Severity.SUSPECT, "clocks", text))
    return [*found, *_recordings_begin_unlike(case)]


def _recordings_begin_unlike(case: Case) -> Iterator[Notice]:
    """Notices on recordings that begin together in the case, but not by their stamps."""
    recorded = [one for one in case.robots if one.trajectory and one.trajectory.began is not None]
    recorded.sort(key=_clock_at_start)
    for later in recorded[1:]:
        delay = _clock_at_start(later) - _clock_at_start(recorded[0])
        if delay > SKEW and not later.timing.says_start:
            start = f"{delay / later.timing.rate:.6g}"
            text = (
                f"CHECK CLOCKS: by its stamps the recording of robot {later.robot.name!r} begins {start} s after "
                f"that of {recorded[0].robot.name!r}, but it is taken from 0 s; beside its file, "
                f"`start: {start}` keeps the delay and `start: 0` drops it"
            )
            by_chance = delay <= max(_usual_interval(later), _usual_interval(recorded[0]))
            yield Notice(Severity.WARNING if by_chance else Severity.SUSPECT, "clocks", text)


def _usual_interval(placed: PlacedRobot) -> float:
    """[s] between two samples of a recording, by its clock."""
    intervals = np.diff(placed.given_trajectory.times)
    return float(np.median(intervals)) if len(intervals) else 0.0


def _clock_at_start(placed: PlacedRobot) -> float:
    """[s] What the clock of a recording showed at the run's time 0."""
    began = placed.given_trajectory.began
    assert began is not None
    return began - placed.timing.start * placed.timing.rate


def _tables(case: Case) -> Iterator[_Table]:
    for placed in case.robots:
        if placed.trajectory is not None and np.ptp(placed.trajectory.positions, axis=0).any():
            name = f"robot {placed.robot.name!r}"
            yield _table(name, placed.trajectory.times, placed.timing)
    for obstacle in case.obstacles:
        if obstacle.moves is not None and _changes(obstacle.moves):
            name = f"obstacle {obstacle.name!r}"
            yield _table(name, obstacle.moves.times, obstacle.moves.timing)


def _changes(table: PoseTable) -> bool:
    return any(np.ptp(one, axis=0).any() for one in (table.positions, table.quaternions))


def _table(name: str, times: np.ndarray, timing: Timing) -> _Table:
    start, end = timing.run_times(times)[[0, -1]].tolist()
    return _Table(start, math.inf if timing.after == "loop" else end, name, timing)

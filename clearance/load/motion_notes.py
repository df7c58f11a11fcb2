"""Notes on how what moves does so between the rows of its table, before the first and after the last.

Not for: joints that nobody gives a value (`motion_names`).
"""

from __future__ import annotations

import math
from collections.abc import Iterator
from typing import NamedTuple

import numpy as np

from clearance.world.case import Case
from clearance.world.timing import Timing


class _Table(NamedTuple):
    """What moves, and when its table is followed: its first and last sample [s] of the run.

    Attributes:
        taken: [s] when it is picked up, which ends its table; infinite for what never is.
    """

    what: str
    first: float
    last: float
    timing: Timing
    taken: float = math.inf


def notes_on_motion(case: Case, start: float, end: float) -> tuple[str, ...]:
    """One line for each thing that a reader could take to be otherwise.

    Args:
        start, end: [s] of the run.
    """
    notes = [
        f"obstacle {obstacle.name!r} moves between the poses of its table by straight translation, and rotation "
        "about one axis at constant speed"
        for obstacle in case.obstacles
        if obstacle.moves is not None
    ]
    for table in _tables(case):
        notes += _before_and_after(table, start, end)
        if table.taken < table.last:
            notes.append(
                f"{table.what} follows its table until it is picked up at {table.taken:g} s"
            )
    return tuple(notes)


def _tables(case: Case) -> Iterator[_Table]:
    for placed in case.robots:
        if placed.trajectory is not None:
            times = placed.trajectory.times
            yield _table(f"robot {placed.robot.name!r}", times, placed.timing)
    for obstacle in case.obstacles:
        if obstacle.moves is not None:
            name = f"obstacle {obstacle.name!r}"
            table = _table(name, obstacle.moves.times, obstacle.moves.timing)
            starts = [c.window.start for c in case.carries if c.part == obstacle.name]
            yield table._replace(taken=min(starts, default=math.inf))


def _table(what: str, times: np.ndarray, timing: Timing) -> _Table:
    first, last = timing.run_times(times[[0, -1]] if len(times) > 1 else times)[[0, -1]].tolist()
    return _Table(what, first, last, timing)


def _before_and_after(table: _Table, start: float, end: float) -> Iterator[str]:
    what, first, last, timing, taken = table
    early, late = start < first, last < min(end, taken)
    if timing.after == "absent":
        if early and taken < math.inf:
            yield f"{what} is in the cell from {first:g} s (after: absent)"
        elif early or late:
            yield f"{what} is in the cell from {first:g} s to {last:g} s only (after: absent)"
        return
    if early:
        yield f"{what} stands at its first sample until {first:g} s"
    if late and timing.after == "loop":
        yield f"{what} goes through its table again and again, every {last - first:g} s (after: loop)"
    elif late:
        yield f"{what} stands at its last sample from {last:g} s"
